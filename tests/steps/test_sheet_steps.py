"""Steps of sheets and devices, of a fit and of the scales: blocks, datasets and figures."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import flexscale as fs
from flexscale.datasets.checks import check_dataset
from flexscale.datasets.schema import SCHEMAS
from flexscale.datasets.sheet_variables import build_sheet_dataset
from flexscale.datasets.store import Store
from flexscale.errors import BadInputError, MissingDataError, SchemaError, UnknownNameError
from flexscale.plotting.style import MACRO_COLOR, NATIVE_COLOR
from flexscale.status import SolveStatus
from flexscale.steps.catalog import FIGURES, STEPS
from flexscale.steps.engine_process import snakefile
from flexscale.steps.experiment import load_experiment
from flexscale.steps.figures import FIGURE, draw_dataset
from flexscale.steps.plan import build_plan
from flexscale.steps.step import Resources
from flexscale.steps.summary import failed_samples
from tests.macro.fit_samples import law_sweep, tangent
from tests.steps.experiment_samples import NATIVE, plan_of

WORKFLOWS = Path(__file__).parents[2] / "workflows"
CONTENT: dict[str, Any] = {
    "patterns": {"hexagon": {"family": "IH20"}},
    "sweep": {
        "directions": {"start": 0, "stop": 180, "step": 22.5},
        "curvatures": [0, 0.005, 0.01, 0.015],
    },
    "fit": {},
    "sheet": {"length": 60, "width": 30, "curvatures": [0, 0.01, 0.02], "size": 15},
    "rig": {
        "size": 25,
        "mandrel": {"angles": [0, 60, 120, 180, 240, 300], "indentation": "1.5 cm"},
        "stage": {"length": 100, "shortenings": [1, 10], "direction": 30},
    },
    "figures": ["sheet", "rig"],
}


@pytest.fixture(scope="module")
def model() -> fs.MacroModel:
    return fs.fit(law_sweep(), tangent())


@pytest.fixture(scope="module")
def made(model: fs.MacroModel) -> dict[str, xr.Dataset]:
    """Datasets of both steps, with a fit that stands in for that of the plan."""
    found = {}
    for job in plan_of(CONTENT):
        if job.step in ("sheet", "rig"):
            step = STEPS[job.step]
            parameters = step.task(job.recipe.parameters)
            found[job.step] = step.compute(parameters, {"fit": model.to_dataset()}, Resources())
    return found


def test_sheets_and_rigs_come_from_the_fit() -> None:
    plan = plan_of(CONTENT)
    jobs = {job.title: job for job in plan if job.step in ("sheet", "rig")}
    for name, size in (("sheet", 2 * 3), ("rig", 2 * (6 + 2))):
        assert [plan[needed].step for needed in jobs[name].inputs] == ["fit"]
        assert jobs[name].n_samples == size
    assert [job.title for job in plan if job.step == "figure"] == ["sheet", "rig"]


def test_every_step_and_the_figures_have_a_rule_of_the_workflow() -> None:
    rules = re.findall(
        r"^for STEP in \((.+)\):\n\n    rule:\n        name:\n            STEP\n",
        snakefile().read_text(),
        re.MULTILINE,
    )
    assert rules == ["*STEPS, FIGURE"]
    jobs = [job for file in WORKFLOWS.glob("*.yaml") for job in build_plan(load_experiment(file))]
    assert {job.step for job in jobs} == {*STEPS, FIGURE}
    # A rule asks for what the stamp's name holds behind its own.
    assert all(job.id.startswith(f"{job.step}-") for job in jobs)


def test_the_workflow_of_the_rigs_uses_the_sweep_of_the_named_patterns() -> None:
    rigs = build_plan(load_experiment(WORKFLOWS / "rigs.yaml"))
    named = {job.id for job in build_plan(load_experiment(WORKFLOWS / "named_patterns.yaml"))}
    shared = [job.step for job in rigs if job.id in named]
    assert shared == ["cell", "tangent", "sweep", "fit"]


def test_sheets_hold_what_the_simulation_gives(made, model) -> None:
    sheet = made["sheet"]
    check_dataset(sheet, "sheet")
    assert (sheet["status"] == 0).all()
    alone = fs.simulate_sheet(
        model, length=60.0, width=30.0, curvature=-0.02, options=fs.SheetOptions(size=15.0)
    )
    opening = sheet.sel(side="opening", curvature=0.02)
    assert float(opening["energy"]) == pytest.approx(alone.energy, rel=1e-9)
    assert float(opening["signed_curvature"]) == -0.02
    # Moments belong to the side, as those of a sweep: both are positive.
    assert float(opening["moment"]) == pytest.approx(-alone.moment, rel=1e-9)
    assert (sheet["moment"].isel(curvature=slice(1, None)) > 0.0).all()
    assert (float(sheet["length"]), float(sheet["width"]), float(sheet["direction"])) == (60, 30, 0)


def test_rigs_hold_what_the_simulations_give(made, model) -> None:
    rig, options = made["rig"], fs.RigOptions(size=25.0)
    check_dataset(rig, "rig")
    disc = fs.simulate_mandrel(model, angles=[120.0], side="opening", options=options)
    strip = fs.simulate_stage(model, shortenings=[1.0, 10.0], direction=30.0, options=options)
    force = rig["mandrel_force"].sel(side="opening")
    assert float(force.sel(angle=120.0)) == pytest.approx(disc.force[0], rel=1e-9)
    assert float(force.sel(angle=300.0)) == float(force.sel(angle=120.0))
    closing = rig.sel(side="closing")
    np.testing.assert_allclose(closing["stage_force"], strip.force, rtol=1e-9)
    np.testing.assert_allclose(closing["stage_deflection"], strip.deflection, rtol=1e-9)
    assert (float(rig["mandrel_indentation"]), float(rig["stage_direction"])) == (15.0, 30.0)


def test_numbers_have_units_and_long_names(made) -> None:
    for dataset in made.values():
        for name, variable in dataset.variables.items():
            assert variable.attrs["long_name"], name
            assert ("units" in variable.attrs) == (variable.dtype.kind in "fi"), name


def test_samples_that_fail_are_counted_and_listed(made, tmp_path: Path) -> None:
    rig = made["rig"].copy(deep=True)
    for name in ("mandrel_force", "mandrel_energy", "mandrel_largest_curvature"):
        rig[name].values[1, 2] = np.nan
    rig["mandrel_status"].values[1, 2] = SolveStatus.stalled
    check_dataset(rig, "rig")
    assert failed_samples(rig) == ["stalled: mandrel, opening, angle 120 degree"]
    job = next(job for job in plan_of(CONTENT) if job.step == "rig")
    entry = Store(tmp_path).publish(rig, "rig", job.recipe, [], {})
    assert (entry.row["samples"], entry.row["failed"]) == (16, 1)
    sheet = made["sheet"].copy(deep=True)
    sheet["status"].values[0, 2] = SolveStatus.stalled
    with pytest.raises(SchemaError, match=r"at side closing, curvature 0\.02 mm-1, where .* stall"):
        check_dataset(sheet, "sheet")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda ds: ds.drop_vars("stage_force"), "lacks stage: stage_force"),
        (lambda ds: ds.drop_vars("mandrel_hub"), "lacks mandrel: mandrel_hub"),
        (lambda ds: ds.drop_vars(["mandrel_status", "stage_status"]), "neither a mandrel nor"),
        (lambda ds: ds.drop_vars("stage_status"), "no status of its stage"),
        (lambda ds: ds.assign_coords(angle=ds["angle"] + 90.0), r"\[0, 360\)"),
        (lambda ds: ds.isel(shortening=[1, 0]), "strictly increasing"),
        (lambda ds: ds.assign_coords(stage_width=-ds["stage_width"]), "stage_width is -50 mm"),
    ],
)
def test_a_spoiled_rig_is_refused(made, change, words: str) -> None:
    with xr.set_options(keep_attrs=True):
        spoiled = change(made["rig"])
    with pytest.raises(SchemaError, match=words):
        check_dataset(spoiled, "rig")


def rigs(**changes: Any) -> dict[str, Any]:
    return {"rig": CONTENT["rig"] | changes}


def native_rigs(**changes: Any) -> dict[str, Any]:
    return {"native_rig": NATIVE["native_rig"] | changes}


#: So many scales on a large sheet that no machine holds them.
TINY = {"patterns": {"hexagon": {"family": "IH20", "tile_area": 1, "gap": "0.1 mm"}}}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"fit": None}, "`sheet` needs the block `fit`"),
        ({"fit": None, "sheet": None, "figures": ["rig"]}, "`rig` needs the block `fit`"),
        ({"sheet": None}, "the figure 'sheet' needs the block `sheet`"),
        ({"sheet": {"curvatures": [0, 0.07]}}, "runs into its own end: stay below 0.06283 mm-1"),
        ({"sheet": {"curvatures": [0.01, 0.005]}}, "values must increase"),
        ({"sheet": {"curvatures": [-0.01, 0.0]}}, "curvatures are not negative"),
        ({"sheet": {"sides": ["closing", "closing"]}}, "a side is named twice"),
        ({"sheet": {"legnth": 100}}, "Did you mean 'length'"),
        (rigs(mandrel=None, stage=None), "needs `mandrel`, `stage`, or both"),
        (rigs(mandrel={"hub": 99}), "rig.mandrel: A hub of 99 mm"),
        (rigs(mandrel={"indentation": 95}), "An indentation of 95 mm"),
        (rigs(mandrel={"angles": [0, 10]}), "no vertex to push at 10 degree"),
        (rigs(mandrel={"angles": [0, 360]}), "angles lie in [0, 360) degree"),
        (rigs(stage={"shortenings": [5, 120]}), "rig.stage: A shortening of 120 mm"),
        (rigs(stage={"shortenings": [0, 1]}), "shortening is 0 mm"),
        (native_rigs(stage={"shortenings": [5, 120]}), "native_rig.stage: A shortening of 120 mm"),
        (native_rigs(sides=["opening", "opening"]), "a side is named twice"),
        (native_rigs(mandrel=None, stage=None), "`native_rig` needs `mandrel`, `stage`, or both"),
        (native_rigs(mandrel={"radius": 20, "hub": 20}), "A hub of 20 mm leaves nothing of a disc"),
        (native_rigs(mandrel={"radius": 12, "hub": 11}), "holds every scale of a disc of 12 mm"),
        (
            native_rigs(stage={"length": 3, "width": 2, "shortenings": [1]}),
            "cuts all scales of the pattern to slivers",
        ),
        (
            native_rigs(stage={"length": 8, "width": 20, "shortenings": [1]}),
            "has no scale between those that",
        ),
        ({"native_sheet": {"length": 2, "width": 2}}, "cuts all scales of the pattern to slivers"),
        (native_rigs(mandrel={"angles": [0, 360]}), "angles lie in [0, 360) degree"),
        (native_rigs(mandrel={"radius": 9e3}) | TINY, "GB of memory, of which"),
        (native_rigs(stage={"length": 9e3, "width": 9e3}) | TINY, "GB of memory, of which"),
        ({"native": "shell", **native_rigs()}, "are of scales on joints, not of"),
        ({"native_sheet": {"curvatures": [0, 0.07]}}, "runs into its own end: stay below 0.06283"),
        ({"native_sheet": {"curvatures": [-0.01, 0.0]}}, "curvatures are not negative"),
    ],
)
def test_bad_blocks_are_refused_before_anything_is_computed(change, words: str) -> None:
    with pytest.raises(BadInputError) as caught:
        plan_of(CONTENT | change)
    assert words in str(caught.value)


def test_figures_show_both_devices_and_what_failed(made) -> None:
    rig = made["rig"].copy(deep=True)
    rig["stage_force"].values[0, 1] = np.nan
    rig["stage_status"].values[0, 1] = SolveStatus.stalled
    figure = fs.plot.rig(rig)
    disc, stage = figure.axes
    drawn = {line.get_label(): line for line in disc.lines}
    forces = rig["mandrel_force"].sel(side="opening").values
    np.testing.assert_allclose(drawn["opening"].get_ydata(), [*forces, forces[0]])
    assert "force of the probe [N]" in disc.get_title()
    assert stage.get_xlabel() == "shortening of the strip [mm]"
    assert stage.get_ylabel() == "force on the hinges [N]"
    crosses = [line for line in stage.lines if line.get_label() == "_unconverged"]
    assert [list(line.get_xdata()) for line in crosses] == [[10.0]]
    assert "not converged" in figure.get_supxlabel()
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["closing", "opening"]


def test_a_figure_of_one_device_has_one_panel(made) -> None:
    names = [name for name in made["rig"].variables if str(name).startswith("mandrel")]
    figure = fs.plot.rig(made["rig"].drop_vars([*names, "angle"]), sides="closing")
    (axes,) = figure.axes
    assert "stage" in axes.get_title()
    assert [line.get_label() for line in axes.lines] == ["closing"]


def test_the_figure_of_a_sheet_shows_its_energy(made) -> None:
    (axes,) = fs.plot.sheet(made["sheet"]).axes
    closing = next(line for line in axes.lines if line.get_label() == "closing")
    np.testing.assert_allclose(closing.get_ydata(), made["sheet"]["energy"].sel(side="closing"))
    assert axes.get_xlabel() == "curvature of the end strips [mm⁻¹]"
    assert axes.get_ylabel() == "elastic energy of the sheet [N mm]"
    assert "60 mm × 30 mm, along 0°" in axes.get_title()


def test_the_figure_of_a_native_sheet_says_so(made) -> None:
    native = made["sheet"].assign(n_scales=np.int32(50))
    (axes,) = fs.plot.sheet(native).axes
    assert "native model" in axes.get_title()
    assert {line.get_color() for line in axes.lines} == {NATIVE_COLOR}
    (axes,) = fs.plot.sheet(made["sheet"]).axes
    assert "macro model" in axes.get_title()
    assert {line.get_color() for line in axes.lines} == {MACRO_COLOR}


def test_any_stored_dataset_is_drawn_with_its_inputs(made, model, tmp_path: Path) -> None:
    jobs = {job.step: job for job in plan_of(CONTENT)}
    store = Store(tmp_path)
    rig = store.publish(made["rig"], "rig", jobs["rig"].recipe)
    registry = fs.open_registry(tmp_path)
    assert len(draw_dataset(rig, registry).axes) == 2
    sweep = store.publish(law_sweep(), "sweep", jobs["sweep"].recipe)
    fit = store.publish(model.to_dataset(), "fit", jobs["fit"].recipe, [sweep])
    with pytest.raises(MissingDataError, match=sweep.id):
        draw_dataset(fit, registry)  # opened before its sweep was there
    assert draw_dataset(fit, fs.open_registry(tmp_path)).axes
    cell = dataclasses.replace(rig, kind="cell")
    with pytest.raises(BadInputError, match="no figure of a cell; there are some of fit, "):
        draw_dataset(cell, registry)


def test_every_kind_of_samples_can_be_drawn() -> None:
    drawn = {recipe.needs[0] for recipe in FIGURES.values()}
    assert set(SCHEMAS) - drawn == {"cell"}


def test_figures_refuse_other_datasets(made) -> None:
    with pytest.raises(SchemaError, match="needs energy"):
        fs.plot.sheet(made["rig"])
    with pytest.raises(SchemaError, match="kind rig"):
        fs.plot.rig(made["sheet"])
    with pytest.raises(UnknownNameError, match="no side 'open'"):
        fs.plot.rig(made["rig"], sides="open")


def test_forces_are_drawn_against_their_angle_however_they_lie(made) -> None:
    drawn = [
        [line.get_ydata() for line in fs.plot.rig(rig).axes[0].lines]
        for rig in (made["rig"], made["rig"].transpose("angle", "shortening", "side"))
    ]
    for one, other in zip(*drawn, strict=True):
        assert np.array_equal(one, other, equal_nan=True)


def test_a_sheet_that_failed_still_says_where() -> None:
    arrays = {name: np.ones((2, 2)) for name in ("energy", "energy_density", "moment", "slide")}
    arrays |= {"largest_curvature": np.ones((2, 2))}
    arrays |= {
        name: np.array([[0, 0], [0, 1]], dtype=np.int32)
        for name in ("newton_iterations", "negative_eigenvalues", "status")
    }
    labels = {"family": "IH76", "pattern": "square"}
    dataset = build_sheet_dataset(
        SCHEMAS["sheet"],
        ("closing", "opening"), [0.0, 0.01], arrays,
        length=100.0, width=50.0, direction=0.0, scalars=labels, config={},
    )  # fmt: skip
    check_dataset(dataset, "sheet")
    assert dataset["signed_curvature"].values.tolist() == [[0.0, 0.01], [0.0, -0.01]]
    assert np.isnan(dataset["energy"].values).tolist() == [[False, False], [False, True]]

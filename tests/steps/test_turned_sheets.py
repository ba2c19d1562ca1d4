"""Step `turned_sheet`: its block, dataset and figure."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

import flexscale as fs
from flexscale.datasets.checks import check_dataset
from flexscale.errors import BadInputError, MissingDataError, SchemaError
from flexscale.plotting.style import NOTE_COLOR
from flexscale.plotting.turned_sheets import TurnedColumn, sheet_errors, turned_sheets
from flexscale.status import SolveStatus
from flexscale.steps.catalog import STEPS
from flexscale.steps.experiment import parse_experiment
from flexscale.steps.plan import Plan, build_plan
from flexscale.steps.step import Resources
from flexscale.steps.summary import failed_samples
from tests.macro.fit_samples import law_sweep, tangent

CONTENT: dict[str, Any] = {
    "patterns": {"hexagon": {"family": "IH20"}},
    "sweep": {
        "directions": {"start": 0, "stop": 180, "step": 22.5},
        "curvatures": [0, 0.005, 0.01, 0.015],
    },
    "turned_sheet": {
        "length": 60,
        "width": 30,
        "curvature": 0.012,
        "directions": [0, 45],
        "size": 15,
    },
    "figures": ["turned_sheet"],
}


def plan_of(content: dict[str, Any]) -> Plan:
    return build_plan(parse_experiment(content, "file.yaml"))


@pytest.fixture(scope="module")
def sweep() -> xr.Dataset:
    return law_sweep()


@pytest.fixture(scope="module")
def turned(sweep: xr.Dataset) -> xr.Dataset:
    (job,) = (job for job in plan_of(CONTENT) if job.step == "turned_sheet")
    step = STEPS[job.step]
    parameters = step.task(job.recipe.parameters)
    return step.compute(parameters, {"sweep": sweep, "tangent": tangent()}, Resources())


def test_turned_sheets_come_from_sweep_and_tangent_without_a_fit() -> None:
    plan = plan_of(CONTENT)
    (job,) = (job for job in plan if job.step == "turned_sheet")
    assert [plan[needed].step for needed in job.inputs] == ["sweep", "tangent"]
    assert job.n_samples == 2 * 2 * 2
    assert [job.step for job in plan] == ["joint", "tangent", "sweep", "turned_sheet", "figure"]


def test_they_hold_what_the_simulations_give(turned: xr.Dataset, sweep: xr.Dataset) -> None:
    check_dataset(turned, "turned_sheet")
    assert turned["energy"].dims == ("variant", "side", "direction")
    assert (turned["status"] == 0).all()
    for variant in ("tangent", "paper"):
        model = fs.fit(sweep, tangent(), variant=variant)
        alone = fs.simulate_sheet(
            model,
            length=60.0,
            width=30.0,
            curvature=-0.012,
            direction=45.0,
            options=fs.SheetOptions(size=15.0),
        )
        one = turned.sel(variant=variant, side="opening", direction=45.0)
        assert float(one["energy_density"]) == pytest.approx(alone.energy_density, rel=1e-9)
        # Moments belong to the side, as those of a sweep: both are positive.
        assert float(one["moment"]) == pytest.approx(-alone.moment, rel=1e-9)
        law = float(model.energy(0.012, 45.0, "opening"))
        assert float(one["law_energy_density"]) == pytest.approx(law, rel=1e-12)
    assert turned["signed_curvature"].values.tolist() == [0.012, -0.012]


def test_free_sides_only_soften_a_sheet(turned: xr.Dataset) -> None:
    """A sheet takes the state of least energy; the cylinder is one that it could take."""
    assert (turned["energy_density"] <= turned["law_energy_density"] * (1.0 + 1e-9)).all()
    # The paper's energy does not couple principal curvatures, so nothing is won by a saddle.
    ratio = turned["energy_density"] / turned["law_energy_density"]
    assert (ratio.sel(variant="paper") > ratio.sel(variant="tangent")).all()


def test_a_sheet_that_fails_is_listed(turned: xr.Dataset) -> None:
    spoiled = turned.copy(deep=True)
    spoiled["status"].values[1, 0, 1] = SolveStatus.stalled
    with pytest.raises(SchemaError, match="direction 45 degree, where the status is stalled"):
        check_dataset(spoiled, "turned_sheet")
    for name, variable in spoiled.data_vars.items():
        if variable.dims == spoiled["status"].dims and variable.dtype.kind == "f":
            spoiled[name].values[1, 0, 1] = np.nan
    check_dataset(spoiled, "turned_sheet")
    assert failed_samples(spoiled) == ["stalled: direction 45 degree, closing, paper"]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda ds: ds.isel(direction=[1, 0]), "strictly increasing"),
        (lambda ds: ds.assign_coords(direction=ds["direction"] + 140.0), r"in \[0, 180\)"),
        (lambda ds: ds.assign_coords(variant=ds["variant"].str.replace("p", "v")), "the energies"),
        (lambda ds: ds.assign_coords(curvature=0.0 * ds["curvature"]), "must be positive"),
        (lambda ds: ds.assign_coords(curvature=2.0 * ds["curvature"]), "do not follow"),
    ],
)
def test_spoiled_ones_are_refused(turned: xr.Dataset, change: Any, words: str) -> None:
    with xr.set_options(keep_attrs=True):
        spoiled = change(turned)
    with pytest.raises(SchemaError, match=words):
        check_dataset(spoiled, "turned_sheet")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"sweep": None}, "`turned_sheet` needs the block `sweep`"),
        ({"turned_sheet": None}, "the figure 'turned_sheet' needs the block `turned_sheet`"),
        ({"turned_sheet": {"curvature": 0.07}}, "runs into its own end: stay below 0.06283 mm-1"),
        ({"turned_sheet": {"directions": [0, 180]}}, "directions lie in [0, 180) degree"),
        ({"turned_sheet": {"directions": []}}, "at least 1 item"),
        ({"turned_sheet": {"variants": ["paper", "paper"]}}, "an energy is named twice"),
        ({"turned_sheet": {"sides": ["opening", "opening"]}}, "a side is named twice"),
    ],
)
def test_bad_blocks_are_refused(change: dict[str, Any], words: str) -> None:
    with pytest.raises(BadInputError) as caught:
        plan_of(CONTENT | change)
    assert words in str(caught.value)


def test_the_figure_shows_sheets_and_cell_and_their_ratio(
    turned: xr.Dataset, sweep: xr.Dataset
) -> None:
    figure = fs.plot.turned_sheet(turned, sweep)
    polar = figure.axes[0]
    cell = sweep["energy_density"].sel(side="closing", curvature=0.012, direction=[0.0, 45.0])
    drawn = {line.get_label(): line for line in polar.lines if line.get_label()[0] != "_"}
    radii = drawn["cell"].get_ydata()
    np.testing.assert_array_equal(radii[np.isfinite(radii)], cell.values)
    assert set(drawn) == {"cell", "tangent", "paper"}
    errors = {line.get_label(): line for line in figure.axes[1].lines}
    sheets = turned["energy_density"].sel(side="closing", variant="paper").values
    expected = 100.0 * (sheets / cell.values - 1.0)
    np.testing.assert_allclose(errors["paper"].get_ydata(), expected, rtol=1e-12)
    np.testing.assert_allclose(
        sheet_errors(turned, sweep).sel(side="closing", variant="paper"), expected / 100.0
    )
    assert "60 mm × 30 mm at 0.012 mm⁻¹" in figure.get_supxlabel()


def test_a_sweep_of_other_curvatures_is_refused(turned: xr.Dataset, sweep: xr.Dataset) -> None:
    with pytest.raises(MissingDataError, match=r"at 0\.012 mm-1"):
        fs.plot.turned_sheet(turned, sweep.isel(curvature=slice(0, 4)))
    with pytest.raises(SchemaError, match="turned sheets"):
        fs.plot.turned_sheet(sweep, sweep)


def test_sheets_of_scales_and_another_model_stand_beside(
    turned: xr.Dataset, sweep: xr.Dataset
) -> None:
    """Each in its own color and mark; errors are those against the cell."""
    scales = turned.isel(variant=0, drop=True).drop_vars("law_energy_density").copy(deep=True)
    scales["energy_density"] *= 0.9
    figure = turned_sheets([TurnedColumn(turned, sweep, "closing", scales)])
    polar, errors = figure.axes
    (alone,) = fs.plot.native_turned_sheet(scales, "closing").axes
    (own,) = (line for line in alone.lines if line.get_label() == "scales")
    radii = own.get_ydata()
    own_energies = scales["energy_density"].sel(side="closing").values
    np.testing.assert_array_equal(radii[np.isfinite(radii)], own_energies)
    drawn = {line.get_label(): line for line in errors.lines}
    off = sheet_errors(scales, sweep).sel(side="closing")
    np.testing.assert_allclose(drawn["scales"].get_ydata(), 100.0 * off)
    looks = {
        (drawn[name].get_color(), drawn[name].get_marker())
        for name in ("scales", "tangent", "paper")
    }
    assert len(looks) == len({color for color, _ in looks}) == 3
    assert drawn["scales"].get_linestyle() == "None"
    assert "scales" in {line.get_label() for line in polar.lines}

    half = sweep.copy(deep=True)
    half["energy_density"] *= 0.5
    (column,) = [TurnedColumn(turned, sweep, "closing", None, (turned, half))]
    beside = turned_sheets([column])
    (thin,) = (line for line in beside.axes[0].lines if line.get_color() == NOTE_COLOR)
    expected = 0.5 * sweep["energy_density"].sel(side="closing", curvature=0.012, direction=0.0)
    assert thin.get_ydata()[0] == pytest.approx(float(expected))
    (legend,) = beside.legends
    assert "cell, shell" in [text.get_text() for text in legend.get_texts()]
    below = [line for line in beside.axes[1].lines if line.get_linewidth() == 0.6]
    other = 100.0 * sheet_errors(turned, half).sel(side="closing")
    np.testing.assert_allclose([line.get_ydata() for line in below], other)

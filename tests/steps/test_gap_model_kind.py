"""Kind `gap_model`: to a dataset and back, in an experiment, on sheets and devices, drawn."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import flexscale as fs
from flexscale.datasets.checks import check_dataset
from flexscale.errors import ConfigError, SchemaError
from flexscale.homogenize.flat_contact import FlatContact
from flexscale.steps.catalog import STEPS
from flexscale.steps.experiment import parse_experiment
from flexscale.steps.plan import build_plan
from flexscale.steps.step import Resources

PATTERNS = {"patterns": {"square": {"named": "square"}}}
SHEET = {"model": "gap_model", "length": 60, "width": 30, "curvatures": [0, 0.02], "size": 15}
STAGE = {"length": 60, "width": 30, "shortenings": [2]}


@pytest.fixture(scope="module")
def model() -> fs.GapModel:
    """Two gaps: one closes in bending along x, the other in bending across."""
    gaps = FlatContact(
        np.array([0.4, 0.4]), np.array([[-40.0, 0, 0], [0, -20.0, 0]]), np.diag([2.0, 3.0])
    )
    return fs.GapModel(
        np.diag([5.0, 4.0, 1.0]), np.diag([9.0, 9.0, 3.0]), gaps, 0.1, 0.2, 7.0,
        {"family": "IH76", "pattern": "square", "gap": 0.4},
    )  # fmt: skip


@pytest.fixture(scope="module")
def dataset(model: fs.GapModel) -> xr.Dataset:
    return model.to_dataset()


def test_a_dataset_holds_all_of_the_model(model: fs.GapModel, dataset: xr.Dataset) -> None:
    check_dataset(dataset, "gap_model")
    again = fs.GapModel.from_dataset(dataset)
    for name in ("tangent", "in_plane"):
        assert np.array_equal(getattr(again, name), getattr(model, name))
    for name in ("distances", "slopes", "compliance"):
        assert np.array_equal(getattr(again.contact, name), getattr(model.contact, name))
    for name in ("softening", "contact_softening", "w_biaxial", "largest_curvature", "labels"):
        assert getattr(again, name) == getattr(model, name)
    kappa = np.linspace(0.0, 0.03, 5)
    assert again.moment(kappa, 30.0, "closing") == pytest.approx(
        model.moment(kappa, 30.0, "closing"), rel=0.0
    )


def test_onsets_are_those_of_the_gaps(dataset: xr.Dataset) -> None:
    onset = dataset["onset"]
    assert float(onset.sel(side="closing", direction=0)) == pytest.approx(0.01)
    assert float(onset.sel(side="closing", direction=90)) == pytest.approx(0.02)
    assert np.isnan(onset.sel(side="opening")).all()
    assert onset.attrs["units"] == "mm-1"


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("distances", [-1.0, 0.4], "not negative at rest"),
        ("compliance", [[2.0, 1.0], [0.0, 3.0]], "must be symmetric"),
        ("softening", -1.0, "softening of a gap model is -1"),
        ("onset", np.full((2, 36), 0.5), "do not follow from its gaps"),
        ("tangent", np.arange(9.0).reshape(3, 3), "must be symmetric"),
    ],
)
def test_values_that_cannot_be_are_refused(
    dataset: xr.Dataset, name: str, value: object, said: str
) -> None:
    wrong = dataset.copy(deep=True)
    wrong[name] = wrong[name].copy(data=np.asarray(value, dtype=float))
    with pytest.raises(SchemaError, match=said):
        fs.GapModel.from_dataset(wrong)
    with pytest.raises(SchemaError, match="needs tangent"):
        fs.GapModel.from_dataset(xr.Dataset())


def test_gaps_that_close_by_rounding_alone_never_do(model: fs.GapModel) -> None:
    """As those of rhombi do, opened where their slope changes its sign."""
    gaps = FlatContact(
        np.array([0.4, 0.4]), np.array([[-40.0, 0, 0], [0, -1e-13, 0]]), np.diag([2.0, 3.0])
    )
    onset = replace(model, contact=gaps).to_dataset()["onset"]
    assert np.isnan(float(onset.sel(side="closing", direction=90)))
    fs.gap_model(fs.named_pattern("rhombus")).to_dataset()


def test_every_gap_has_its_compliance(dataset: xr.Dataset) -> None:
    with pytest.raises(SchemaError, match="a row for each gap"):
        fs.GapModel.from_dataset(dataset.isel(other_contact=[0]))


def test_sheets_and_devices_take_it_in_an_experiment(dataset: xr.Dataset) -> None:
    content = PATTERNS | {"gap_model": {}, "sheet": SHEET}
    content |= {"rig": {"model": "gap_model", "stage": STAGE, "size": 15, "sides": "closing"}}
    jobs = {job.step: job for job in build_plan(parse_experiment(content, "file"))}
    assert set(jobs) == {"joint", "gap_model", "sheet", "rig"}
    assert jobs["gap_model"].inputs == (jobs["joint"].id,)
    for name in ("sheet", "rig"):
        assert jobs[name].inputs == (jobs["gap_model"].id,)
        step = STEPS[name]
        task = step.task(jobs[name].recipe.parameters)
        made = step.compute(task, {"gap_model": dataset}, Resources())
        check_dataset(made, name)
        assert float(made["energy" if name == "sheet" else "stage_energy"].max()) > 0.0


def test_the_fit_stays_the_model_of_recipes_that_name_none() -> None:
    named, silent = ({"fit": {}, "sheet": sheet} for sheet in ({"model": "fit"}, {}))
    sweep = {"sweep": {"directions": {"start": 0, "stop": 180, "step": 15},
                       "curvatures": [0, 0.002, 0.004, 0.006, 0.008, 0.01]}}  # fmt: skip
    found = [
        [job.id for job in build_plan(parse_experiment(PATTERNS | sweep | blocks, "file"))]
        for blocks in (named, silent)
    ]
    assert found[0] == found[1]


def test_what_does_not_go_together_is_refused() -> None:
    for blocks, said in (
        ({"sheet": SHEET}, "`sheet` needs the block `gap_model`"),
        ({"gap_model": {"softened": True}}, "`gap_model` needs the block `sweep`"),
        ({"gap_model": {}, "contact": {"enabled": False}}, "leave contact.enabled true"),
        (
            {"gap_model": {}, "sheet": SHEET | {"model": "joints"}},
            "'fit', 'gap_model' or 'tensor_model'",
        ),
    ):
        with pytest.raises(ConfigError, match=said):
            parse_experiment(PATTERNS | blocks, "file")


def test_its_figure_shows_both_sides_and_what_is_left_out(dataset: xr.Dataset) -> None:
    assert "not drawn" not in str([t.get_text() for t in fs.plot.gap_model(dataset).texts])
    wide = dataset.copy(deep=True)
    wide["onset"][0, 5] = 0.2
    figure = fs.plot.gap_model(wide)
    stiffness, onset = figure.axes
    assert "N mm" in stiffness.get_title()
    assert "mm⁻¹" in onset.get_title()
    radii = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in onset.lines])
    assert 0.0 < np.nanmax(radii) <= 0.03
    said = " ".join(text.get_text() for text in figure.texts)
    assert "not drawn: first contact beyond 0.03 mm⁻¹" in said

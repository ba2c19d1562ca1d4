"""Kind `tensor_model`: in an experiment, on sheets and devices, exported, drawn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import flexscale as fs
from flexscale.datasets.checks import check_dataset
from flexscale.errors import BadInputError, ConfigError
from flexscale.exchange.bending import evaluate_bending, is_within_data
from flexscale.steps.catalog import STEPS
from flexscale.steps.experiment import parse_experiment
from flexscale.steps.plan import build_plan
from flexscale.steps.step import Resources

PATTERNS = {"patterns": {"hexagon": {"named": "hexagon"}}}
RAYS = {
    "directions": [0, 20, 40],
    "shapes": [-135, -90, -45, 0, 45],
    "curvatures": [0.002 * k for k in range(13)],
}
MODEL = {"tensor_sweep": RAYS, "gap_model": {}, "tensor_model": {}}
SHEET = {"model": "tensor_model", "length": 60, "width": 30, "curvatures": [0, 0.015], "size": 15}
STAGE = {"length": 60, "width": 30, "shortenings": [2]}


@pytest.fixture(scope="module")
def made() -> dict[str, xr.Dataset]:
    """All datasets of an experiment, each computed by its step."""
    content = PATTERNS | MODEL | {"sheet": SHEET}
    content |= {"rig": {"model": "tensor_model", "stage": STAGE, "size": 15, "sides": "closing"}}
    jobs = build_plan(parse_experiment(content, "file"))
    found: dict[str, xr.Dataset] = {}
    of_job: dict[str, str] = {}
    for job in jobs:
        step, of_job[job.id] = STEPS[job.step], job.step
        inputs = {of_job[other]: found[of_job[other]] for other in job.inputs}
        found[job.step] = step.compute(
            step.task(job.recipe.parameters), inputs, Resources(workers=1)
        )
    assert {"joint", "tensor_sweep", "gap_model", "tensor_model", "sheet", "rig"} == set(found)
    return found


def test_an_experiment_makes_it_and_bends_sheets_of_it(made: dict[str, xr.Dataset]) -> None:
    for kind in ("tensor_model", "sheet", "rig"):
        check_dataset(made[kind], kind)
    sheet, model = made["sheet"], fs.TensorModel.from_dataset(made["tensor_model"])
    energy = float(sheet["energy"].sel(side="closing", curvature=0.015))
    cylinder = float(model.energy(0.015, 0.0)) * 60.0 * 30.0
    assert 0.6 * cylinder < energy < 1.1 * cylinder  # free sides take some of it


def test_its_figure_tells_errors(made: dict[str, xr.Dataset]) -> None:
    figure = fs.plot.tensor_model(made["tensor_model"])
    shown, over = figure.axes[:2]
    assert "[%]" in shown.get_title()
    assert over.get_ylabel() == "error of the energy [%]"
    assert "mm⁻¹" in over.get_xlabel()
    said = " ".join(text.get_text() for text in figure.texts)
    assert "rays held out: 95 % of energies within" in said
    errors = 100.0 * np.abs(made["tensor_model"]["energy_error"].values)
    median = np.nanmedian(errors[:, :, -1])
    drawn = np.asarray(over.lines[0].get_ydata(), dtype=float)
    assert drawn[-1] == pytest.approx(median)


def test_tables_of_it_are_its_law(made: dict[str, xr.Dataset], tmp_path: Path) -> None:
    model = fs.TensorModel.from_dataset(made["tensor_model"])
    path = fs.export(made["tensor_model"], to="table-netcdf", path=tmp_path / "law.nc")
    assert path.exists()
    curvatures = np.array([[0.01, -0.004, 0.003], [0.002, 0.02, 0.0]])
    energies, gradients = evaluate_bending(model.sheet_law(), curvatures)
    tensors = curvatures[:, [0, 2, 2, 1]].reshape(-1, 2, 2)
    assert energies == pytest.approx(model.tensor_energy(tensors))
    assert gradients[:, 0] == pytest.approx(model.tensor_moment(tensors)[:, 0, 0])
    assert is_within_data(model, np.array([[0.016, 0.016, 0.0], [0.018, 0.018, 0.0]])).tolist() == [
        True,
        False,
    ]
    for name in ("laminate-json", "abaqus", "hylc"):
        assert fs.export(model, to=name, path=tmp_path / f"{name}.txt").stat().st_size > 100
    with pytest.raises(BadInputError, match="needs a law in closed form"):
        fs.export(model, to="c-header", path=tmp_path / "law.h")


def test_what_does_not_go_together_is_refused() -> None:
    held = {"tensor_sweep": RAYS | {"in_plane": "held"}}
    for blocks, said in (
        ({"tensor_model": {}}, "`tensor_model` needs the block `tensor_sweep`"),
        (MODEL | held, "free in their plane"),
        ({"sheet": SHEET}, "`sheet` needs the block `tensor_model`"),
    ):
        with pytest.raises(ConfigError, match=said):
            parse_experiment(PATTERNS | blocks, "file")

"""Gaps of the flat cell: closed forms, and native samples."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import flexscale as fs
from flexscale.errors import BadInputError, UnitRangeError
from flexscale.homogenize.bend_line import Line
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.flat_contact import solve_flat_contact
from flexscale.homogenize.line import follow_line
from flexscale.solve.solver_options import SolverOptions

COARSE = fs.MeshOptions().finer(0.5)
COARSEST = fs.MeshOptions(scale_layers=2, scale_size=6, scale_strips=1, across=2)


@cache
def flat(name: str) -> fs.GapModel:
    """Of the flat cell of a pattern, solved once."""
    return fs.gap_model(fs.named_pattern(name), model=fs.NativeModel("shell", mesh=COARSE))


@pytest.fixture(scope="module")
def squares() -> fs.GapModel:
    return flat("square")


@pytest.fixture(scope="module")
def reference_hexagon(shipped_results: Path) -> xr.Dataset:
    return fs.open_registry(shipped_results).one(kind="sweep", pattern="hexagon", native="shell")


def test_squares_meet_where_rigid_blocks_on_hinges_do(squares: fs.GapModel) -> None:
    """All bending is in the gaps, which close at the scales' tops: gap / (height x pitch)."""
    pattern = fs.named_pattern("square")
    height = pattern.scale_height + 0.5 * pattern.substrate_thickness
    expected = pattern.gap / (height * 10.0)
    np.testing.assert_allclose(squares.onset([0.0, 90.0]), expected, rtol=0.06)
    assert squares.onset(0.0, "opening") > 1.0
    # Each of two rows of gaps closes by the curvature across it alone.
    tensor = np.diag([1.0, 1.0])
    assert squares.tensor_onset(tensor) == pytest.approx(squares.onset(0.0), rel=0.03)


@pytest.mark.parametrize(("gap", "height"), [(0.4, 1.0), (2.0, 4.0), (0.4, 4.0)])
def test_low_scales_and_wide_gaps_meet_late(gap: float, height: float) -> None:
    """Rigid blocks on hinges again: 0.04 and 0.05 mm-1 lie beyond all sample curvatures."""
    pattern = fs.named_pattern("square", gap=gap, scale_height=height)
    model = fs.gap_model(pattern, model=fs.NativeModel("shell", mesh=COARSEST))
    expected = gap / (height * 10.0)
    np.testing.assert_allclose(model.onset([0.0, 90.0]), expected, rtol=0.06)
    assert np.isfinite(model.onset(np.arange(0.0, 180.0, 5.0))).all()
    # What meets also resists: blocks that touch are far stiffer than hinges.
    free = 0.5 * model.tangent[0, 0]
    assert model.energy(0.9 * expected, 0.0) == pytest.approx(free * (0.9 * expected) ** 2)
    assert model.energy(2.0 * expected, 0.0) > 3.0 * free * (2.0 * expected) ** 2
    said = repr(model).split("opening")[0]
    assert f"contact from {float(model.onset(0.0)):.3g} mm-1 on, at 0 degree" in said
    assert ("beyond 0.03 mm-1" in said) == (expected > model.largest_curvature)


@pytest.mark.slow
def test_a_sweep_meets_where_a_late_onset_says() -> None:
    pattern = fs.named_pattern("square", scale_height=1.0)
    onset = float(fs.gap_model(pattern, model=fs.NativeModel("shell", mesh=COARSEST)).onset(0.0))
    cell = CellProblem.from_pattern(pattern, fs.NativeModel("shell", mesh=COARSEST))
    line = Line("closing", 0.0, tuple(onset * np.array([0.0, 0.3, 0.6, 0.9, 1.1])))
    pairs = [s["contact_pairs"] for s in follow_line(cell, line, SolverOptions())]
    assert pairs[-2] == 0
    assert pairs[-1] > 0


@pytest.mark.parametrize("name", ["hexagon", "arrowhead"])
def test_onset_is_that_of_native_sweeps(name: str, shipped_results: Path) -> None:
    """Between the last sample free of contact and the first one in contact, give or take a tenth:
    the barrier acts before scales meet, and gaps turn as they close."""
    sweep = fs.open_registry(shipped_results).one(kind="sweep", pattern=name, native="shell")
    model = flat(name)
    kappa, checked = sweep["curvature"].values, 0
    for side in ("closing", "opening"):
        for direction in sweep["direction"].values:
            touches = sweep["contact_pairs"].sel(side=side, direction=direction).values > 0
            if not touches.any():
                continue
            first = int(np.argmax(touches))
            onset = float(model.onset(direction, side))
            assert 0.9 * kappa[first - 1] < onset < 1.15 * kappa[first]
            checked += 1
    assert checked >= len(sweep["direction"])


def test_softenings_fitted_to_a_sweep_bring_energies_close(reference_hexagon: xr.Dataset) -> None:
    sweep = reference_hexagon
    rough = flat("hexagon")
    fitted = rough.fitted(sweep)
    before, after = (np.sqrt(np.mean(m.errors(sweep)[0] ** 2)) for m in (rough, fitted))
    assert before < 0.15
    assert after < 0.06
    with pytest.raises(BadInputError, match="different patterns"):
        fs.gap_model(fs.named_pattern("square"), sweep, model=fs.NativeModel("shell", mesh=COARSE))


def test_what_a_sweep_does_not_show_is_not_fitted(
    reference_hexagon: xr.Dataset, shipped_results: Path
) -> None:
    rough = flat("hexagon")
    opening = rough.fitted(reference_hexagon.sel(side=["opening"]))
    assert opening.softening > 0.0
    assert opening.contact_softening == 0.0
    with pytest.raises(BadInputError, match="different patterns"):
        rough.errors(
            fs.open_registry(shipped_results).one(kind="sweep", pattern="square", native="shell")
        )
    bad = reference_hexagon.copy(deep=True)
    bad["moment"][0, 0, 5] = -1e-3
    assert rough.fitted(bad).softening == pytest.approx(
        rough.fitted(reference_hexagon).softening, rel=0.1
    )


def test_onsets_are_of_tensors(squares: fs.GapModel) -> None:
    for wrong in (1.0, np.diag([np.nan, 0.0]), [[0.0, 1.0], [0.0, 0.0]]):
        with pytest.raises(UnitRangeError, match="urvature tensor"):
            squares.tensor_onset(wrong)


def test_fewer_overlaps_change_little() -> None:
    problem = CellProblem.from_pattern(
        fs.named_pattern("arrowhead"), fs.NativeModel("shell", mesh=COARSE)
    )
    rough, fine = (solve_flat_contact(problem, overlap) for overlap in (0.02, 0.005))
    assert len(rough) < len(fine)
    for k in ([0.02, -0.01, 0.0], [0.0, -0.025, 0.005], [0.01, 0.01, -0.02]):
        energies = []
        for found in (rough, fine):
            p = found.pressures(np.array(k))
            energies.append(0.5 * p @ -(found.distances + found.slopes @ k))
        assert energies[0] == pytest.approx(energies[1], rel=5e-3)


def test_without_scales_or_contact_there_are_no_gaps() -> None:
    problem = CellProblem.from_pattern(
        fs.named_pattern("square"),
        fs.NativeModel("shell", contact=fs.ContactOptions(enabled=False), mesh=COARSE),
    )
    found = solve_flat_contact(problem)
    assert len(found) == 0
    assert found.onset(np.array([1.0, 0.0, 0.0])) == np.inf


def test_an_overlap_is_allowed() -> None:
    problem = CellProblem.from_pattern(
        fs.named_pattern("square"), fs.NativeModel("shell", mesh=COARSE)
    )
    with pytest.raises(UnitRangeError, match="overlap"):
        solve_flat_contact(problem, 0.0)
    assert len(solve_flat_contact(problem, 1e-10)) >= len(solve_flat_contact(problem))

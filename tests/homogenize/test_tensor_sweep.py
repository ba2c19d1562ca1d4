"""Tensor sweeps: cylinders, small curvatures, derivatives, symmetry, objectivity, resumption."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import flexscale as fs
from flexscale.datasets.checks import check_dataset
from flexscale.datasets.identity import content_digest
from flexscale.datasets.kinds.tensor_sweep import ray_moments, unit_tensors
from flexscale.datasets.staging import FileCheckpoint
from flexscale.errors import ConfigError, UnitRangeError, UnknownNameError
from flexscale.homogenize.joint_cell import JointCell
from flexscale.homogenize.symmetry import turn_stretch
from flexscale.homogenize.tangent import solve_tangent
from flexscale.homogenize.tensor_line import TensorLine
from flexscale.patterns import Pattern
from flexscale.solve.newton import solve_equilibrium
from flexscale.status import SolveStatus
from tests.derivatives import directional_difference

LAW = fs.joint_law(fs.named_pattern("square", scale_material=fs.RIGID))
MODEL = fs.NativeModel(law=LAW, solver=fs.SolverOptions(tolerance=1e-12))
HEXAGON = fs.named_pattern("hexagon")
OBLIQUE = np.array([[0.0, 0.0], [11.0, 0.0], [13.0, 8.0], [2.0, 8.0]])
CURVATURES = [0.0, 0.004, 0.008, 0.012, 0.016]


def run(
    directions: Any,
    shapes: Any,
    curvatures: Any = CURVATURES,
    pattern: Pattern = HEXAGON,
    **more: Any,
) -> xr.Dataset:
    options = {"workers": 1, "model": MODEL} | more
    data = fs.tensor_sweep(pattern, directions, shapes, curvatures, **options)
    check_dataset(data, "tensor_sweep")
    return data


def components(data: xr.Dataset, name: str) -> np.ndarray:
    """(..., 3) xx, yy, xy."""
    return np.stack([data[f"{name}_{part}"].values for part in ("xx", "yy", "xy")], axis=-1)


@pytest.mark.parametrize(
    ("shape", "side", "across"), [(0.0, "closing", 0.0), (-90.0, "opening", 90.0)]
)
def test_cylinders_are_those_of_sweeps(shape: float, side: str, across: float) -> None:
    """Of one solver tolerance, so that energies in contact differ by its square."""
    data = run([10.0], [shape])
    assert (data["contact_pairs"].values.max() > 0) == (side == "closing")
    sweep = fs.sweep(HEXAGON, [10.0 + across], CURVATURES, [side], workers=1, model=MODEL)
    for name in ("energy_density", "min_gap"):
        assert data[name].values.ravel() == pytest.approx(sweep[name].values.ravel(), rel=1e-9)
    assert ray_moments(data).ravel() == pytest.approx(sweep["moment"].values.ravel(), rel=1e-8)
    assert components(data, "stretch")[0, 0] == pytest.approx(
        sweep["stretch"].values[0, 0], rel=1e-9, abs=1e-12
    )


@pytest.mark.parametrize("in_plane", ["free", "held"])
def test_small_curvatures_meet_the_tangent(in_plane: str) -> None:
    """Membrane forces of a cell that is held are its coupling of strain and bending."""
    pattern = Pattern.from_polygons([OBLIQUE], OBLIQUE[1], OBLIQUE[3])
    data = run([20.0], [-135.0, -70.0, 45.0], [0.0, 1e-6], pattern, in_plane=in_plane)
    tangent = solve_tangent(JointCell(pattern, LAW, MODEL))
    expected = tangent.matrix if in_plane == "free" else tangent.held
    assert expected is not None
    assert tangent.coupling is not None
    assert data["tangent"].values == pytest.approx(expected, rel=1e-9, abs=1e-9)
    k = 1e-6 * unit_tensors(20.0, data["shape"].values) * [1.0, 1.0, 2.0]
    last = data.isel(direction=0, curvature=1)
    assert last["energy_density"].values == pytest.approx(
        0.5 * np.einsum("si,ij,sj->s", k, expected, k), rel=1e-3
    )
    size = np.abs(k @ expected).max()
    assert components(last, "moment") == pytest.approx(k @ expected, abs=1e-3 * size)
    if in_plane == "held":
        forces = k @ tangent.coupling.T
        assert components(last, "membrane_force") == pytest.approx(
            forces, abs=1e-3 * np.abs(forces).max()
        )


def test_moments_are_derivatives_of_the_energy_in_contact() -> None:
    """By direction, shape and size, from neighboring rays."""
    step, size = 0.05, 1e-5  # degree, mm-1
    directions, shapes = ([mean - step, mean, mean + step] for mean in (20.0, 25.0))
    data = run(directions, shapes, [0.0, 0.014 - size, 0.014, 0.014 + size])
    assert (data["contact_pairs"].values[:, :, 2] > 0).all()
    energy, moment = data["energy_density"].values, components(data, "moment")[1, 1, 2]
    rates = [
        (energy[2, 1, 2] - energy[0, 1, 2]) / (2.0 * step),
        (energy[1, 2, 2] - energy[1, 0, 2]) / (2.0 * step),
        (energy[1, 1, 3] - energy[1, 1, 1]) / (2.0 * size),
    ]
    ways = [
        0.014 * directional_difference(lambda s: unit_tensors(20.0 + s, 25.0), 0.01),
        0.014 * directional_difference(lambda s: unit_tensors(20.0, 25.0 + s), 0.01),
        unit_tensors(20.0, 25.0),
    ]
    for rate, way in zip(rates, ways, strict=True):
        assert moment @ (way * [1.0, 1.0, 2.0]) == pytest.approx(rate, rel=1e-4)


def test_filled_rays_are_what_solving_them_gives() -> None:
    arguments = ([15.0, 45.0, 75.0, 165.0], [-110.0, -45.0, 20.0, 45.0], [0.0, 0.012])
    filled, full = run(*arguments), run(*arguments, symmetry=False)
    assert filled["symmetry_source"].values.tolist() == [[15.0] * 4] * 4
    assert full["symmetry_source"].values[:, 0].tolist() == arguments[0]
    assert full["symmetry_source"].values[:, 3].tolist() == [15.0] * 4  # a dome has no direction
    for name in filled.data_vars:
        if filled[name].dtype.kind == "f" and name not in ("symmetry_source", "residual_norm"):
            values = filled[name].values
            size = np.nanmax(np.abs(values))
            np.testing.assert_allclose(values, full[name].values, rtol=1e-8, atol=1e-8 * size)
    assert np.ptp(filled["moment_xy"].values[:, 1, 1]) > 0.1 * np.abs(filled["moment_xx"]).max()


@pytest.mark.parametrize("in_plane", ["free", "held"])
def test_turning_pattern_and_curvature_together(in_plane: str) -> None:
    angle = np.radians(33.0)
    r = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    turned = Pattern.from_polygons([OBLIQUE @ r.T], r @ OBLIQUE[1], r @ OBLIQUE[3])
    pattern = Pattern.from_polygons([OBLIQUE], OBLIQUE[1], OBLIQUE[3])
    shapes = [-60.0, 0.0, 45.0]
    # One scale that is held has no way to go from where it meets others.
    curvatures = [0.0, 0.018 if in_plane == "free" else 0.008]
    before = run([25.0], shapes, curvatures, pattern, in_plane=in_plane)
    after = run([58.0], shapes, curvatures, turned, in_plane=in_plane)
    assert (before["status"].values == 0).all()
    assert (before["contact_pairs"].values[0, 1:, 1] > 0).all() == (in_plane == "free")
    np.testing.assert_allclose(before["energy_density"], after["energy_density"], rtol=1e-8)
    for name in ("moment", "stretch" if in_plane == "free" else "membrane_force"):
        expected = turn_stretch(components(before, name), r)
        found = components(after, name)
        np.testing.assert_allclose(found, expected, atol=1e-8 * np.abs(expected).max())


def test_a_lattice_that_is_held_has_the_forces_of_its_energy() -> None:
    """Strains are prescribed one by one; everything else is at equilibrium."""
    line = TensorLine(20.0, 20.0, (0.014,))
    problem = JointCell(fs.named_pattern("chevron"), LAW, MODEL, stretches=False)
    bent, z = problem.bent(line.bend(0.014)), problem.embedding.rest
    for share in np.linspace(0.0, 1.0, 15)[1:]:
        z = solve_equilibrium(problem.bent(line.bend(0.014 * share)), z, MODEL.solver).z
    assert (z[-3:] == 0.0).all()
    state = bent.evaluate(z)
    assert state.parts[1] > 0.0

    def energy(component: int, strain: float) -> float:
        start = z.copy()
        start[-3 + component] = strain
        found = solve_equilibrium(bent, start, MODEL.solver)
        assert found.status == SolveStatus.converged
        assert found.z[-3 + component] == strain
        return float(found.evaluation.energy) / problem.area

    forces, counted = bent.membrane_forces(state), (1.0, 1.0, 2.0)
    for component in range(3):
        rate = directional_difference(lambda s, c=component: energy(c, s), 1e-6)
        assert counted[component] * forces[component] == pytest.approx(
            rate, rel=1e-4, abs=1e-4 * np.abs(forces).max()
        )


def test_a_held_sheet_has_more_energy() -> None:
    free, held = (
        run([10.0], [-45.0, 0.0, 45.0], [0.0, 0.004, 0.008], in_plane=name)
        for name in ("free", "held")
    )
    assert "membrane_force_xx" not in free
    assert "stretch_xx" not in held
    ratio = held["energy_density"].values[..., 1:] / free["energy_density"].values[..., 1:]
    assert (ratio > 1.0 + 1e-6).all()


def test_one_scale_that_is_held_locks_where_scales_meet() -> None:
    """Neighbors cannot part, so that beyond there is no state without overlap."""
    data = run([10.0], [0.0], [0.0, 0.008, 0.011, 0.016], in_plane="held")
    status = [SolveStatus.converged, SolveStatus.infeasible_start, SolveStatus.not_run]
    assert data["status"].values.ravel().tolist() == [status[0], *status]


def test_interrupted_sweeps_go_on_bit_for_bit(tmp_path: Path) -> None:
    """Killed after a sample and started again, and in processes: the same bits."""

    class Killed(Exception):
        pass

    def stop(event: Any) -> None:
        if event.done == 4:
            raise Killed

    arguments, checkpoint = (
        ([0.0, 40.0], [-45.0, 45.0], [0.0, 0.006, 0.012]),
        FileCheckpoint(tmp_path),
    )
    reference = run(*arguments)
    with pytest.raises(Killed):
        run(*arguments, checkpoint=checkpoint, on_sample=stop)
    events: list[Any] = []
    resumed = run(*arguments, checkpoint=checkpoint, on_sample=events.append)
    assert content_digest(resumed) == content_digest(reference)
    assert [event.done for event in events] == list(range(1, 10))  # of three rays, one a dome
    assert {(event.direction, event.shape) for event in events} == {(0, -45), (0, 45), (40, -45)}
    assert content_digest(run(*arguments, workers=2)) == content_digest(reference)


def test_samples_that_do_not_converge_are_labelled_and_empty() -> None:
    solver = fs.SolverOptions(max_iterations=1, tolerance=1e-14)
    data = run([0.0], [-45.0], [0.0, 0.03, 0.04], model=fs.NativeModel(law=LAW, solver=solver))
    status = data["status"].values.ravel()
    assert status[0] == SolveStatus.converged
    assert status[1] == SolveStatus.max_iterations
    assert status[2] == SolveStatus.not_run
    assert data["moment_xx"].isnull().values.ravel().tolist() == [False, True, True]
    assert data["outside_range"].values.ravel()[1:].tolist() == [-1, -1]


def test_without_contact_scales_pass_through_one_another() -> None:
    data = run([0.0], [0.0], model=MODEL.without_contact)
    assert "contact_pairs" not in data
    stiffening = data["energy_density"].values[0, 0, 1:] / np.square(CURVATURES[1:])
    assert np.ptp(stiffening) < 0.1 * stiffening.max()


@pytest.mark.parametrize(
    ("changes", "error", "words"),
    [
        ({"directions": [180.0]}, UnitRangeError, "180 degree"),
        ({"directions": [0.0, 0.0]}, UnitRangeError, "distinct"),
        ({"shapes": [60.0]}, UnitRangeError, r"60 degree is outside \[-135, 45\]"),
        ({"shapes": [0.0, 0.0]}, UnitRangeError, "shapes must be distinct"),
        ({"shapes": []}, UnitRangeError, "shapes"),
        ({"curvatures": [-0.001]}, UnitRangeError, "mm-1"),
        ({"curvatures": [0.0, 0.3]}, UnitRangeError, "4 mm high"),
        ({"in_plane": "fixed"}, UnknownNameError, "'fixed'"),
        ({"model": "shell"}, ConfigError, "Tensor sweeps are of scales on joints"),
    ],
)
def test_bad_tensor_sweeps_are_refused_before_any_solve(
    changes: dict[str, Any], error: type[Exception], words: str
) -> None:
    usual = {"directions": [0.0], "shapes": [0.0], "curvatures": [0.0, 0.01]}
    with pytest.raises(error, match=words):
        fs.tensor_sweep(HEXAGON, **(usual | changes))

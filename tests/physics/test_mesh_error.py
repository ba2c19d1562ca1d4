"""The estimate of the mesh error that datasets carry."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import flexscale as fs
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.errors_at_rest import estimate_mesh_error
from flexscale.homogenize.tangent import solve_tangent
from tests.physics.cells import hexagon, square
from tests.physics.test_scale_modes import MESH

NO_CONTACT = fs.ContactOptions(enabled=False)
ANGLES = np.arange(0.0, 180.0, 5.0)


#: Coarser, where the error is 15 %, and a mesh three times as fine is quick as well.
COARSEST = fs.MeshOptions(
    across=2, along=2.0, corner=0.5, scale_rim=0.45, scale_strips=1, scale_size=6.0,
    scale_corner=2.0, scale_growth=3.0, scale_layers=1,
)  # fmt: skip


@pytest.mark.parametrize(
    ("make", "mesh"),
    [
        pytest.param(square, COARSEST, id="square, coarsest"),
        pytest.param(square, MESH, marks=pytest.mark.slow, id="square"),
        pytest.param(hexagon, MESH, marks=pytest.mark.slow, id="hexagon"),
    ],
)
def test_estimate_is_of_the_size_of_the_error(make, mesh):
    """Against a mesh three times as fine: neither hidden nor overstated by much more than 2."""
    pattern = make()
    problem = CellProblem.from_pattern(
        pattern, fs.NativeModel("shell", contact=NO_CONTACT, mesh=mesh)
    )
    tangent = solve_tangent(problem)
    fine = CellProblem.from_pattern(
        pattern, fs.NativeModel("shell", contact=NO_CONTACT, mesh=mesh.finer(3.0))
    )
    limit = solve_tangent(fine).stiffness(ANGLES)
    error = float(np.abs(tangent.stiffness(ANGLES) / limit - 1.0).max())
    estimate = estimate_mesh_error(pattern, mesh, problem.model, tangent)
    assert 0.4 * error < estimate < 3.0 * error, (estimate, error)


def test_no_larger_elements_no_estimate():
    """The gap cannot be meshed with elements longer than its sides: nan, not a failure."""
    pattern = square()
    long = dataclasses.replace(MESH, scale_size=1e3, scale_corner=1e3, along=1e3)
    problem = CellProblem.from_pattern(
        pattern, fs.NativeModel("shell", contact=NO_CONTACT, mesh=MESH)
    )
    estimate = estimate_mesh_error(pattern, long, problem.model, solve_tangent(problem))
    assert np.isnan(estimate) or estimate > 0.0


def test_sweeps_carry_it():
    data = fs.sweep(
        square(),
        [0.0],
        [0.0, 0.001],
        ["closing"],
        workers=1,
        model=fs.NativeModel("shell", mesh=MESH),
    )
    assert 0.0 < data.attrs["mesh_error_at_rest"] < 0.2
    assert "twice as large" in data.attrs["mesh_error_comment"]

"""In-plane stiffness of the flat cell: closed forms, prescribed strain, symmetry."""

from __future__ import annotations

import numpy as np
import pytest

import flexscale as fs
from flexscale.embedding.bends import Bend
from flexscale.homogenize.cell_model import CellModel
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.tangent import solve_tangent
from flexscale.mesh.bare import build_bare_mesh
from tests.physics.cells import MESHES, RIGID, few_tets, hexagon_problem, square, square_problem

OBLIQUE = np.array([[3.0, 0.0], [1.0, 2.5]])
NU = fs.TPU.poisson_ratio
PLATE = fs.TPU.young_modulus * 0.4 / (1.0 - NU**2)  # N mm-1, of the paper's substrate
SHEAR = fs.TPU.shear_modulus * 0.4


def test_bare_sheet_is_in_plane_stress():
    problem = CellProblem(build_bare_mesh(OBLIQUE, 1.5), CellModel.of_pattern(square()))
    expected = PLATE * np.array([[1.0, NU, 0.0], [NU, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - NU)]])
    assert solve_tangent(problem).in_plane == pytest.approx(expected, abs=1e-7 * PLATE)


def test_rigid_squares_stretch_their_strips():
    """Gaps of width g between rigid scales of pitch P take all strain, P/g times the mean one.

    Along a side the strips, P − g long, are clamped: Y (P − g)/g; the crossings add Y at most. In
    shear both families of strips slide by E_xy P; where they cross, shear is twice that at most:
    G P/(2 g) (1 + g/P). 2 %: the mesh.
    """
    scales = square(scale_material=RIGID, bond_radius=0.0)
    model = fs.NativeModel("shell", mesh=few_tets(fs.MeshOptions()))
    found = fs.tangent_stiffness(scales, model=model).in_plane
    assert 24.0 * PLATE < found[0, 0] < 25.0 * PLATE * 1.02
    assert 0.5 * 24.0 * SHEAR < found[2, 2] < 0.5 * 26.0 * SHEAR * 1.02
    assert found[1, 1] == pytest.approx(found[0, 0], rel=1e-6)


@pytest.mark.parametrize("strain", [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.3, -0.7, 0.5)])
def test_is_the_least_energy_with_the_strain_prescribed(strain):
    """Energy of the cell itself, with S = `strain`: ½ E·A E where all else is relaxed, not less.

    The relaxed state is that under the in-plane force A E; S and E agree to first order.
    """
    problem = hexagon_problem()
    tangent = solve_tangent(problem)  # factorizes at rest
    voigt = np.array([strain[0], strain[1], 2.0 * strain[2]])
    load = np.zeros(len(problem.active))
    load[-3:] = problem.area * (tangent.in_plane @ voigt) * np.array([1.0, 1.0, 2.0])
    relaxed = problem.system.solve(load)[0]
    assert relaxed[-3:] == pytest.approx(np.array(strain), abs=1e-7)

    cell, size = problem.bent(Bend(0.0, 0.0)), 1e-5

    def energy(step: np.ndarray) -> float:
        """Second difference: what is odd in the strain drops out."""
        total = 0.0
        for sign in (size, -size):
            z = problem.embedding.rest.copy()
            z[problem.active] += sign * step
            total += cell.evaluate(z).energy
        return total / (2.0 * size**2 * problem.area)

    least = energy(relaxed)
    assert least == pytest.approx(0.5 * voigt @ tangent.in_plane @ voigt, rel=1e-4)
    rng = np.random.default_rng(3)
    other = relaxed + 0.02 * rng.standard_normal(len(relaxed)) * np.abs(relaxed).mean()
    other[-3:] = relaxed[-3:]
    assert energy(other) > least * (1.0 + 1e-4)


@pytest.mark.parametrize("mesh", MESHES)
def test_symmetry_of_the_cell_is_that_of_the_stiffness(mesh):
    """Squares alike along both sides and without coupling of shear; hexagons isotropic."""
    found = solve_tangent(square_problem(mesh)).in_plane
    assert found[0, 0] == pytest.approx(found[1, 1], rel=1e-9)
    assert np.abs(found[:2, 2]).max() < 1e-9 * found[0, 0]
    found = solve_tangent(hexagon_problem(mesh)).in_plane
    assert found[2, 2] == pytest.approx(0.5 * (found[0, 0] - found[0, 1]), rel=1e-6)


def test_scales_stiffen_the_sheet():
    """By at most the share of gaps, and at least as the bare sheet."""
    found = solve_tangent(square_problem()).in_plane
    assert np.linalg.eigvalsh(found).min() > SHEAR
    assert PLATE < found[0, 0] < 25.0 * PLATE

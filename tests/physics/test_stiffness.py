"""Bending stiffness before contact against closed forms and converged references."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import flexscale as fs
from flexscale.homogenize.cell_model import CellModel
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.tangent import TangentStiffness, solve_tangent
from flexscale.mesh.bare import build_bare_mesh
from tests.physics.cells import (
    FINE,
    MESHES,
    RIGID,
    D,
    few_tets,
    hexagon,
    hexagon_problem,
    square,
    square_problem,
)

OBLIQUE = np.array([[3.0, 0.0], [1.0, 2.5]])


def test_bare_sheet_is_an_isotropic_plate():
    """C = D [1, nu; nu, 1], twist D (1 - nu)/2: exact, since HCT holds quadratic fields."""
    problem = CellProblem(build_bare_mesh(OBLIQUE, 1.5), CellModel.of_pattern(square()))
    nu = fs.TPU.poisson_ratio
    expected = D * np.array([[1.0, nu, 0.0], [nu, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - nu)]])
    assert solve_tangent(problem).matrix == pytest.approx(expected, abs=1e-9 * D)


@cache
def rigid_tangent(make, mesh):
    """Of a pattern with rigid scales."""
    return fs.tangent_stiffness(
        make(scale_material=RIGID), model=fs.NativeModel("shell", mesh=mesh)
    )


@pytest.mark.parametrize("mesh", MESHES)
def test_squares_along_a_side_are_hinges(mesh):
    """a = D P / g: each gap of width g turns by kappa P. 2 %: the gap's ends are not a strip.

    PETG gives way a little under the edges of the strips.
    """
    rigid = rigid_tangent(square, mesh).stiffness(0.0)
    real = solve_tangent(square_problem(mesh)).stiffness(0.0)
    assert rigid == pytest.approx(24.8 * D, rel=0.02)
    assert real == pytest.approx(24.8 * D, rel=0.02)
    assert real < rigid


# Mesh-converged, bracketed by C1 elements from above and edge-angle elements from below.
REFERENCES = [(square, 45.0, 7.57e3), (hexagon, 20.0, 1.602e3)]

# The sheets of the default and of the fine mesh, under few tets, and as they are.
SHEETS = [
    pytest.param(few_tets, id="few tets"),
    pytest.param(lambda mesh: mesh, marks=pytest.mark.slow, id="whole mesh"),
]


@pytest.mark.parametrize(("pattern", "direction", "reference"), REFERENCES)
@pytest.mark.parametrize(("mesh", "tolerance"), [(fs.MeshOptions(), 0.03), (FINE, 0.01)])
@pytest.mark.parametrize("sheet", SHEETS)
def test_rigid_scales_meet_the_converged_stiffness(
    pattern, direction, reference, mesh, tolerance, sheet
):
    tangent = rigid_tangent(pattern, sheet(mesh))
    assert tangent.stiffness(direction) == pytest.approx(reference * D, rel=tolerance)


@pytest.mark.parametrize("sheet", SHEETS)
def test_conforming_elements_converge_from_above(sheet):
    """C1 trial spaces are too stiff, and less so on the finer mesh."""
    meshes = (fs.MeshOptions(), FINE)
    values = [rigid_tangent(square, sheet(mesh)).stiffness(45.0) for mesh in meshes]
    assert 7.57e3 * D < values[1] < values[0]


@pytest.mark.parametrize("mesh", MESHES)
def test_hexagons_are_isotropic_at_rest(mesh):
    """Six-fold symmetry makes a fourth-order tensor isotropic: to rounding on a symmetric mesh."""
    a = solve_tangent(hexagon_problem(mesh)).stiffness(np.arange(0.0, 180.0, 1.0))
    assert np.ptp(a) < 1e-6 * a.mean()


@pytest.mark.parametrize("mesh", MESHES)
def test_squares_have_the_square_symmetry_at_rest(mesh):
    tangent = solve_tangent(square_problem(mesh))
    directions = np.arange(0.0, 90.0, 5.0)
    assert tangent.stiffness(directions) == pytest.approx(
        tangent.stiffness(directions + 90.0), rel=1e-9
    )
    assert tangent.stiffness(directions) == pytest.approx(
        tangent.stiffness(90.0 - directions), rel=1e-9
    )
    assert (tangent.softest + 45.0) % 90.0 == pytest.approx(45.0, abs=0.1)
    assert tangent.stiffest % 90.0 == pytest.approx(45.0, abs=0.1)


QUICK = fs.MeshOptions(along=2.0, corner=0.6, scale_size=5.0, scale_corner=2.0, scale_layers=1)


@pytest.mark.parametrize("name", ["pinwheel3", "threefold"])
def test_three_fold_patterns_are_isotropic_at_rest(name):
    """Without any mirror; the mesh shares the symmetry, so to rounding on any mesh."""
    a = fs.tangent_stiffness(
        fs.named_pattern(name), model=fs.NativeModel("shell", mesh=QUICK)
    ).stiffness(np.arange(0.0, 180.0, 5))
    assert np.ptp(a) < 1e-6 * a.mean()


@pytest.mark.parametrize("name", ["pinwheel4", "pentagon"])
def test_four_fold_patterns_repeat_after_a_quarter_turn(name):
    tangent = fs.tangent_stiffness(
        fs.named_pattern(name), model=fs.NativeModel("shell", mesh=QUICK)
    )
    directions = np.arange(0.0, 90.0, 5.0)
    first, second = tangent.stiffness(directions), tangent.stiffness(directions + 90.0)
    assert second == pytest.approx(first, rel=1e-6)
    assert np.ptp(first) > 0.1 * first.mean()


def test_extremes_of_a_known_tensor():
    """a(theta) = 2 + cos 2(theta - 25 deg): softest at 115 degree, stiffest at 25 degree."""
    c, s = np.cos(np.radians(50.0)), np.sin(np.radians(50.0))
    matrix = np.array([[2.0 + c, 2.0, s / 2], [2.0, 2.0 - c, s / 2], [s / 2, s / 2, 0.0]])
    tangent = TangentStiffness(matrix, np.eye(3))
    theta = np.arange(0.0, 180.0, 7.0)
    expected = 2.0 + np.cos(np.radians(2.0 * (theta - 25.0)))
    assert tangent.stiffness(theta) == pytest.approx(expected, rel=1e-12)
    assert tangent.stiffest == pytest.approx(25.0, abs=1e-3)
    assert tangent.softest == pytest.approx(115.0, abs=1e-3)


def test_a_stiffness_that_is_the_same_in_all_directions_names_none() -> None:
    isotropic = 5.0 * np.array([[1.0, 0.3, 0.0], [0.3, 1.0, 0.0], [0.0, 0.0, 0.35]])
    told = str(TangentStiffness(isotropic, np.eye(3)))
    assert told == "tangent stiffness: 5 N mm, the same in all directions"
    isotropic[0, 0] *= 1.01
    assert "softest 5 N mm at 90.0 degree" in str(TangentStiffness(isotropic, np.eye(3)))

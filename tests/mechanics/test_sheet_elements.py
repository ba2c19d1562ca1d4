"""Elements of the macro sheet with a sheet law: derivatives, invariance, closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from flexscale.errors import UnitRangeError
from flexscale.mechanics.edge_angles import EdgeStencils
from flexscale.mechanics.linear_law import isotropic_sheet, linear_sheet, orthotropic_matrix
from flexscale.mechanics.sheet_shell import SheetShell
from flexscale.mechanics.sheet_triangles import SheetTriangles
from tests.mechanics.test_energies import CORNERS, edge_normals

LAW = linear_sheet(
    [[30.0, 9.0, 2.0], [9.0, 50.0, -3.0], [2.0, -3.0, 14.0]],
    [[0.8, 0.3, 0.05], [0.3, 0.4, 0.02], [0.05, 0.02, 0.2]],
)
#: A triangle and, across its edges, the corners of its neighbors.
POINTS = np.array([[0.0, 0.0], [1.0, 0.1], [0.2, 0.9], [0.5, -0.8], [1.1, 1.2], [-0.7, 0.6]])


def build_shell(curved: bool = False, direction: float = 0.3):
    """Two C1 triangles with separate rows, flat or curved at rest, and their rest state."""
    normals = edge_normals(CORNERS)
    rest = np.zeros((2, 12, 3))
    for t in range(2):
        for v in range(3):
            rest[t, 3 * v, :2] = CORNERS[t, v]
            rest[t, 3 * v + 1, 0] = rest[t, 3 * v + 2, 1] = 1.0
            rest[t, 9 + v, :2] = normals[t, v]
    rest = rest.reshape(24, 3)
    if curved:
        rest = rest + 0.1 * np.random.default_rng(9).normal(size=rest.shape)
    vectors = np.arange(24).reshape(2, 12)
    shell = SheetShell(CORNERS, normals, vectors, LAW, rest, material_direction=direction)
    return shell, rest


def build_triangle(direction: float = 0.3):
    """One linear triangle with a free edge, with edge angles, and its rest."""
    shares, signs = np.array([[0.5, 1.0, 0.0]]), np.array([[1.0, 0.0, 1.0]])
    stencils = EdgeStencils(POINTS[None, :3], np.arange(9)[None], shares, signs)
    rest = np.zeros((9, 3))
    rest[:6, :2] = POINTS
    return SheetTriangles(stencils, LAW, material_direction=direction), rest


@pytest.mark.parametrize("direction", [0.0, 0.7])
def test_states_are_strain_and_curvature_in_the_materials_axes(direction):
    """Affine stretch on linear and C1 triangles: e = F^T F - I, turned to the material's axes."""
    f = np.array([[1.2, 0.1], [-0.05, 0.85], [0.3, -0.2]])
    c, s = np.cos(direction), np.sin(direction)
    turn = np.array([[c, -s], [s, c]])
    strain = turn.T @ (f.T @ f) @ turn - np.eye(2)
    for energy, rest in (build_shell(False, direction), build_triangle(direction)):
        y = rest[:, :2] @ f.T
        y[6:] = 0.0 if len(rest) == 9 else y[6:]
        states = energy.states(y)
        expected = [strain[0, 0], strain[0, 1], strain[1, 1], 0.0, 0.0, 0.0]
        assert states == pytest.approx(np.broadcast_to(expected, states.shape), abs=1e-12)


def test_curved_rest_carries_its_own_metric():
    """A part of a sphere of radius R blown up to 2R: e = 3 I and b - b0 = 4/(2R) - 1/R, up to sign,
    in any parameters; the rest area is the sphere's."""
    radius, size = 5.0, 0.02
    corners = size * CORNERS + np.array([0.4, 0.9])
    normals = edge_normals(corners)
    rest = np.zeros((2, 12, 3))
    for t in range(2):
        for k in range(3):
            middle = 0.5 * (corners[t, k] + corners[t, (k + 1) % 3])
            rest[t, 3 * k : 3 * k + 3] = sphere(corners[t, k], radius)
            rest[t, 9 + k] = normals[t, k] @ sphere(middle, radius)[1:]
    rest = rest.reshape(24, 3)
    shell = SheetShell(corners, normals, np.arange(24).reshape(2, 12), LAW, rest)
    states = shell.states(2.0 * rest)
    expected = np.array([3.0, 0.0, 3.0, 1.0 / radius, 0.0, 1.0 / radius])
    assert np.abs(states) == pytest.approx(np.broadcast_to(expected, states.shape), abs=2e-3)
    parameter_area = 0.5 * np.linalg.det(corners[:, 1:] - corners[:, :1])
    latitude = np.sin(corners[:, :, 1].mean(axis=1))
    areas = radius**2 * latitude * parameter_area
    assert shell.weights.sum(axis=1) == pytest.approx(areas, rel=1e-4)


def sphere(point: np.ndarray, radius: float) -> np.ndarray:
    """Position and derivatives in longitude and colatitude: (3, 3)."""
    (c, s), (p, q) = (np.cos(point[0]), np.sin(point[0])), (np.cos(point[1]), np.sin(point[1]))
    return radius * np.array([[c * q, s * q, p], [-s * q, c * q, 0.0], [c * p, s * p, -q]])


@pytest.mark.parametrize("form", [(2.0, 0.0, 0.0), (0.0, 1.0, 0.0), (1.0, -0.5, 3.0)])
def test_isotropic_plate_energy_of_quadratic_heights(form):
    """D/2 [(1 - nu) tr S^2 + nu (tr S)^2] on the C1 element, to O(w^2)."""
    law, nu = isotropic_sheet(1000.0, 0.3, 0.2), 0.3
    plate = 1000.0 * 0.2**3 / 12.0 / (1.0 - nu**2)
    xx, xy, yy = 1e-5 * np.array(form)
    hessian = np.array([[xx, xy], [xy, yy]])
    flat, rest = build_shell()
    shell = SheetShell(CORNERS, edge_normals(CORNERS), flat.vectors, law, rest)
    y = rest.reshape(2, 12, 3).copy()
    for t in range(2):
        for k in range(3):
            point, other = CORNERS[t, k], CORNERS[t, (k + 1) % 3]
            y[t, 3 * k, 2] = 0.5 * point @ hessian @ point
            y[t, 3 * k + 1 : 3 * k + 3, 2] = hessian @ point
            y[t, 9 + k, 2] = edge_normals(CORNERS)[t, k] @ hessian @ (0.5 * (point + other))
    bent = 0.5 * plate * ((1 - nu) * np.sum(hessian**2) + nu * np.trace(hessian) ** 2)
    area = shell.weights.sum()
    assert shell.energy_parts(y.reshape(24, 3))[0] == pytest.approx(bent * area, rel=1e-5)


def test_orthotropic_axes():
    """A uniaxial curvature along each axis finds its own stiffness."""
    law = linear_sheet(orthotropic_matrix(3.0, 5.0, 1.0, 2.0), orthotropic_matrix(7.0, 2.0, 0.5, 1))
    states = np.zeros((3, 6))
    states[0, 3], states[1, 5], states[2, 4] = 1.0, 1.0, 1.0
    assert law.energies(states) == pytest.approx([3.5, 1.0, 2.0])
    states = np.zeros((2, 6))
    states[0, 0], states[1, 1] = 0.2, 0.1
    assert law.energies(states) == pytest.approx([0.5 * 3.0 * 0.01, 0.5 * 2.0 * 0.01])


def test_bad_stiffness_is_refused():
    with pytest.raises(UnitRangeError, match=r"bending stiffness must be .* N mm"):
        linear_sheet(np.eye(3), -np.eye(3))
    with pytest.raises(UnitRangeError, match="membrane"):
        linear_sheet([[1.0, 2.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], np.eye(3))

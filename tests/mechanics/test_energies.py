"""Energies on loose meshes: derivatives, frame invariance, laws against other computations."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from flexscale.mechanics.energy import project_blocks
from flexscale.mechanics.hct import QUADRATURE_POINTS, hct_derivatives, hct_ordinates
from flexscale.mechanics.layered_law import layered_energy, layered_law
from flexscale.mechanics.neo_hookean import NeoHookeanTets
from flexscale.mechanics.shell import HctShell
from flexscale.mechanics.shell_law import (
    bending_energy,
    membrane_energy,
    shell_law,
)
from flexscale.simplices import TET_EDGES
from tests.derivatives import directional_difference, relative_error

MU, LAMBDA, NU = 8.78, 210.8, 0.48
CORNERS = np.array([[[0.0, 0.0], [1.0, 0.1], [0.2, 0.9]], [[1.0, 0.1], [1.3, 1.2], [0.2, 0.9]]])


def edge_normals(corners: np.ndarray) -> np.ndarray:
    """Normals in a direction that both triangles of an edge agree on."""
    span = np.roll(corners, -1, axis=1) - corners
    span *= np.where(span[..., :1] + 1e-3 * span[..., 1:] > 0.0, 1.0, -1.0)
    span /= np.linalg.norm(span, axis=-1, keepdims=True)
    return np.stack([-span[..., 1], span[..., 0]], axis=-1)


def build_shell(bending_measure: str = "layers") -> tuple[HctShell, np.ndarray]:
    """Two triangles with separate unknowns, and their flat rest state (24, 3)."""
    normals = edge_normals(CORNERS)
    rest = np.zeros((2, 12, 3))
    for t in range(2):
        for v in range(3):
            rest[t, 3 * v, :2] = CORNERS[t, v]
            rest[t, 3 * v + 1, 0] = rest[t, 3 * v + 2, 1] = 1.0
            rest[t, 9 + v, :2] = normals[t, v]
    shell = HctShell(
        CORNERS,
        normals,
        np.arange(24).reshape(2, 12),
        shear_modulus=MU,
        lame_lambda=LAMBDA,
        poisson_ratio=NU,
        thickness=0.4,
        bending_stiffness=0.18,
        bending_measure=bending_measure,
    )
    return shell, rest.reshape(24, 3)


def build_tets() -> tuple[NeoHookeanTets, np.ndarray]:
    """Three tets on six points."""
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1.1], [0.2, 1.2, 1.3]])
    tets = np.array([[0, 1, 2, 3], [1, 4, 2, 3], [2, 4, 5, 3]])
    return NeoHookeanTets(points, tets, tets, 748.0, 1745.0), points


def build_quadratic_tet() -> tuple[NeoHookeanTets, np.ndarray]:
    """One tet with nodes in the middle of its edges."""
    corners = np.array([[0.0, 0.1, 0.0], [1.0, 0.0, 0.2], [0.1, 1.2, 0.0], [0.3, 0.2, 0.9]])
    points = np.concatenate([corners, corners[np.array(TET_EDGES)].mean(axis=1)])
    tets = np.arange(10)[None]
    return NeoHookeanTets(points, tets, tets, 748.0, 1745.0), points


def test_inverted_elements_have_infinite_energy():
    tets, points = build_tets()
    points[3, 2] = -1.0
    assert np.isinf(tets.energy_parts(points)).all()


def test_quadratic_tets_bend_without_locking():
    """A field of constant curvature in their space: energy of the exact strain, point by point."""
    tets, points = build_quadratic_tet()
    kappa = 1e-4
    x, _, z = points.T
    bent = points + 0.5 * kappa * np.stack([-2.0 * x * z, np.zeros_like(x), x * x], axis=1)
    # Strain xx = -kappa z, all else zero, so Psi = (mu + lambda/2) (kappa z)^2; z^2 over the tet.
    heights = points[:4, 2]
    volume = np.linalg.det(points[1:4] - points[0]) / 6.0
    mean_square = (np.sum(heights**2) + heights.sum() ** 2) / 20.0
    expected = (748.0 + 0.5 * 1745.0) * kappa**2 * mean_square * volume
    assert tets.energy_parts(bent)[0] == pytest.approx(expected, rel=1e-3)


def test_projected_blocks_are_the_positive_part():
    """Projection keeps a positive element Hessian, and clips a compressed one."""
    tets, points = build_tets()
    blocks = tets.hessian_blocks(points)
    assert relative_error(project_blocks(blocks, 4), blocks) < 1e-10
    crushed = tets.hessian_blocks(points * [1.0, 1.0, 0.5])
    clipped = project_blocks(crushed, 4)
    assert relative_error(clipped, crushed) > 1e-3
    assert relative_error(project_blocks(clipped, 4), clipped) < 1e-10


def test_hct_reproduces_cubics():
    """A cubic has its own first and second derivatives at every quadrature point."""
    generator = np.random.default_rng(0)
    exponents = [(i, j) for i in range(4) for j in range(4 - i)]
    coefficients = generator.normal(size=len(exponents))

    def derivative(point, du, dv):
        total = 0.0
        for c, (i, j) in zip(coefficients, exponents, strict=True):
            if i >= du and j >= dv:
                falling = np.prod(range(i - du + 1, i + 1)) * np.prod(range(j - dv + 1, j + 1))
                total += c * falling * point[0] ** (i - du) * point[1] ** (j - dv)
        return total

    normals = edge_normals(CORNERS)
    maps, weights = hct_derivatives(CORNERS, normals)
    for t in range(2):
        dofs = [derivative(p, *d) for p in CORNERS[t] for d in ((0, 0), (1, 0), (0, 1))]
        for k in range(3):
            middle = 0.5 * (CORNERS[t, k] + CORNERS[t, (k + 1) % 3])
            dofs.append(normals[t, k] @ [derivative(middle, 1, 0), derivative(middle, 0, 1)])
        values = maps[t] @ np.array(dofs)
        centroid = CORNERS[t].mean(axis=0)
        for k in range(3):
            triangle = np.array([CORNERS[t, k], CORNERS[t, (k + 1) % 3], centroid])
            for q, point in enumerate(QUADRATURE_POINTS @ triangle):
                expected = [derivative(point, *d) for d in ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2))]
                assert values[6 * k + q] == pytest.approx(expected, abs=1e-11)
    areas = 0.5 * np.linalg.det(CORNERS[:, 1:] - CORNERS[:, :1])
    assert weights.sum(axis=1) == pytest.approx(areas, rel=1e-12)


def test_hct_is_continuously_differentiable_across_an_edge():
    """Two triangles that share their edge's five dofs agree there in value and normal slope."""
    ordinates = hct_ordinates(CORNERS, edge_normals(CORNERS))
    generator = np.random.default_rng(2)
    shared = {1: 0, 2: 2}  # vertices 1, 2 of the first triangle are 0, 2 of the second
    dofs = generator.normal(size=(2, 12))
    for ours, theirs in shared.items():
        dofs[1, 3 * theirs : 3 * theirs + 3] = dofs[0, 3 * ours : 3 * ours + 3]
    dofs[1, 11] = dofs[0, 10]

    def slope(triangle: int, edge: int, share: float) -> np.ndarray:
        """Gradient of the cubic on an edge's sub-triangle, at (1 - share, share, 0)."""
        c = ordinates[triangle, edge] @ dofs[triangle]
        start, end = CORNERS[triangle, edge], CORNERS[triangle, (edge + 1) % 3]
        frame = np.array([end - start, CORNERS[triangle].mean(axis=0) - start])
        s, r = 1.0 - share, share

        def value(a, b, k):
            return s * s * c[a + 2, b, k] + 2 * s * r * c[a + 1, b + 1, k] + r * r * c[a, b + 2, k]

        steps = [3 * (value(0, 1, 0) - value(1, 0, 0)), 3 * (value(0, 0, 1) - value(1, 0, 0))]
        return np.linalg.solve(frame, steps)

    for share in (0.0, 0.2, 0.5, 0.9):
        assert slope(0, 1, share) == pytest.approx(slope(1, 2, 1.0 - share), abs=1e-12)


def test_membrane_is_the_minimum_over_the_thickness_stretch():
    """Plane stress by brute force: the three-dimensional law minimized over lambda_3."""
    f = np.array([[1.2, 0.1], [-0.05, 0.85]])
    a = f.T @ f

    def solid(stretch: float) -> float:
        log_j = np.log(np.sqrt(np.linalg.det(a)) * stretch)
        trace = np.trace(a) + stretch**2
        return MU / 2 * (trace - 3 - 2 * log_j) + LAMBDA / 2 * log_j**2

    brute = minimize_scalar(solid, bounds=(0.5, 2.0), method="bounded", options={"xatol": 1e-10})
    found = membrane_energy(a[0, 0] - 1, a[0, 1], a[1, 1] - 1, MU, LAMBDA)
    assert found == pytest.approx(brute.fun, rel=1e-10)


def test_bending_measure():
    """D/2 [(1 - nu) tr S^2 + nu (tr S)^2] with S = U^-1 b, U = sqrt(a)."""
    a = np.array([[1.3, 0.2], [0.2, 0.8]])
    b = np.array([[0.5, -0.1], [-0.1, 0.2]])
    values, modes = np.linalg.eigh(a)
    s = modes @ np.diag(values**-0.5) @ modes.T @ b
    expected = 0.5 * ((1 - NU) * np.trace(s @ s) + NU * np.trace(s) ** 2)
    parts = (np.array([1.3, 0.2, 0.8]), np.array([0.5, -0.1, 0.2]))
    area = np.sqrt(np.linalg.det(a))
    found = bending_energy(*parts, area, NU)
    assert found == pytest.approx(expected, rel=1e-13)


def test_shell_law_derivatives():
    """All 6 + 36 derivatives of the law in (a, b) against differences."""
    e = np.array([0.2, -0.07, -0.15])
    b = np.array([0.5, -0.3, 0.4])
    thickness, stiffness = 0.4, 0.18

    def energy(s: np.ndarray) -> float:
        a = np.array([1.0 + s[0], s[1], 1.0 + s[2]])
        area = np.sqrt(a[0] * a[2] - a[1] ** 2)
        membrane = thickness * membrane_energy(*s[:3], MU, LAMBDA)
        return membrane + stiffness * bending_energy(a, s[3:], area, NU)

    def gradient(s: np.ndarray) -> np.ndarray:
        out = np.empty(6)
        law = (MU, LAMBDA, thickness, stiffness, NU)
        shell_law(s[:3], s[3:], *law, out, np.empty((0, 0)))
        return out

    state, hessian = np.concatenate([e, b]), np.empty((6, 6))
    shell_law(e, b, MU, LAMBDA, thickness, stiffness, NU, np.empty(6), hessian)
    for k, axis in enumerate(np.eye(6)):
        slope = directional_difference(lambda h, d=axis: energy(state + h * d), 1e-3)
        assert gradient(state)[k] == pytest.approx(slope, rel=1e-7)
        column = directional_difference(lambda h, d=axis: gradient(state + h * d), 1e-3)
        assert hessian[:, k] == pytest.approx(column, rel=1e-6, abs=1e-8)


THICKNESS = 0.4
LAYERED_STATE = np.array([0.2, -0.07, -0.15, 0.5, -0.3, 0.4])


def layer(state: np.ndarray, z: float) -> float:
    """Plane-stress energy at the height z: A = a - 2 z b + z^2 b a^-1 b, from matrices."""
    a = np.array([[1.0 + state[0], state[1]], [state[1], 1.0 + state[2]]])
    b = np.array([[state[3], state[4]], [state[4], state[5]]])
    form = a - 2.0 * z * b + z * z * b @ np.linalg.solve(a, b)
    return membrane_energy(form[0, 0] - 1.0, form[0, 1], form[1, 1] - 1.0, MU, LAMBDA)


def test_layers_add_up():
    """Simpson's rule over the thickness, and how far it is from the whole integral.

    This state is bent to a radius of four thicknesses and stretched by a tenth: 0.5 %.
    """
    faces = layer(LAYERED_STATE, 0.5 * THICKNESS) + layer(LAYERED_STATE, -0.5 * THICKNESS)
    simpson = THICKNESS / 6.0 * (faces + 4.0 * layer(LAYERED_STATE, 0.0))
    stretching, bending = layered_energy(
        LAYERED_STATE[:3], LAYERED_STATE[3:], MU, LAMBDA, THICKNESS
    )
    assert stretching == pytest.approx(THICKNESS * layer(LAYERED_STATE, 0.0), rel=1e-13)
    assert stretching + bending == pytest.approx(simpson, rel=1e-13)
    points, weights = np.polynomial.legendre.leggauss(12)
    values = [layer(LAYERED_STATE, 0.5 * THICKNESS * point) for point in points]
    assert simpson == pytest.approx(0.5 * THICKNESS * weights @ values, rel=5e-3)


def test_layers_bend_as_a_plate():
    """Of small curvature of the unstretched sheet: D/2 [(tr b)^2 - 2 (1 - nu) det b]."""
    b = np.array([0.8e-4, -0.3e-4, 0.5e-4])
    young = MU * (3.0 * LAMBDA + 2.0 * MU) / (LAMBDA + MU)
    stiffness = young * THICKNESS**3 / (12.0 * (1.0 - NU**2))
    expected = stiffness * bending_energy(np.array([1.0, 0.0, 1.0]), b, 1.0, NU)
    found = layered_energy(np.zeros(3), b, MU, LAMBDA, THICKNESS)
    assert found[0] == pytest.approx(0.0, abs=1e-20)
    assert found[1] == pytest.approx(expected, rel=1e-6)


def test_layered_law_derivatives():
    """All 6 + 36 derivatives in (a, b) against differences."""

    def gradient(s: np.ndarray) -> np.ndarray:
        out = np.empty(6)
        layered_law(s[:3], s[3:], MU, LAMBDA, THICKNESS, out, np.empty((0, 0)), np.empty((3, 6)))
        return out

    def energy(s: np.ndarray) -> float:
        return sum(layered_energy(s[:3], s[3:], MU, LAMBDA, THICKNESS))

    hessian, s = np.empty((6, 6)), LAYERED_STATE
    arguments = (s[:3], s[3:], MU, LAMBDA, THICKNESS, np.empty(6), hessian, np.empty((3, 6)))
    layered_law(*arguments)
    for k, axis in enumerate(np.eye(6)):
        slope = directional_difference(lambda h, d=axis: energy(s + h * d), 1e-3)
        assert gradient(s)[k] == pytest.approx(slope, rel=1e-8)
        column = directional_difference(lambda h, d=axis: gradient(s + h * d), 1e-3)
        assert hessian[:, k] == pytest.approx(column, rel=1e-8, abs=1e-8)


@pytest.mark.parametrize("b", [(5.01, 0.0, 0.0), (0.0, 0.0, -5.01), (7.0, 0.0, 8.0)])
def test_faces_cannot_be_turned_over(b):
    """A sheet of 0.4 mm cannot be bent to a radius below 0.2 mm."""
    assert sum(layered_energy(np.zeros(3), np.array(b), MU, LAMBDA, THICKNESS)) == np.inf

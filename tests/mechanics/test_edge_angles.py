"""The paper's substrate elements on loose triangles: derivatives, invariance, closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from flexscale.mechanics.constant_strain import ConstantStrainTriangles
from flexscale.mechanics.dihedral import edge_frame
from flexscale.mechanics.edge_angles import EdgeAngleBending, EdgeStencils
from flexscale.mechanics.shell_law import membrane_energy

MU, LAMBDA, NU, D = 8.78, 210.8, 0.48, 0.18
#: A triangle and, across its edges, the corners of its neighbors.
POINTS = np.array([[0.0, 0.0], [1.0, 0.1], [0.2, 0.9], [0.5, -0.8], [1.1, 1.2], [-0.7, 0.6]])


def build_bending(shares=(0.5, 0.5, 1.0), signs=(1.0, -1.0, 0.0)):
    """One triangle with edge angles, and its flat rest state (9, 3)."""
    stencils = EdgeStencils(
        POINTS[None, :3], np.arange(9)[None], np.array([shares]), np.array([signs])
    )
    rest = np.zeros((9, 3))
    rest[:6, :2] = POINTS
    return EdgeAngleBending(stencils, bending_stiffness=D, poisson_ratio=NU), rest


def build_membrane():
    """Two triangles, and their flat rest state in rows (9, 3)."""
    triangles = np.array([[0, 1, 2], [1, 4, 2]])
    membrane = ConstantStrainTriangles(
        POINTS[triangles], triangles, shear_modulus=MU, lame_lambda=LAMBDA, thickness=0.4
    )
    return membrane, build_bending()[1]


@pytest.mark.parametrize("degrees", [-170.0, -60.0, 1e-6, 35.0, 120.0, 179.0])
def test_dihedral_angle_of_a_fold(degrees):
    """The right triangle of an edge along x, turned up about it; both feet off the ends."""
    angle = np.radians(degrees)
    p, q = np.zeros(3), np.array([2.0, 0.0, 0.0])
    a, b = np.array([0.3, 1.5, 0.0]), np.array([2.5, -0.7 * np.cos(angle), 0.7 * np.sin(angle)])
    frame, sizes = np.empty((5, 3)), np.empty(5)
    assert edge_frame(p, q, a, b, frame, sizes) == pytest.approx(angle, rel=1e-9)
    assert sizes == pytest.approx([2.0, 1.5, 0.15, 0.7, 1.25])


@pytest.mark.parametrize("form", [(2.0, 0.0, 0.0), (0.0, 1.0, 0.0), (1.0, -0.5, 3.0)])
def test_quadratic_heights_have_their_own_curvature(form):
    """Slopes of w at mid-edges give S = Hessian of w, so the plate's energy, to O(w^2)."""
    bending, rest = build_bending((0.5, 0.5, 0.5), (1.0, 1.0, 1.0))
    size = 1e-4
    xx, xy, yy = size * np.array(form)
    hessian = np.array([[xx, xy], [xy, yy]])
    y = rest.copy()
    y[:6, 2] = 0.5 * np.einsum("ni,ij,nj->n", POINTS, hessian, POINTS)
    frame, sizes = np.empty((5, 3)), np.empty(5)
    corners = POINTS[:3]
    plane = np.linalg.solve(corners[1:] - corners[0], y[1:3, 2] - y[0, 2])
    for i in range(3):
        p, q = corners[i], corners[(i + 1) % 3]
        outward = np.array([(q - p)[1], (p - q)[0]]) / np.linalg.norm(q - p)
        slope = outward @ (hessian @ (0.5 * (p + q)) - plane)
        theta = edge_frame(y[i], y[(i + 1) % 3], y[(i + 2) % 3], y[3 + i], frame, sizes)
        y[6 + i, 0] = slope - 0.5 * theta
    area = 0.5 * np.linalg.det(corners[1:] - corners[0])
    s2 = (1 - NU) * np.trace(hessian @ hessian) + NU * np.trace(hessian) ** 2
    assert bending.energy_parts(y)[0] == pytest.approx(0.5 * D * area * s2, rel=1e-6)


def test_a_turn_of_pi_costs_infinite_energy():
    """2 tan(phi/2): an edge normal never passes through the sheet to its other side."""
    bending, rest = build_bending()
    near, far = rest.copy(), rest.copy()
    near[6, 0], far[6, 0] = np.pi - 1e-3, np.pi + 1e-3
    assert bending.energy_parts(near)[0] > 1e5
    assert np.isinf(bending.energy_parts(far)[0])


def test_flattened_triangles_have_infinite_energy():
    bending, rest = build_bending()
    membrane, _ = build_membrane()
    rest[2] = rest[0]
    assert np.isinf(bending.energy_parts(rest)[0])
    assert np.isinf(membrane.energy_parts(rest)[0])


def test_membrane_has_the_energy_of_its_strain():
    """A uniform deformation: area times thickness times the plane-stress law."""
    membrane, _ = build_membrane()
    f = np.array([[1.2, 0.1], [-0.05, 0.85], [0.3, -0.2]])
    y = np.zeros((9, 3))
    y[:6] = POINTS @ f.T
    a = f.T @ f
    corners = POINTS[np.array([[0, 1, 2], [1, 4, 2]])]
    area = 0.5 * np.linalg.det(corners[:, 1:] - corners[:, :1]).sum()
    expected = 0.4 * area * membrane_energy(a[0, 0] - 1, a[0, 1], a[1, 1] - 1, MU, LAMBDA)
    assert membrane.energy_parts(y)[0] == pytest.approx(expected, rel=1e-12)

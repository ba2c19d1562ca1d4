"""Hsieh-Clough-Tocher triangles: cubic on three sub-triangles, C1 across every edge.

A scalar field has twelve degrees of freedom on a triangle: value and both first derivatives at the
vertices, and one normal derivative at each mid-edge. `hct_derivatives` turns them into first and
second derivatives at quadrature points, through the Bernstein-Bezier ordinates of the three
sub-triangles (vertex i, vertex i+1, centroid). Local order: (f, f_u, f_v) at vertices 0, 1, 2, then
f_n at the edges 0-1, 1-2, 2-0.

Reference: R. W. Clough and J. L. Tocher (1965); ordinates as in M.-J. Lai and L. L. Schumaker,
"Spline Functions on Triangulations" (2007), section 6.1.
"""

from __future__ import annotations

import numpy as np

from flexscale.arrays import FloatArray

# Degree-4 rule with six points on a triangle (D. A. Dunavant 1985), barycentric.
_A1, _W1 = 0.445948490915965, 0.223381589678011
_A2, _W2 = 0.091576213509771, 0.109951743655322
QUADRATURE_POINTS = np.array(
    [
        [1 - 2 * _A1, _A1, _A1],
        [_A1, 1 - 2 * _A1, _A1],
        [_A1, _A1, 1 - 2 * _A1],
        [1 - 2 * _A2, _A2, _A2],
        [_A2, 1 - 2 * _A2, _A2],
        [_A2, _A2, 1 - 2 * _A2],
    ]
)
QUADRATURE_WEIGHTS = np.array([_W1, _W1, _W1, _W2, _W2, _W2])

N_DOFS = 12


def hct_ordinates(corners: FloatArray, edge_normals: FloatArray) -> FloatArray:
    """Bernstein-Bezier ordinates of the three cubics, as linear maps of the twelve dofs.

    Parameters
    ----------
    corners : (n, 3, 2) vertex coordinates, mm.
    edge_normals : (n, 3, 2) unit normals along which the mid-edge derivative is taken.

    Returns
    -------
    (n, 3, 4, 4, 4, 12): entry [e, k, a, b, c] (a + b + c = 3) is the ordinate c_abc of sub-triangle
    k with vertices (k, k + 1, centroid).
    """
    n = len(corners)
    centroid = corners.mean(axis=1)
    c = np.zeros((n, 3, 4, 4, 4, N_DOFS))
    for k in range(3):
        i, j = k, (k + 1) % 3
        for vertex, other, full, near in (
            (i, j, (3, 0, 0), (2, 1, 0)),
            (j, i, (0, 3, 0), (1, 2, 0)),
        ):
            inward = (2, 0, 1) if vertex == i else (0, 2, 1)
            for index, target in ((full, None), (near, corners[:, other]), (inward, centroid)):
                c[(slice(None), k, *index, 3 * vertex)] = 1.0
                if target is not None:
                    step = (target - corners[:, vertex]) / 3.0
                    c[(slice(None), k, *index, 3 * vertex + 1)] = step[:, 0]
                    c[(slice(None), k, *index, 3 * vertex + 2)] = step[:, 1]
        d = _barycentric_direction(corners[:, i], corners[:, j], centroid, edge_normals[:, k])[
            ..., None
        ]
        # Derivative along the normal at the edge's middle, all ordinates but c_111 known.
        along = d[:, 0] * (
            0.25 * c[:, k, 3, 0, 0] + 0.5 * c[:, k, 2, 1, 0] + 0.25 * c[:, k, 1, 2, 0]
        )
        along += d[:, 1] * (
            0.25 * c[:, k, 2, 1, 0] + 0.5 * c[:, k, 1, 2, 0] + 0.25 * c[:, k, 0, 3, 0]
        )
        along += d[:, 2] * 0.25 * (c[:, k, 2, 0, 1] + c[:, k, 0, 2, 1])
        normal_dof = np.zeros((n, N_DOFS))
        normal_dof[:, 9 + k] = 1.0 / 3.0
        c[:, k, 1, 1, 1] = (normal_dof - along) * 2.0 / d[:, 2]
    # C1 across the inner edges: each ordinate one step from the centroid is the mean of three.
    for i in range(3):
        before, after = (i + 2) % 3, i
        mean = (c[:, after, 2, 0, 1] + c[:, after, 1, 1, 1] + c[:, before, 1, 1, 1]) / 3.0
        c[:, after, 1, 0, 2] = mean
        c[:, before, 0, 1, 2] = mean
    center = (c[:, 0, 1, 0, 2] + c[:, 1, 1, 0, 2] + c[:, 2, 1, 0, 2]) / 3.0
    c[:, :, 0, 0, 3] = center[:, None]
    return c


def _barycentric_direction(p0, p1, p2, direction):
    """(n, 3) rates of the barycentric coordinates of triangle (p0, p1, p2) along `direction`."""
    e1, e2 = p1 - p0, p2 - p0
    det = e1[:, 0] * e2[:, 1] - e1[:, 1] * e2[:, 0]
    d1 = (direction[:, 0] * e2[:, 1] - direction[:, 1] * e2[:, 0]) / det
    d2 = (e1[:, 0] * direction[:, 1] - e1[:, 1] * direction[:, 0]) / det
    return np.stack([-d1 - d2, d1, d2], axis=1)


_QUADRATIC = [(2, 0, 0), (1, 1, 0), (1, 0, 1), (0, 2, 0), (0, 1, 1), (0, 0, 2)]


def hct_derivatives(corners: FloatArray, edge_normals: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Derivatives at six quadrature points in each of the three sub-triangles.

    Parameters
    ----------
    corners, edge_normals : as in `hct_ordinates`.

    Returns
    -------
    derivatives : (n, 18, 5, 12) maps of the dofs to (f_u, f_v, f_uu, f_uv, f_vv).
    weights : (n, 18) mm2, summing to the triangle's area.
    """
    n = len(corners)
    ordinates = hct_ordinates(corners, edge_normals)
    centroid = corners.mean(axis=1)
    derivatives = np.empty((n, 3, len(QUADRATURE_POINTS), 5, N_DOFS))
    weights = np.empty((n, 3, len(QUADRATURE_POINTS)))
    axes = np.eye(2)
    for k in range(3):
        p0, p1 = corners[:, k], corners[:, (k + 1) % 3]
        rates = np.stack(
            [_barycentric_direction(p0, p1, centroid, np.broadcast_to(a, p0.shape)) for a in axes],
            axis=2,
        )
        e1, e2 = p1 - p0, centroid - p0
        area = 0.5 * (e1[:, 0] * e2[:, 1] - e1[:, 1] * e2[:, 0])
        weights[:, k] = area[:, None] * QUADRATURE_WEIGHTS
        for q, point in enumerate(QUADRATURE_POINTS):
            first = np.stack(
                [_quadratic_value(ordinates[:, k], m, point) for m in range(3)], axis=1
            )
            derivatives[:, k, q, :2] = 3.0 * np.einsum("nmu,nmd->nud", rates, first)
            second = _linear_values(ordinates[:, k], point)
            hessian = 6.0 * np.einsum("nlu,nmv,nlmd->nuvd", rates, rates, second)
            derivatives[:, k, q, 2] = hessian[:, 0, 0]
            derivatives[:, k, q, 3] = hessian[:, 0, 1]
            derivatives[:, k, q, 4] = hessian[:, 1, 1]
    return derivatives.reshape(n, -1, 5, N_DOFS), weights.reshape(n, -1)


def _raised(index, *steps):
    out = list(index)
    for s in steps:
        out[s] += 1
    return tuple(out)


def _quadratic_value(c, step, point):
    """Quadratic with ordinates c_{abc + e_step} at a barycentric point: (n, 12)."""
    total = 0.0
    for index in _QUADRATIC:
        multiplicity = 2.0 if max(index) == 1 else 1.0
        basis = multiplicity * np.prod(np.power(point, index))
        total = total + basis * c[(slice(None), *_raised(index, step))]
    return total


def _linear_values(c, point):
    """Linear polynomials with ordinates c_{abc + e_l + e_m} at a point: (n, 3, 3, 12)."""
    out = np.zeros((len(c), 3, 3, N_DOFS))
    for direction in range(3):
        unit = tuple(int(direction == m) for m in range(3))
        for first in range(3):
            for second in range(3):
                out[:, first, second] += (
                    point[direction] * c[(slice(None), *_raised(unit, first, second))]
                )
    return out

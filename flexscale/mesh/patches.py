"""Quadrature over the part of a triangulated surface that lies within a radius of a point, and the
affine motion that fits a surface best there.

A surface moves by u(q), piecewise linear or quadratic. The affine motion X0 + G (q - p) that fits
it best near p, in least squares with weight (1 - r^2/b^2)^2, r = |q - p|, is what a body that grips
or presses on the surface over a radius b feels of it. The weights of nodal values in X0 and G
reproduce every affine motion, so a force on X0 hands the surface the same force and torque.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flexscale.simplices import TRIANGLE_EDGES

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

FINEST = 0.25  # of the radius: triangles are cut down to this size before they are integrated
ROUNDING = 1e-6  # mirror images must be cut alike although their lengths differ in the last bits
FLAT = 1e-9  # of the largest second moment: directions thinner than this are not fitted

# Six points, exact to degree 4, alike under every exchange of corners (Dunavant 1985).
_A, _B = 0.445948490915965, 0.091576213509771
_RULE = np.array(
    [[a if i != k else 1.0 - 2.0 * a for i in range(3)] for a in (_A, _B) for k in range(3)]
)
_RULE_WEIGHTS = np.repeat([0.223381589678011, 0.109951743655322], 3)
# Corners of the four quarters of a triangle, in its own barycentric coordinates.
_QUARTERS = 0.5 * np.array(
    [
        [[2, 0, 0], [1, 1, 0], [1, 0, 1]],
        [[1, 1, 0], [0, 2, 0], [0, 1, 1]],
        [[1, 0, 1], [0, 1, 1], [0, 0, 2]],
        [[1, 1, 0], [0, 1, 1], [1, 0, 1]],
    ]
)


def fit_affine(
    corners: FloatArray, point: FloatArray, radius: float, quadratic: bool
) -> tuple[IntArray, FloatArray]:
    """Weights of nodal values in the affine motion that fits a surface best near a point.

    Parameters
    ----------
    corners : (n, 3, d) rest corners of triangles, in the plane (d = 2) or in space (3), mm.
    point : (d,) mm. radius : mm, > 0.
    quadratic : whether the triangles carry six nodes, or three.

    Returns
    -------
    near : (m,) triangles within the radius.
    forms : (m, 3 or 6, 1 + d) weights of their nodes in X0 and G. Of a flat patch in space the
        part of G across it is 0.
    """
    arms = (corners - point) / radius
    owner, shares, areas = _cut_near_origin(arms)
    places = np.einsum("nk,nkd->nd", shares, arms[owner])
    weights = areas * np.maximum(1.0 - np.sum(places**2, axis=1), 0.0) ** 2
    modes = np.column_stack([np.ones(len(places)), places])
    weighted = weights[:, None] * modes
    moments = modes.T @ weighted
    fit = np.linalg.pinv(moments, rcond=FLAT, hermitian=True) @ weighted.T  # (X0, radius G)
    fit[1:] /= radius
    values = quadratic_values(shares) if quadratic else shares
    near, slot = np.unique(owner, return_inverse=True)
    forms = np.zeros((len(near), values.shape[1], len(fit)))
    np.add.at(forms, slot, values[:, :, None] * fit.T[:, None, :])
    return near, forms


def quadratic_values(shares: FloatArray) -> FloatArray:
    """Quadratic shape functions (n, 6) at barycentric coordinates (n, 3)."""
    start, end = np.transpose(TRIANGLE_EDGES)
    return np.concatenate(
        [shares * (2.0 * shares - 1.0), 4.0 * shares[:, start] * shares[:, end]], axis=1
    )


def _cut_near_origin(corners: FloatArray) -> tuple[IntArray, FloatArray, FloatArray]:
    """Quadrature points of triangles (n, 3, d) over the unit ball, fine on its scale.

    Returns
    -------
    owner (m,) triangle of each point, shares (m, 3) its barycentric coordinates there, and areas
    (m,). Triangles clear of the ball have no points.
    """
    owner = np.arange(len(corners))
    pieces = np.tile(np.eye(3), (len(corners), 1, 1))  # corners in their owner's coordinates
    owners, shares, areas = [], [], []
    while len(owner):
        placed = pieces @ corners[owner]
        middle = placed.mean(axis=1)
        extent = np.linalg.norm(placed - middle[:, None], axis=2).max(axis=1)
        near = np.linalg.norm(middle, axis=1) < 1.0 + extent
        owner, pieces, placed = owner[near], pieces[near], placed[near]
        edges = placed - np.roll(placed, 1, axis=1)
        fine = np.linalg.norm(edges, axis=2).max(axis=1) <= FINEST * (1.0 + ROUNDING)
        u, v = edges[fine, 1], edges[fine, 2]
        # |u x v| in any dimension; rounding may carry its square below zero.
        square = np.sum(u * u, axis=1) * np.sum(v * v, axis=1) - np.sum(u * v, axis=1) ** 2
        area = 0.5 * np.sqrt(np.maximum(square, 0.0))
        owners.append(np.repeat(owner[fine], len(_RULE)))
        shares.append((_RULE @ pieces[fine]).reshape(-1, 3))
        areas.append((area[:, None] * _RULE_WEIGHTS).ravel())
        owner = np.repeat(owner[~fine], 4)
        pieces = (_QUARTERS @ pieces[~fine][:, None]).reshape(-1, 3, 3)
    return np.concatenate(owners), np.concatenate(shares), np.concatenate(areas)

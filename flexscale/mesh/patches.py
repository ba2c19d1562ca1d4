"""Quadrature over the part of a triangulated surface that lies within a radius of a point, and the
affine motion that fits a surface best there.

A surface moves by u(q), piecewise linear or quadratic. The affine motion X0 + G (q - p) that fits
it best near p, in least squares with weight (1 - r^2/b^2)^2, r = |q - p|, is what a body that grips
or presses on the surface over a radius b feels of it. The weights of nodal values in X0 and G
reproduce every affine motion, so a force on X0 hands the surface the same force and torque.
"""

from __future__ import annotations

import numpy as np

from flexscale.arrays import FloatArray, IntArray
from flexscale.simplices import TRIANGLE_EDGES

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
    arms: FloatArray, group: IntArray, radius: float, quadratic: bool, finest: float = 0.25
) -> FloatArray:
    """Weights of nodal values in the affine motions that fit surfaces best near some points.

    Parameters
    ----------
    arms : (n, 3, d) rest corners of triangles, relative to the point that each is considered for,
        in the plane (d = 2) or in space (3), mm.
    group : (n,) number of that point.
    radius : mm, > 0.
    quadratic : whether the triangles carry six nodes, or three.
    finest : share of the radius to which triangles are cut down before they are integrated.

    Returns
    -------
    (n, 3 or 6, 1 + d) weights of the triangles' nodes in X0 and G of their point; 0 of triangles
    beyond the radius. Of a flat patch in space the part of G across it is 0.
    """
    owner, shares, areas = _cut_near_origin(arms / radius, finest)
    places = np.einsum("nk,nkd->nd", shares, arms[owner] / radius)
    weights = areas * np.maximum(1.0 - np.sum(places**2, axis=1), 0.0) ** 2
    modes = np.column_stack([np.ones(len(places)), places])
    size, points = modes.shape[1], group[owner]
    moments = np.empty((int(group.max()) + 1, size, size))
    for i in range(size):
        for j in range(i + 1):
            moments[:, i, j] = moments[:, j, i] = np.bincount(
                points, weights * modes[:, i] * modes[:, j], minlength=len(moments)
            )
    inverse = np.linalg.pinv(moments, rcond=FLAT, hermitian=True)
    fit = weights[:, None] * np.einsum("nij,nj->ni", inverse[points], modes)  # (X0, radius G)
    fit[:, 1:] /= radius
    values = quadratic_values(shares) if quadratic else shares
    forms = np.empty((len(arms), values.shape[1], size))
    for k in range(values.shape[1]):
        for c in range(size):
            forms[:, k, c] = np.bincount(owner, values[:, k] * fit[:, c], minlength=len(arms))
    return forms


def quadratic_values(shares: FloatArray) -> FloatArray:
    """Quadratic shape functions (n, 6) at barycentric coordinates (n, 3)."""
    start, end = np.transpose(TRIANGLE_EDGES)
    return np.concatenate(
        [shares * (2.0 * shares - 1.0), 4.0 * shares[:, start] * shares[:, end]], axis=1
    )


def _cut_near_origin(corners: FloatArray, finest: float) -> tuple[IntArray, FloatArray, FloatArray]:
    """Quadrature points of triangles (n, 3, d), cut down to size `finest`, over the unit
    ball.

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
        fine = np.linalg.norm(edges, axis=2).max(axis=1) <= finest * (1.0 + ROUNDING)
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

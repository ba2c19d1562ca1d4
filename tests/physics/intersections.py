"""Exact intersection of triangle surfaces: edges of one body against triangles of another."""

from __future__ import annotations

import numpy as np


def surfaces_intersect(points: np.ndarray, triangles: np.ndarray, bodies: np.ndarray) -> bool:
    """Whether an edge of one body crosses a triangle of another.

    Parameters
    ----------
    points : (n, 3); triangles : (m, 3); bodies : (n,) body of each point.
    """
    edges = np.unique(
        np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0
    )
    low, high = points[triangles].min(axis=1), points[triangles].max(axis=1)
    owner = bodies[triangles[:, 0]]
    for a, b in edges:
        box_low = np.minimum(points[a], points[b])
        box_high = np.maximum(points[a], points[b])
        near = (low <= box_high).all(axis=1) & (high >= box_low).all(axis=1) & (owner != bodies[a])
        if near.any() and _crosses(points[a], points[b], points[triangles[near]]).any():
            return True
    return False


def _volume(a, b, c, d) -> np.ndarray:
    return np.einsum("...i,...i->...", np.cross(b - a, c - a), d - a)


def _crosses(start: np.ndarray, end: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Signs of tetrahedron volumes: the ends on different sides, the line through the inside."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    opposite = _volume(a, b, c, start) * _volume(a, b, c, end) < 0.0
    sides = np.stack([_volume(start, end, p, q) for p, q in ((a, b), (b, c), (c, a))], axis=1)
    through = (sides > 0.0).all(axis=1) | (sides < 0.0).all(axis=1)
    return opposite & through

"""Extrude a scale's base and split the prisms into tets by a rule that symmetries respect."""

from __future__ import annotations

import numpy as np

from flexscale.arrays import FloatArray, IntArray


def extrude(
    points: FloatArray,
    triangles: IntArray,
    ranks: IntArray,
    center: FloatArray,
    heights: FloatArray,
) -> tuple[FloatArray, IntArray]:
    """Tets of a prismatic scale.

    The quadrilateral above a base edge is cut by the diagonal that starts below the edge's lower
    vertex, lower in rank; of two vertices of one rank, lower is the one from which the other lies
    counterclockwise about the center. Ranks are orbits of the tile's symmetries. Two vertices of a
    rank share an edge only where the symmetries are rotations alone, which keep that sense.

    Parameters
    ----------
    points : (n, 2) base vertices, mm.
    triangles : (m, 3) counterclockwise.
    ranks : (n,) equal for vertices that a symmetry of the tile exchanges.
    center : (2,) fixed point of those symmetries, mm.
    heights : (n_layers + 1,) mm, of the layers' faces, from 0 up.

    Returns
    -------
    positions (n (n_layers + 1), 3), layer by layer from z = 0, and tets (3 m n_layers, 4).
    """
    n = len(points)
    positions = np.concatenate([np.column_stack([points, np.full(n, z)]) for z in heights])
    tets = []
    for triangle in triangles:
        i, j, k = _from_low_to_high(triangle, points - center, ranks)
        path = [(i, j, k, k + n), (i, j, j + n, k + n), (i, i + n, j + n, k + n)]
        tets.extend(path)
    layer = _oriented(positions, np.array(tets, dtype=np.int64))
    return positions, np.concatenate([layer + n * level for level in range(len(heights) - 1)])


def surface_of(tets: IntArray) -> tuple[IntArray, IntArray]:
    """Faces that belong to one tet only, normals outward.

    Parameters
    ----------
    tets : (n_tets, 4) positively oriented.

    Returns
    -------
    triangles (n_surface, 3) and the tet (n_surface,) of each.
    """
    faces = np.concatenate(
        [tets[:, [1, 2, 3]], tets[:, [0, 3, 2]], tets[:, [0, 1, 3]], tets[:, [0, 2, 1]]]
    )
    owner = np.tile(np.arange(len(tets)), 4)
    _, inverse, counts = np.unique(
        np.sort(faces, axis=1), axis=0, return_inverse=True, return_counts=True
    )
    outer = counts[inverse.ravel()] == 1
    order = np.argsort(owner[outer], kind="stable")
    return faces[outer][order], owner[outer][order]


def _from_low_to_high(triangle: IntArray, arms: FloatArray, ranks: IntArray) -> list[int]:
    def is_lower(a: int, b: int) -> bool:
        if ranks[a] != ranks[b]:
            return bool(ranks[a] < ranks[b])
        return bool(arms[a, 0] * arms[b, 1] - arms[a, 1] * arms[b, 0] > 0.0)

    corners = [int(v) for v in triangle]
    below = {v: sum(is_lower(u, v) for u in corners if u != v) for v in corners}
    return sorted(corners, key=below.__getitem__)


def _oriented(positions: FloatArray, tets: IntArray) -> IntArray:
    corners = positions[tets]
    negative = np.linalg.det(corners[:, 1:] - corners[:, :1]) < 0.0
    tets = tets.copy()
    tets[negative] = tets[negative][:, [0, 1, 3, 2]]
    return tets

"""How well shaped elements are: 1 for equilateral ones, 0 for flat ones."""

from __future__ import annotations

import numpy as np

from flexscale.arrays import FloatArray, IntArray

_PAIRS = np.array([(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)])


def triangle_qualities(points: FloatArray, triangles: IntArray) -> FloatArray:
    """Area over the mean square of the sides, 1 for equilateral triangles, negative if turned over.

    Parameters
    ----------
    points : (n, 2), mm.
    triangles : (m, 3) counterclockwise.

    Returns
    -------
    (m,)
    """
    corners = points[triangles]
    sides = np.roll(corners, -1, axis=1) - corners
    double = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    return 2.0 * np.sqrt(3.0) * double / np.sum(sides**2, axis=(1, 2))


def tet_qualities(points: FloatArray, tets: IntArray) -> FloatArray:
    """Volume to the power 2/3 over the mean square of the edges, 1 for regular tets.

    Parameters
    ----------
    points : (n, 3), mm.
    tets : (m, 4) positively oriented.

    Returns
    -------
    (m,)
    """
    corners = points[tets]
    edges = corners[:, _PAIRS[:, 1]] - corners[:, _PAIRS[:, 0]]
    volumes = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6.0
    return 12.0 * np.cbrt(3.0 * volumes) ** 2 / np.sum(edges**2, axis=(1, 2))

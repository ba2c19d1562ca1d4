"""The closed surface of a scale as triangles."""

from __future__ import annotations

import manifold3d as m3
import numpy as np

from flexscale.arrays import FloatArray, IntArray


def triangles_of(outline: FloatArray) -> IntArray:
    """(m - 2, 3) corners of triangles that fill a counterclockwise outline (m, 2)."""
    return np.array(m3.triangulate([outline]), dtype=np.int64).reshape(-1, 3)


def prism_surface(outline: FloatArray, height: float) -> tuple[FloatArray, IntArray]:
    """Closed surface of a prism: vertices (2 m, 3) mm, base first, and outward triangles (n, 3)."""
    m = len(outline)
    cap = triangles_of(outline)
    here = np.arange(m)
    there = np.roll(here, -1)
    sides = np.concatenate(
        [np.stack([here, there, there + m], 1), np.stack([here, there + m, here + m], 1)]
    )
    vertices = np.zeros((2 * m, 3))
    vertices[:m, :2] = vertices[m:, :2] = outline
    vertices[m:, 2] = height
    return vertices, np.concatenate([cap[:, ::-1], cap + m, sides])

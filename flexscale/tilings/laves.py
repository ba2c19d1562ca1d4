"""Laves tiles: the most regular tile of a net.

The tile of the Laves net with vertex degrees d has the interior angles 2π/d and an inscribed
circle. Its side from vertex i to vertex i + 1 touches the circle at the distance r cot(π/d_i) from
the one and r cot(π/d_{i+1}) from the other.
"""

from __future__ import annotations

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.tilings.angles import UNIT, unit_vector


def edge_courses(net: tuple[int, ...]) -> tuple[int, ...]:
    """Direction of each edge of a Laves tile, in units of 15° from that of the first."""
    # The outline turns by 180° less the interior angle at the vertex before the edge.
    turns = [(180 - 360 // degree) // int(UNIT) for degree in net]
    return tuple(sum(turns[1 : k + 1]) for k in range(len(net)))


def laves_tile(net: tuple[int, ...], facing: float) -> FloatArray:
    """Laves tile of area 1 with its vertices' mean at the origin.

    Parameters
    ----------
    net : degree of each vertex, counterclockwise.
    facing : degrees, direction of the outward normal of the edge from vertex 0 to vertex 1.

    Returns
    -------
    (n, 2) counterclockwise vertices.
    """
    half_angles = np.array([unit_vector(180.0 / degree) for degree in net])
    tangents = half_angles[:, 0] / half_angles[:, 1]
    normals = np.array([unit_vector(facing + UNIT * course) for course in edge_courses(net)])
    along = np.stack([-normals[:, 1], normals[:, 0]], axis=1)
    # Area = r² Σ cot(π/d): two right triangles of legs r and r cot at every vertex.
    vertices = (normals - tangents[:, None] * along) / np.sqrt(tangents.sum())
    return vertices - vertices.mean(axis=0)

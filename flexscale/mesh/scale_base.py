"""The base of a scale: thin strips along its outline, coarse triangles inside.

Under loads from the sheet a scale gives way within a bond radius of its outline, so that is where
its elements must be small; along the outline they may stay long.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from flexscale.mesh.options import MeshOptions
from flexscale.mesh.prototile import SAME_POINT, Filling, fill_region
from flexscale.mesh.strip import split_row
from flexscale.mesh.wedge import make_region
from flexscale.patterns.outlines import mitre_points
from flexscale.patterns.symmetry import Isometry

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

DEEPEST = 0.5  # of the inset at which the base would vanish: strips stay clear of it


def build_base(
    nodes: FloatArray,
    kinks: NDArray[np.bool_],
    symmetries: tuple[Isometry, ...],
    center: FloatArray,
    options: MeshOptions,
) -> Filling:
    """Triangulate the base of a scale.

    Strips stop where the outline's inset would lose a corner.

    Parameters
    ----------
    nodes : (n, 2) nodes on the outline, counterclockwise, mm.
    kinks : (n,) whether the outline turns there.
    symmetries : of the tile; center : (2,) their fixed point, mm.
    """
    rows = _inset_rows(nodes, kinks, options)
    core = fill_region(
        make_region([rows[-1]], symmetries, center, True), options.scale_size, options.growth
    )
    n = len(nodes)
    outside = n * (len(rows) - 1)
    points = np.concatenate([*rows[:-1], core.points])
    first_half = _in_first_half(nodes, kinks)
    strips = [split_row(points, n * row, n * (row + 1), first_half) for row in range(len(rows) - 1)]
    triangles = np.concatenate([*strips, outside + core.triangles])
    return Filling(points, triangles, _orbits(points, symmetries, center))


def _inset_rows(
    nodes: FloatArray, kinks: NDArray[np.bool_], options: MeshOptions
) -> list[FloatArray]:
    """Rows (n, 2) of nodes from the outline inward, a strip between any two."""
    corners = np.flatnonzero(kinks)
    shifted = np.roll(nodes, -corners[0], axis=0)  # begins at a corner
    edge, fraction = _places(shifted, np.roll(kinks, -corners[0]))
    polygon = nodes[corners]
    rows, width, depth = [nodes], options.scale_rim, 0.0
    for _ in range(options.scale_strips):
        inset = mitre_points(polygon, (depth + width) / DEEPEST)
        if inset is None:
            break
        depth += width
        ends = mitre_points(polygon, depth)
        assert ends is not None  # a smaller inset keeps the corners of a larger one
        row = ends[edge] + fraction[:, None] * (np.roll(ends, -1, axis=0) - ends)[edge]
        rows.append(np.roll(row, corners[0], axis=0))
        width *= options.scale_growth
    return rows


def _places(nodes: FloatArray, kinks: NDArray[np.bool_]) -> tuple[IntArray, FloatArray]:
    """Edge (n,) of the outline that each node lies on, and its fraction (n,) of it."""
    edge = np.cumsum(kinks) - 1
    starts = nodes[kinks]
    spans = np.roll(starts, -1, axis=0) - starts
    arms = nodes - starts[edge]
    return edge, np.sum(arms * spans[edge], axis=1) / np.sum(spans[edge] ** 2, axis=1)


def _in_first_half(nodes: FloatArray, kinks: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether the segment after each node lies in the first half of its edge of the outline."""
    first = np.flatnonzero(kinks)[0]
    _, fraction = _places(np.roll(nodes, -first, axis=0), np.roll(kinks, -first))
    ahead = np.roll(fraction, -1)
    ahead[ahead == 0.0] = 1.0
    return np.roll(0.5 * (fraction + ahead) < 0.5, first)


def _orbits(points: FloatArray, symmetries: tuple[Isometry, ...], center: FloatArray) -> IntArray:
    """Numbers (n,) equal for points that a symmetry exchanges."""
    n = len(points)
    tree = cKDTree(points)
    reach = SAME_POINT * np.abs(points - center).max()
    images = np.concatenate([tree.query(s.apply(points))[1] for s in symmetries])
    distances = np.concatenate([tree.query(s.apply(points))[0] for s in symmetries])
    assert distances.max() < reach, "a base is as symmetric as its tile"
    pairs = (np.tile(np.arange(n), len(symmetries)), images)
    graph = coo_array((np.ones(len(images)), pairs), shape=(n, n))
    return connected_components(graph, directed=False)[1].astype(np.int64)

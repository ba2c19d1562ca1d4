"""The base of a scale: thin strips along its outline, coarse triangles inside.

Under loads from the sheet a scale gives way within a bond radius of its outline, so that is where
its elements must be small; along the outline they may stay long.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from flexscale.arrays import BoolArray, FloatArray, IntArray
from flexscale.mesh.options import MeshOptions
from flexscale.mesh.prototile import SAME_POINT, Filling, fill_region
from flexscale.mesh.quality import triangle_qualities
from flexscale.mesh.strip import split_row
from flexscale.mesh.wedge import make_region
from flexscale.patterns.outlines import inset_corners, inset_edges, merge_runs
from flexscale.patterns.symmetry import Isometry

DEEPEST = 0.5  # of the inset at which the base would fall apart: strips stay clear of it
FLATTEST = 0.05  # quality of triangles that tets stand on
SHORT = 0.2  # of a strip's width: nodes on its inner side that are closer become one


@dataclass(frozen=True)
class Row:
    """Nodes (n, 2) on a closed line, counterclockwise, mm.

    Attributes
    ----------
    kinks : (n,) whether the line turns there.
    first_half : (n,) whether the segment after a node lies in the first half of its chain.
    """

    nodes: FloatArray
    kinks: BoolArray
    first_half: BoolArray


def build_base(
    outline: Row,
    symmetries: tuple[Isometry, ...],
    center: FloatArray,
    options: MeshOptions,
    flattest: float = FLATTEST,
) -> Filling:
    """Triangulate the base of a scale.

    Strips stop where the base is too narrow or too pointed for them.

    Parameters
    ----------
    symmetries : of the tile; center : (2,) their fixed point, mm.
    flattest : quality; a strip with worse triangles is left out, and what lies within it.
    """
    rows, triangles, start = [outline], [], 0
    width, depth = options.scale_rim, 0.0
    for _ in range(options.scale_strips):
        depth += width
        too_narrow = inset_corners(outline.nodes[outline.kinks], depth / DEEPEST) is None
        found = None if too_narrow else _next_row(rows[-1], width)
        if found is None:
            break
        row, opposite = found
        n = len(opposite)
        points = np.concatenate([rows[-1].nodes, row.nodes])
        strip = split_row(points, np.arange(n), n + opposite, rows[-1].first_half)
        if triangle_qualities(points, strip).min() < flattest:
            break
        triangles.append(start + strip)
        rows.append(row)
        start += n
        width *= options.scale_growth
    core = fill_region(
        make_region([rows[-1].nodes], symmetries, center, True), options.scale_size, options.growth
    )
    points = np.concatenate([*(row.nodes for row in rows[:-1]), core.points])
    return Filling(
        points,
        np.concatenate([*triangles, start + core.triangles]),
        _orbits(points, symmetries, center),
    )


def _next_row(row: Row, width: float) -> tuple[Row, IntArray] | None:
    """The row of nodes at a distance inside a row, and the node (n,) opposite each of the latter.

    Nodes that come too close to each other, and those around an edge that is lost, become one.
    """
    images = inset_edges(row.nodes[row.kinks], width)
    if images is None:
        return None
    edge, fraction = _places(row)
    start, end = images[edge].transpose(1, 0, 2)
    nodes = start + fraction[:, None] * (end - start)
    nodes, opposite = merge_runs(nodes, SHORT * width)
    if len(nodes) < 3:
        return None
    kinks = np.zeros(len(nodes), dtype=bool)
    np.logical_or.at(kinks, opposite, row.kinks)
    if not shapely.Polygon(nodes).is_valid or np.count_nonzero(kinks) < 3:
        return None
    first_half = np.empty(len(nodes), dtype=bool)
    last = opposite != np.roll(opposite, -1)
    first_half[opposite[last]] = row.first_half[last]
    return Row(nodes, kinks, first_half), opposite


def _places(row: Row) -> tuple[IntArray, FloatArray]:
    """Edge (n,) of a row's polygon that each node lies on, and its fraction (n,) of it."""
    corners = row.nodes[row.kinks]
    edge = (np.cumsum(row.kinks) - 1) % len(corners)
    spans = np.roll(corners, -1, axis=0) - corners
    arms = row.nodes - corners[edge]
    return edge, np.sum(arms * spans[edge], axis=1) / np.sum(spans[edge] ** 2, axis=1)


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

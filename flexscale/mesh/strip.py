"""The half gap that a tile owns: one structured strip along each of its edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexscale.arrays import FloatArray, IntArray
from flexscale.mesh.options import MeshOptions
from flexscale.mesh.subdivision import LoopNodes, in_first_half, turns

CLEARLY_SHORTER = 1.0 - 1e-6  # diagonals closer than this in length count as equal


@dataclass(frozen=True)
class Ring:
    """Triangulation between a tile's polygon and the outline of its scale.

    Attributes
    ----------
    points : (n, 2) mm.
    triangles : (m, 3) counterclockwise.
    tile_nodes : nodes on the tile's polygon, in order, counterclockwise.
    outline_nodes : nodes on the scale's outline, in order, counterclockwise.
    coarse : positions within `outline_nodes` that the scale's base has too.
    kinks : positions within `outline_nodes` where the outline turns.
    along : (n_outline,) fraction of the outline's chain at each of `outline_nodes`.
    """

    points: FloatArray
    triangles: IntArray
    tile_nodes: IntArray
    outline_nodes: IntArray
    coarse: IntArray
    kinks: IntArray
    along: FloatArray


def layer_fractions(options: MeshOptions) -> FloatArray:
    """Rows of the half gap (across / 2 + 1,): 0 on the tile's polygon, 1 on the scale's outline."""
    sizes = options.across_grading ** np.arange(options.across // 2)[::-1]
    fractions = np.concatenate([[0.0], np.cumsum(sizes)]) / sizes.sum()
    fractions[-1] = 1.0
    return fractions


def build_strips(
    polygon: FloatArray, inset: FloatArray, nodes: LoopNodes, options: MeshOptions
) -> Ring:
    """Structured ring between a polygon and its inset, corner by corner.

    Parameters
    ----------
    polygon, inset : (n, 2) corners of the tile and, one for one, of the outline, mm.
    nodes : along the polygon.
    """
    outer, inner = nodes.points(polygon), nodes.points(inset)
    rows = [outer + fraction * (inner - outer) for fraction in layer_fractions(options)]
    n = len(outer)
    points = np.concatenate(rows)
    first_half = in_first_half(nodes.along)
    triangles = [
        split_row(points, start + np.arange(n), start + n + np.arange(n), first_half)
        for start in range(0, n * (len(rows) - 1), n)
    ]
    return Ring(
        points=points,
        triangles=np.concatenate(triangles),
        tile_nodes=np.arange(n),
        outline_nodes=np.arange(len(points) - n, len(points)),
        coarse=nodes.coarse,
        kinks=nodes.nodes_of(turns(polygon)),
        along=nodes.along,
    )


def split_row(
    points: FloatArray, outer: IntArray, inner: IntArray, first_half: NDArray[np.bool_]
) -> IntArray:
    """Cut the quadrilaterals between two rows along their shorter diagonal.

    Of equal diagonals, the one that leans from the inner row toward the middle of the chain; a rule
    that a reflection about the middle leaves alone.

    Parameters
    ----------
    outer : (n,) nodes of a closed row, counterclockwise.
    inner : (n,) node opposite each of them; the same one opposite neighbors makes a triangle.
    first_half : (n,) whether the segment after a node lies in the first half of its chain.
    """
    a, b, c, d = outer, np.roll(outer, -1), np.roll(inner, -1), inner
    to_here = np.linalg.norm(points[b] - points[d], axis=1)
    to_there = np.linalg.norm(points[a] - points[c], axis=1)
    use_bd = np.where(
        first_half, to_here * CLEARLY_SHORTER <= to_there, to_here < to_there * CLEARLY_SHORTER
    )
    use_bd |= c == d
    with_bd = np.stack([np.stack([a, b, d], 1), np.stack([b, c, d], 1)], axis=1)
    with_ac = np.stack([np.stack([a, b, c], 1), np.stack([a, c, d], 1)], axis=1)
    triangles = np.where(use_bd[:, None, None], with_bd, with_ac)
    return triangles[np.stack([np.full(len(a), True), c != d], axis=1)]

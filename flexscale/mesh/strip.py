"""The half gap that a tile owns: one structured strip along each of its edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexscale.mesh.options import MeshOptions
from flexscale.mesh.subdivision import EdgeNodes, subdivide_edge

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

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
    """

    points: FloatArray
    triangles: IntArray
    tile_nodes: IntArray
    outline_nodes: IntArray
    coarse: IntArray
    kinks: IntArray


def polygon_nodes(
    polygon: FloatArray, sharp: NDArray[np.bool_], options: MeshOptions
) -> list[EdgeNodes]:
    """Nodes along each edge of a polygon (n, 2) with sharp corners (n,)."""
    lengths = np.linalg.norm(np.roll(polygon, -1, axis=0) - polygon, axis=1)
    return [
        subdivide_edge(float(length), bool(start), bool(end), options)
        for length, start, end in zip(lengths, sharp, np.roll(sharp, -1), strict=True)
    ]


def node_loop(polygon: FloatArray, edges: list[EdgeNodes]) -> FloatArray:
    """Nodes (n, 2) along a closed polygon, each corner once."""
    ends = np.roll(polygon, -1, axis=0)
    return np.concatenate(
        [
            start + edge.fractions[:-1, None] * (end - start)
            for start, end, edge in zip(polygon, ends, edges, strict=True)
        ]
    )


def layer_fractions(options: MeshOptions) -> FloatArray:
    """Rows of the half gap (across / 2 + 1,): 0 on the tile's polygon, 1 on the scale's outline."""
    sizes = options.across_grading ** np.arange(options.across // 2)[::-1]
    fractions = np.concatenate([[0.0], np.cumsum(sizes)]) / sizes.sum()
    fractions[-1] = 1.0
    return fractions


def build_strips(
    polygon: FloatArray,
    inset: FloatArray,
    sharp: NDArray[np.bool_],
    turns: NDArray[np.bool_],
    options: MeshOptions,
) -> Ring:
    """Structured ring between a polygon and its inset, corner by corner.

    Parameters
    ----------
    polygon, inset : (n, 2) corners of the tile and, one for one, of the outline, mm.
    sharp : (n,) corners with small elements.
    turns : (n,) corners where the outline turns.
    """
    edges = polygon_nodes(polygon, sharp, options)
    outer, inner = node_loop(polygon, edges), node_loop(inset, edges)
    rows = [outer + fraction * (inner - outer) for fraction in layer_fractions(options)]
    n = len(outer)
    counts = np.array([len(edge.fractions) - 1 for edge in edges])
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    points = np.concatenate(rows)
    first_half = np.concatenate(
        [np.arange(count) < edge.middle for count, edge in zip(counts, edges, strict=True)]
    )
    triangles = [
        split_row(points, n * layer, n * (layer + 1), first_half) for layer in range(len(rows) - 1)
    ]
    coarse = [(start + edge.coarse) % n for start, edge in zip(starts, edges, strict=True)]
    return Ring(
        points=points,
        triangles=np.concatenate(triangles),
        tile_nodes=np.arange(n),
        outline_nodes=np.arange(len(points) - n, len(points)),
        coarse=np.unique(np.concatenate(coarse)),
        kinks=starts[turns],
    )


def split_row(
    points: FloatArray, outer: int, inner: int, first_half: NDArray[np.bool_]
) -> IntArray:
    """Cut the quadrilaterals between two rows along their shorter diagonal.

    Of equal diagonals, the one that leans from the inner row toward the middle of the edge; a rule
    that a reflection about the middle leaves alone.
    """
    n = len(first_half)
    here = np.arange(n)
    there = (here + 1) % n
    a, b, c, d = outer + here, outer + there, inner + there, inner + here
    to_here = np.linalg.norm(points[b] - points[d], axis=1)
    to_there = np.linalg.norm(points[a] - points[c], axis=1)
    use_bd = np.where(
        first_half, to_here * CLEARLY_SHORTER <= to_there, to_here < to_there * CLEARLY_SHORTER
    )
    with_bd = np.stack([np.stack([a, b, d], 1), np.stack([b, c, d], 1)], axis=1)
    with_ac = np.stack([np.stack([a, b, c], 1), np.stack([a, c, d], 1)], axis=1)
    return np.where(use_bd[:, None, None], with_bd, with_ac).reshape(-1, 3)

"""Where the nodes lie along a polygon: small at corners, growing geometrically to the middle.

A chain is what lies between two sharp corners: a straight edge, or a curve of many. Sizes along it
depend on the lengths of its edges, the sharpness of its ends and what holds for the whole pattern,
and reversing a chain reverses them. So both tiles of a chain agree on its nodes, and so do all
chains that a symmetry of the pattern exchanges. Every corner of the polygon is a node; so is the
middle of an edge that lies in the middle of its chain, where a mirror may cross it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexscale.arrays import BoolArray, FloatArray, IntArray
from flexscale.mesh.options import MeshOptions
from flexscale.patterns.junctions import turning_angles

ROUNDING = 1e-6  # relative: lengths that differ by rounding must give the same number of elements
STRAIGHT = 1e-5  # radians: a polygon counts as straight where it turns less


@dataclass(frozen=True)
class TipSizes:
    """Small elements from sharp corners of the tiles to past the tips of their scales.

    A scale's tip lies further from the tiling vertex the sharper it is, and what it faces must not
    be coarse: there the sheet is strained most. Nor must the tip be: its base's triangles are no
    more than twice as large.

    Attributes
    ----------
    reach : mm along the gap from a sharp corner.
    largest : mm, size of elements up to there.
    """

    reach: float = 0.0
    largest: float = np.inf


NO_TIPS = TipSizes()


@dataclass(frozen=True)
class LoopNodes:
    """Nodes around a closed polygon, counterclockwise.

    Attributes
    ----------
    edge : (n,) edge of the polygon that a node lies on; edge k starts at corner k.
    fraction : (n,) of the edge's length, 0 at its start.
    along : (n,) fraction of the chain's length, 0 at its start.
    coarse : numbers of the nodes that a scale's base has too, all corners that turn among them.
    """

    edge: IntArray
    fraction: FloatArray
    along: FloatArray
    coarse: IntArray

    def points(self, polygon: FloatArray) -> FloatArray:
        """Positions (n, 2) on a polygon with as many corners, mm."""
        ends = np.roll(polygon, -1, axis=0)
        return polygon[self.edge] + self.fraction[:, None] * (ends - polygon)[self.edge]

    def nodes_of(self, corners: BoolArray) -> IntArray:
        """Numbers of the nodes on the flagged corners of the polygon."""
        return np.flatnonzero((self.fraction == 0.0) & corners[self.edge])


def turns(polygon: FloatArray) -> BoolArray:
    """Whether a polygon turns at each of its corners."""
    return np.abs(turning_angles(polygon)) > STRAIGHT


def subdivide_loop(
    polygon: FloatArray, sharp: BoolArray, options: MeshOptions, tips: TipSizes = NO_TIPS
) -> LoopNodes:
    """Nodes around a polygon (n, 2), mm, with sharp corners (n,).

    Without any sharp corner, every edge is its own chain.
    """
    n = len(polygon)
    lengths = np.linalg.norm(np.roll(polygon, -1, axis=0) - polygon, axis=1)
    starts = np.flatnonzero(sharp) if sharp.any() else np.arange(n)
    members = np.split(np.roll(np.arange(n), -starts[0]), starts[1:] - starts[0])
    chains = [subdivide_chain(lengths[m], bool(sharp.any()), options, tips) for m in members]
    counts = [len(chain.edge) for chain in chains]
    first = np.concatenate([[0], np.cumsum(counts)])
    nodes = LoopNodes(
        edge=np.concatenate([m[chain.edge] for m, chain in zip(members, chains, strict=True)]),
        fraction=np.concatenate([chain.fraction for chain in chains]),
        along=np.concatenate([chain.along for chain in chains]),
        coarse=np.concatenate([k + chain.coarse for k, chain in zip(first, chains, strict=False)]),
    )
    wished = np.concatenate([nodes.coarse % first[-1], nodes.nodes_of(turns(polygon))])
    return LoopNodes(nodes.edge, nodes.fraction, nodes.along, np.unique(wished))


def subdivide_chain(
    lengths: FloatArray, sharp: bool, options: MeshOptions, tips: TipSizes = NO_TIPS
) -> LoopNodes:
    """Nodes along a chain of edges (n,), mm, with two sharp ends or two smooth ones.

    Returns
    -------
    All nodes but the last one; edges are counted along the chain, and the coarse nodes are those
    wished for, both ends among them.
    """
    total = float(lengths.sum())
    knots = _wished_nodes(0.5 * total, sharp, options, tips)
    count = np.arange(len(knots))
    ends = np.concatenate([[0.0], np.cumsum(lengths) / total])
    ends[-1] = 1.0
    reached = np.interp(ends, knots, count)
    pieces = []
    for k in range(len(lengths)):
        n = max(1, int(np.ceil((reached[k + 1] - reached[k]) * (1.0 - ROUNDING))))
        if abs(ends[k] + ends[k + 1] - 1.0) < ROUNDING:
            n += n % 2  # a node in the middle of the chain
        pieces.append(np.interp(np.linspace(reached[k], reached[k + 1], n + 1), count, knots)[:-1])
    along = np.concatenate(pieces)
    edge = np.repeat(np.arange(len(lengths)), [len(piece) for piece in pieces])
    fraction = (along - ends[edge]) / np.diff(ends)[edge]
    fraction[np.flatnonzero(np.diff(edge, prepend=-1))] = 0.0
    return LoopNodes(edge, fraction, along, _coarse_nodes(along, total, sharp, options, tips))


def in_first_half(along: FloatArray) -> BoolArray:
    """Whether the segment after each node of a loop lies in the first half of its chain.

    Parameters
    ----------
    along : (n,) fraction of the chain's length at each node, 0 where a chain starts.
    """
    ahead = np.roll(along, -1)
    return 0.5 * (along + np.where(ahead > along, ahead, 1.0)) < 0.5


def graded_lengths(
    total: float, first: float, growth: float, largest: float, tips: TipSizes = NO_TIPS
) -> FloatArray:
    """Element lengths from `first` on, growing by `growth` to `largest`, that add up to `total`.

    Returns
    -------
    (n,) mm, n the fewest for which no length is above its wish.
    """
    wishes = [min(first, largest)]
    reached = wishes[0]
    while reached < total * (1.0 - ROUNDING):
        limit = min(largest, tips.largest) if reached < tips.reach - ROUNDING * total else largest
        wishes.append(min(wishes[-1] * growth, max(limit, first)))
        reached += wishes[-1]
    return np.array(wishes) * (total / reached)


def _wished_nodes(half: float, sharp: bool, options: MeshOptions, tips: TipSizes) -> FloatArray:
    """Nodes from 0 to 1 along a chain without corners, alike from both ends."""
    first = min(options.corner, options.along) if sharp else options.along
    near = tips if sharp else NO_TIPS
    lengths = graded_lengths(half, first, options.growth, options.along, near)
    nodes = np.concatenate([[0.0], np.cumsum(lengths)]) / lengths.sum()
    nodes[-1] = 1.0
    return np.concatenate([0.5 * nodes, 1.0 - 0.5 * nodes[-2::-1]])


def _coarse_nodes(
    along: FloatArray, total: float, sharp: bool, options: MeshOptions, tips: TipSizes
) -> IntArray:
    """Numbers of the nodes nearest to those wished for a scale's base, both ends among them."""
    first = min(options.scale_corner, 2.0 * tips.largest) if sharp else options.scale_size
    lengths = graded_lengths(0.5 * total, first, options.scale_growth, options.scale_size)
    targets = np.concatenate([[0.0], np.cumsum(lengths)])
    nodes = total * np.concatenate([along, [1.0]])
    forth, back = (_nearest(places, targets) for places in (nodes, total - nodes[::-1]))
    return np.unique(np.concatenate([forth, len(along) - back])).astype(np.int64)


def _nearest(nodes: FloatArray, targets: FloatArray) -> IntArray:
    """Number of the node nearest to each target, the first of two that are equally near."""
    apart = np.abs(nodes[:, None] - targets)
    near = apart <= apart.min(axis=0) + ROUNDING * nodes[-1]
    return near.argmax(axis=0)

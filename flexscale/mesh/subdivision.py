"""Where the nodes lie along an edge: small at corners, growing geometrically to the middle.

Positions depend on nothing but the edge's length and the sharpness of its two ends, and reversing
the edge reverses them. So both tiles of an edge agree on its nodes, and so do all edges that a
symmetry of the pattern exchanges.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexscale.mesh.options import MeshOptions

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

ROUNDING = 1e-6  # relative: lengths that differ by rounding must give the same number of elements


@dataclass(frozen=True)
class EdgeNodes:
    """Nodes of one edge.

    Attributes
    ----------
    fractions : (n + 1,) from 0 to 1.
    middle : index of the node at 1/2.
    coarse : indices of the nodes that the scale's base has too, 0, middle and n among them.
    """

    fractions: FloatArray
    middle: int
    coarse: IntArray


def subdivide_edge(
    length: float, sharp_start: bool, sharp_end: bool, options: MeshOptions
) -> EdgeNodes:
    """Nodes along an edge of `length` mm."""
    first = _half_edge(0.5 * length, sharp_start, options)
    last = _half_edge(0.5 * length, sharp_end, options)
    fractions = np.concatenate([0.5 * first, 1.0 - 0.5 * last[-2::-1]])
    middle, n = len(first) - 1, len(fractions) - 1
    coarse_first = _coarse_nodes(0.5 * length * first, sharp_start, options)
    coarse_last = n - _coarse_nodes(0.5 * length * last, sharp_end, options)
    return EdgeNodes(fractions, middle, np.unique(np.concatenate([coarse_first, coarse_last])))


def graded_lengths(total: float, first: float, growth: float, largest: float) -> FloatArray:
    """Element lengths from `first` on, growing by `growth` to `largest`, that add up to `total`.

    Returns
    -------
    (n,) mm, n the fewest for which no length is above its wish.
    """
    wishes = [min(first, largest)]
    reached = wishes[0]
    while reached < total * (1.0 - ROUNDING):
        wishes.append(min(wishes[-1] * growth, largest))
        reached += wishes[-1]
    return np.array(wishes) * (total / reached)


def _half_edge(half: float, sharp: bool, options: MeshOptions) -> FloatArray:
    """Nodes from one end to the middle, as fractions of the half."""
    first = min(options.corner, options.along) if sharp else options.along
    lengths = graded_lengths(half, first, options.growth, options.along)
    nodes = np.concatenate([[0.0], np.cumsum(lengths)]) / lengths.sum()
    nodes[-1] = 1.0
    return nodes


def _coarse_nodes(nodes: FloatArray, sharp: bool, options: MeshOptions) -> IntArray:
    """Indices of the nodes nearest to those wished for a scale's base, both ends among them."""
    first = options.scale_corner if sharp else options.scale_size
    lengths = graded_lengths(nodes[-1], first, options.scale_growth, options.scale_size)
    targets = np.concatenate([[0.0], np.cumsum(lengths)])
    return np.unique(np.abs(nodes[:, None] - targets).argmin(axis=0)).astype(np.int64)

"""How many elements a mesh will have, told before it is made, and refused where it is too many.

Rough, within a factor of four: sizes grow from `corner` to `along` over a few elements, the
sheet under a scale is filled from its outline inward, and strips of the base follow the outline.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from flexscale.errors import MeshError
from flexscale.mesh.options import MeshOptions
from flexscale.patterns.cell import polygon_area
from flexscale.patterns.pattern import Pattern
from flexscale.patterns.prototiles import Prototile

MOST_TRIANGLES = 400_000  # of the substrate in a cell: the mesher takes a minute for so many
MOST_TETS = 4_000_000  # of the scales in a cell
_PER_NODE = 8.0  # triangles of the sheet for each node along the gap, beside those across it
_PER_AREA = 4.0 / math.sqrt(3.0)  # triangles of side 1 in an area of 1


class ElementCount(NamedTuple):
    """Triangles of the substrate, tets of the scales."""

    triangles: float
    tets: float


def estimate_elements(pattern: Pattern, options: MeshOptions) -> ElementCount:
    """Number of elements of one lattice cell, roughly."""
    counts = [_count(prototile, options) for prototile in pattern.prototiles]
    chosen = [counts[copy.prototile] for copy in pattern.copies]
    return ElementCount(sum(c.triangles for c in chosen), sum(c.tets for c in chosen))


def require_moderate_mesh(pattern: Pattern, options: MeshOptions) -> None:
    """Refuse element sizes that make a cell of very many elements, before it is meshed.

    Raises
    ------
    MeshError : with the number expected.
    """
    expected = estimate_elements(pattern, options)
    if expected.triangles > MOST_TRIANGLES:
        raise MeshError(
            f"The substrate of one cell would have about {expected.triangles:.2g} triangles, more "
            f"than {MOST_TRIANGLES}: give a larger mesh option `along` (now {options.along:g} mm) "
            f"or `corner` (now {options.corner:g} mm), or a smaller `across`."
        )
    if expected.tets > MOST_TETS:
        raise MeshError(
            f"The scales of one cell would have about {expected.tets:.2g} tets, more than "
            f"{MOST_TETS}: give a larger mesh option `scale_size` (now {options.scale_size:g} mm) "
            f"or `scale_corner` (now {options.scale_corner:g} mm), or fewer layers or strips."
        )


def _count(prototile: Prototile, options: MeshOptions) -> ElementCount:
    polygon, gap = prototile.polygon, prototile.gap
    around = float(np.linalg.norm(polygon - np.roll(polygon, 1, axis=0), axis=1).sum())
    n_sharp = max(1, int(prototile.sharp.sum()))
    # Without strips the ring along the gap is filled with triangles of the size along it.
    ring = _PER_AREA * 0.5 * gap * around / min(options.along, 2.0 * gap / options.across) ** 2
    sizes = (options.corner, options.along, options.growth)
    nodes = _nodes(around, n_sharp, *sizes)
    base_sizes = (options.scale_corner, options.scale_size, options.scale_growth)
    base_nodes = _nodes(around, n_sharp, *base_sizes)
    base = _PER_AREA * polygon_area(polygon) / options.scale_size**2
    base += 2.0 * (options.scale_strips + 2) * base_nodes
    return ElementCount(
        nodes * (options.across + _PER_NODE) + ring, 3.0 * options.scale_layers * base
    )


def _nodes(around: float, n_sharp: int, corner: float, largest: float, growth: float) -> float:
    """Nodes along an outline whose sizes grow away from its corners."""
    smallest = min(corner, largest)
    growing = math.log(largest / smallest) / math.log(growth) if growth > 1.0 else math.inf
    return min(around / largest + 2.0 * n_sharp * (growing + 1.0), around / smallest)

"""Gaps of scales: one for all, or one for each tile.

Each scale ends half its own gap within its tile, so that the gap between two scales is the mean of
theirs. No two scales of a tiling are closer than that, also where their tiles share but a vertex.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.checks import Check, length
from flexscale.errors import PatternError, shown
from flexscale.patterns.corners import ROUNDING, corner_classes

#: A gap of all scales, or the gaps of the scales on a pattern's tiles, mm.
Gap = float | tuple[float, ...]
_DIGITS = 9  # significant: means of equal gaps are equal
_LENGTH = length()


def _is_list(value: Any) -> bool:
    return isinstance(value, list | tuple) or getattr(value, "ndim", 0) > 0


def one_or_several(value: Any, label: str) -> Gap:
    """Check of a gap, or of several."""
    if not _is_list(value):
        return float(_LENGTH(value, label))
    return tuple(float(_LENGTH(item, f"{label} {number}")) for number, item in enumerate(value))


def one_alone(value: Any, label: str) -> float:
    """Check of a gap where there is one for all tiles."""
    if _is_list(value):
        raise PatternError(
            f"{label} is {shown(value)}, but a family has one gap for all its tiles: give one "
            "number, or make the pattern of its tiles with Pattern.from_polygons(tiles, t1, t2, "
            "gap=[…])."
        )
    return float(_LENGTH(value, label))


vars(one_or_several).update(vars(_LENGTH))  # bounds, which `run --fields` tells
GAP: Check = one_or_several
ONE_GAP: Check = one_alone


def gaps_of_tiles(gap: Gap, n_tiles: int) -> tuple[float, ...]:
    """Gap of each tile's scale, mm.

    Raises
    ------
    PatternError : as many gaps were given as there are no tiles.
    """
    if not isinstance(gap, tuple):
        return (gap,) * n_tiles
    if len(gap) != n_tiles:
        raise PatternError(
            f"The gaps given are {len(gap)}, but the polygons are {n_tiles}: give one gap for each "
            "polygon, in their order, or one number for all."
        )
    return gap


def simplest(gap: Gap) -> Gap:
    """One number where all gaps are equal."""
    return gap[0] if isinstance(gap, tuple) and len(set(gap)) == 1 else gap


def gap_between(first: float, second: float) -> float:
    """Gap between scales of two gaps, mm: equal means are equal to the last bit."""
    if first == second:
        return first
    return float(f"{0.5 * (first + second):.{_DIGITS}g}")


def narrowest_gap(
    tiles: Sequence[FloatArray], lattice: FloatArray, gaps: Sequence[float], size: float
) -> float:
    """Narrowest gap between two scales whose tiles share a vertex, mm.

    Parameters
    ----------
    size : mm, of a tile.
    """
    if len(set(gaps)) == 1:
        return gaps[0]
    vertices = np.concatenate(corner_classes(list(tiles), lattice, ROUNDING * size))
    own = np.repeat(gaps, [len(tile) for tile in tiles])
    order = np.lexsort((own, vertices))
    vertices, own = vertices[order], own[order]
    first = np.unique(vertices, return_index=True)[1]  # the narrowest at each vertex, then the next
    pairs = np.stack([own[first], own[first + 1]], axis=1)
    narrowest = pairs[pairs.sum(axis=1).argmin()]
    return gap_between(float(narrowest[0]), float(narrowest[1]))

"""Overlays of areas that may share edges, as tiles do with each other and with a border.

GEOS overlays in floating point first. Where edges coincide but for rounding, it may take all of an
area for what it shares with another (shapely issue 1871). Rounded to a grid this does not happen,
but all corners move a little. So both are made, and the grid decides where their areas differ.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import shapely

GRID = 2.0**-40  # of the largest coordinate: far above rounding, far below any size that matters
_WIDTHS = 4.0  # of the grid, by which an outline moves at most, rounding of areas included


def intersection(areas: Any, other: Any) -> Any:
    """What areas share with another; arrays broadcast."""
    return _checked(shapely.intersection, areas, other)


def difference(areas: Any, other: Any) -> Any:
    """What is left of areas without another; arrays broadcast."""
    return _checked(shapely.difference, areas, other)


def symmetric_difference(areas: Any, other: Any) -> Any:
    """What belongs to one of two areas only; arrays broadcast."""
    return _checked(shapely.symmetric_difference, areas, other)


def union(areas: Any) -> Any:
    """All of some areas (n,) together."""
    return _checked(shapely.union_all, areas)


def _checked(overlay: Callable[..., Any], *areas: Any) -> Any:
    """The overlay as it is, or on the grid where that has another area."""
    plain = overlay(*areas)
    bounds = np.concatenate([shapely.bounds(each).ravel() for each in areas])
    reach = float(np.nanmax(np.abs(bounds), initial=0.0))
    if reach == 0.0:  # there are no areas, or all are empty
        return plain
    rounded = overlay(*areas, grid_size=GRID * reach)
    lengths = sum(float(np.sum(shapely.length(each))) for each in areas)
    off = np.abs(shapely.area(plain) - shapely.area(rounded))
    wrong = off > _WIDTHS * GRID * reach * lengths
    return np.where(wrong, rounded, plain) if np.ndim(wrong) else rounded if wrong else plain

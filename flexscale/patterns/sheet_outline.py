"""Borders of sheets between two ends: rectangles, and other polygons of the same length and width.

A sheet reaches from its near end, x = 0, to its far end, x = length, and from y = 0 to y = width.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike

from flexscale.arrays import FloatArray
from flexscale.errors import PatternError, UnitRangeError, shown
from flexscale.patterns.laid import ON_LINE, on_line, rectangle, shown_size
from flexscale.patterns.polygons import MOST_CORNERS
from flexscale.units import require_array


def sheet_outline(value: Any, label: str = "outline") -> FloatArray:
    """Check of the outline of a sheet: (n, 2) corners in mm, made counterclockwise.

    Raises
    ------
    PatternError : no list of corners, or they do not go around an area once.
    """
    try:
        corners = require_array(value, label, "mm")
    except UnitRangeError:
        corners = np.empty(0)
    if corners.ndim != 2 or corners.shape[1:] != (2,) or not 3 <= len(corners) <= MOST_CORNERS:
        raise PatternError(
            f"{label} must be a list of 3 to {MOST_CORNERS} corners (x, y), finite, in mm, not "
            f"{shown(value)}."
        )
    shape = shapely.Polygon(corners)
    if not shape.is_valid:
        raise PatternError(
            f"{label} does not go around a sheet once ({shapely.is_valid_reason(shape)} mm): give "
            "its corners in order, each once."
        )
    turned = shapely.remove_repeated_points(shapely.orient_polygons(shape))
    return np.array(turned.exterior.coords)[:-1]


def sheet_border(length: float, width: float, outline: ArrayLike | None = None) -> FloatArray:
    """(n, 2) border of a sheet, counterclockwise, mm.

    Parameters
    ----------
    length, width : mm.
    outline : (n, 2) corners, mm, in either orientation; the rectangle of both sizes if not given.

    Raises
    ------
    PatternError : an outline that is none, has another length or width, or does not have both ends.
    """
    if outline is None:
        return rectangle(length, width)
    border = sheet_outline(outline)
    low, high = border.min(axis=0), border.max(axis=0)
    if np.abs([*low, *(high - [length, width])]).max() > ON_LINE:
        raise PatternError(
            f"The outline reaches from ({low[0]:g}, {low[1]:g}) to ({high[0]:g}, {high[1]:g}) mm, "
            f"but a sheet of {shown_size(rectangle(length, width))} from (0, 0) to ({length:g}, "
            f"{width:g}): move it, or give the length and width that it has."
        )
    for x, name in ((0.0, "near"), (length, "far")):
        if not on_line(border, x):
            raise PatternError(
                f"The outline has no edge at x = {x:g} mm, where the {name} end of the sheet is "
                "held: let it end there with a straight edge across."
            )
    return border

"""The cell of typed polygons, with all symmetry that they have to their digits."""

from __future__ import annotations

import logging
from functools import cache

from flexscale.errors import PatternError
from flexscale.patterns.cell import TiledCell, build_cell
from flexscale.patterns.corners import farthest_merged
from flexscale.patterns.drawing import (
    COARSEST,
    FINEST,
    ONE_POINT,
    Drawing,
    corner_tolerance,
    own_digits,
    read_drawing,
)
from flexscale.patterns.exact_symmetry import symmetry_near, symmetry_within

log = logging.getLogger(__name__)


def typed_cell(drawing: Drawing) -> TiledCell:
    """Tiles that cover the plane, moved by their own digits only, and exactly symmetric.

    Where the pattern is nearly more symmetric, but not to its digits, a warning in the log says so.

    Raises
    ------
    PatternError : see `build_cell`.
    """
    cell, unit = _cell(drawing)
    found = symmetry_within(cell, own_digits(unit, drawing.size))
    farther = symmetry_near(drawing)
    if farther is not None and farther.order > found.order:
        say_once(
            f"The pattern is nearly {farther.group}, off by {farther.off:.1g} mm, and is computed "
            f"as {found.group}: rounded? `symmetrize` makes it exact."
        )
    return found.cell


def symmetrized_drawing(drawing: Drawing) -> Drawing:
    """The most symmetric pattern within 1e-3 of a tile's size.

    Raises
    ------
    PatternError : see `build_cell`.
    """
    found = symmetry_near(drawing)
    return read_drawing(found.cell.tiles, *found.cell.lattice) if found else drawing


def _cell(drawing: Drawing) -> tuple[TiledCell, float]:
    """The tiles with all corners, and the unit [mm] to which they were typed.

    Where tiles cover the plane only to fewer digits than they have, those are their digits: a
    published list may mix numbers of five decimals with roots, or be scaled.
    """
    unit = drawing.unit
    while True:
        tolerance = corner_tolerance(unit, drawing.size)
        try:
            cell = build_cell(drawing.tiles, drawing.lattice, tolerance)
        except PatternError:
            if tolerance >= COARSEST * drawing.size:
                raise
            unit *= 10.0
        else:
            break
    if unit > drawing.unit:
        say_once(
            f"The corners of neighboring tiles agree to {tolerance:.1g} mm only and are made one: "
            "more digits that agree would be kept."
        )
    else:
        _tell_merged(drawing, tolerance)
    return cell, unit


def _tell_merged(drawing: Drawing, tolerance: float) -> None:
    """Say so where corners are made one that differ by more than their last decimal."""
    limit = max(ONE_POINT * drawing.unit, FINEST * drawing.size)
    apart = farthest_merged(drawing.tiles, drawing.lattice, tolerance, limit)
    if apart > 0.0:
        say_once(
            f"Corners of neighboring tiles that differ by {apart:.1g} mm are taken for one point, "
            f"typed to {drawing.unit:.1g} mm: those that are two must lie more than "
            f"{tolerance:.1g} mm apart."
        )


@cache
def say_once(text: str) -> None:
    """Say something about a pattern, once."""
    log.warning("%s", text)

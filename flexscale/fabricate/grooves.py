"""Rings under a scale, parallel to its outline: what keys it into the substrate."""

from __future__ import annotations

import shapely

from flexscale.fabricate.options import Grooves
from flexscale.fabricate.walls import GRID, inset, on_grid, opened
from flexscale.patterns.overlay import difference

_WIDER = 4.0 * GRID  # added to every width, so that rounding to the grid makes none too narrow


def groove_rings(base: shapely.Polygon, grooves: Grooves) -> list[shapely.Polygon]:
    """Grooves under one scale, outermost first; none if it is too small for any.

    Outside and inside of a ring are found in turn. What is left inside a ring, less its width, is
    opened by the spacing before it holds substrate, and what is left of that, less the spacing, is
    opened by the width before it holds the next ring. So neither ever gets thinner than asked,
    whatever the outline does; a small middle fills up instead.

    Parameters
    ----------
    base : outline of the scale's base, mm.
    grooves : sizes; a depth of 0 makes none.
    """
    if grooves.depth == 0.0:
        return []
    width, spacing = grooves.width + _WIDER, grooves.spacing + _WIDER
    rings: list[shapely.Polygon] = []
    outside = opened(inset(base, grooves.first + _WIDER), width, spacing)
    while not outside.is_empty:
        inside = opened(inset(outside, width), spacing, width)
        found = on_grid(difference(outside, inside))
        rings += [ring for ring in shapely.get_parts(found) if ring.area > 0.5 * width**2]
        outside = opened(inset(inside, spacing), width, spacing)
    return rings

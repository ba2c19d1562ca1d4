"""Hinge barrels at the ends of a rectangle: bars of scale material with a hole for a pin.

A bar stands on the substrate's end strip, keyed like a scale, so that it cannot peel off. Its sides
rise straight to the height of the axis: it prints without support.
"""

from __future__ import annotations

import numpy as np
import shapely

from flexscale.fabricate.shapes import Rectangle, circle_points
from flexscale.fabricate.walls import GRID, on_grid
from flexscale.patterns.overlay import difference, union


def hinge_axes(rectangle: Rectangle, gap: float, substrate_thickness: float) -> np.ndarray:
    """(n, 2) x and z of the hinge axes, which run along y, mm; the print's bed is z = 0."""
    if not rectangle.n_hinges:
        return np.empty((0, 2))
    x = GRID * round((0.5 * rectangle.length + gap + rectangle.barrel_radius) / GRID)
    z = substrate_thickness + rectangle.barrel_radius
    return np.array([[-x, z], [x, z]])


def hinge_bases(rectangle: Rectangle, gap: float) -> list[shapely.Polygon]:
    """Footprints of the two bars, mm; none without a pin."""
    side, radius = 0.5 * rectangle.width, rectangle.barrel_radius
    axes = hinge_axes(rectangle, gap, 0.0)[:, 0]
    return [on_grid(shapely.box(x - radius, -side, x + radius, side)) for x in axes]


def hinge_profile(rectangle: Rectangle) -> shapely.Polygon:
    """Section of a bar across its axis, mm: the axis at x = 0, the bar's base at y = 0."""
    radius = rectangle.barrel_radius
    middle = np.array([0.0, radius])
    around = circle_points(radius, outside=False) + middle
    hole = circle_points(0.5 * rectangle.hole, outside=True) + middle
    foot = shapely.box(-radius, 0.0, radius, radius)
    bar = union([shapely.Polygon(around), foot])
    return on_grid(difference(bar, shapely.Polygon(hole)))

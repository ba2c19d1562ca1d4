"""How thin an area is: its smallest wall, and cutting off what is too thin to print.

An area is printable with walls of w if what remains of it after an inset by w/2 (where the middle
of a bead of this width may run) is in one piece, and no point of the area is farther from that than
`CORNER` times w/2. A neck narrower than w breaks the inset, a fin narrower than w lies away from
it. A corner of angle α lies w/2 / sin(α/2) away from it, so corners down to 29° are corners, which
a bead rounds, and sharper ones are needles.
"""

from __future__ import annotations

import numpy as np
import shapely

CORNER = 4.0  # farthest corner from a bead's middle, in halves of the wall: 29°
GRID = 2.0**-13  # mm: corners lie on this grid, and 32-bit numbers hold them exactly up to 2 m
_STEP = 0.25  # mm, between points of an outline that are examined
_BISECTIONS = 40


def inset(area: shapely.Geometry, distance: float) -> shapely.Geometry:
    """What lies deeper than `distance` (mm) in an area."""
    return area.buffer(-distance, join_style="mitre", mitre_limit=CORNER)


def opened(area: shapely.Geometry, wall: float) -> shapely.Geometry:
    """An area without what is thinner than `wall` (mm); corners down to 29° stay."""
    core = inset(area, 0.5 * wall)
    grown = core.buffer(0.5 * wall, join_style="mitre", mitre_limit=CORNER)
    return polygonal(shapely.intersection(area, grown))


def is_printable(area: shapely.Polygon, wall: float) -> bool:
    """Whether no wall of a polygon is thinner than `wall`, mm."""
    core = inset(area, 0.5 * wall * (1.0 - 1e-6))
    if core.is_empty or core.geom_type != "Polygon":
        return False
    rim = shapely.points(shapely.get_coordinates(shapely.segmentize(area, _STEP)))
    shapely.prepare(core)
    return bool(shapely.distance(rim, core).max() <= 0.5 * CORNER * wall + 4.0 * GRID)


def smallest_wall(areas: list[shapely.Polygon]) -> float:
    """The width, mm, at which the first of some polygons stops being printable; nan without any."""
    least = np.inf
    for area in areas:
        circle = shapely.maximum_inscribed_circle(area, tolerance=1e-3)
        high = min(least, 2.0 * circle.length)
        if high == least and is_printable(area, least):
            continue
        low = 0.0
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if is_printable(area, middle) else (low, middle)
        least = low
    return float(least) if np.isfinite(least) else float("nan")


def without_thin_parts(area: shapely.Polygon, wall: float) -> shapely.Polygon | None:
    """The largest part of a polygon that can be printed with walls of `wall` mm; None if none can.

    A polygon that can be printed comes back as it is.
    """
    if is_printable(area, wall):
        return area
    parts = shapely.get_parts(on_grid(opened(area, wall)))
    for part in sorted(parts, key=lambda part: -part.area):
        if is_printable(part, wall):
            return part
    return None


def on_grid(area: shapely.Geometry) -> shapely.Geometry:
    """A valid area with its corners on the grid; corners closer than that are one."""
    return polygonal(shapely.set_precision(area, GRID))


def polygonal(area: shapely.Geometry) -> shapely.Geometry:
    """The polygons of a geometry, without points and lines where areas touch."""
    parts = shapely.get_parts(area)
    return shapely.union_all(parts[shapely.get_dimensions(parts) == 2])

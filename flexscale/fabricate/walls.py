"""How thin an area is: its smallest wall, and cutting off what is too thin to print.

An area is printable with walls of w if what remains of it after an inset by w/2 (where the middle
of a bead of this width may run) is in one piece, no point of the area is farther from that than
`CORNER` times w/2, and no fin is lost. A neck narrower than w breaks the inset, a long fin narrower
than w lies away from it. A corner of angle α lies w/2 / sin(α/2) away from it, so corners down to
29° are corners, which a bead rounds, and sharper ones are needles.

A fin is what no bead reaches (opening by a disc) and no corner explains (opening with mitred
corners) that sticks out by more than `FIN` times w: a short fin may lie nearer to the bead than the
tip of a sharp corner does.
"""

from __future__ import annotations

import manifold3d as m3
import numpy as np
import shapely

from flexscale.patterns.overlay import intersection

CORNER = 4.0  # farthest corner from a bead's middle, in halves of the wall: 29°
FIN = 0.5  # of the wall, by which a fin sticks out of what is printed; bumps are lower
GRID = 2.0**-15  # mm: corners lie on it; up to half a meter 32-bit numbers hold them exactly
_STEP = 0.5  # mm, between points of an outline that are examined
_ARC = 128  # corners of a whole circle, where a bead's middle turns around an inner corner
_ROUNDING = 1e-3  # of the wall
_NARROWER = 0.95  # of the wall: what is no wider than this counts as a fin
_WIDER = 1.25  # ratio of the widths that are tried in search of the smallest wall
_BISECTIONS = 24


def inset(area: shapely.Geometry, distance: float) -> shapely.Geometry:
    """What lies deeper than `distance` (mm) in an area."""
    return _offset(area, -distance)


def opened(area: shapely.Geometry, wall: float, apart: float) -> shapely.Geometry:
    """An area without what is thinner than `wall` (mm); corners down to 29° stay.

    Where it falls into parts closer to each other than `apart` (mm), the smaller are left out.
    """
    kept: list[shapely.Polygon] = []
    for core in _by_size(inset(area, 0.5 * wall)):
        # Mitres may reach across a notch: what lies there is no part of this one.
        found = _by_size(polygonal(intersection(area, _offset(core, 0.5 * wall))))
        if found and all(shapely.distance(found[0], other) >= apart for other in kept):
            kept.append(found[0])
    return shapely.MultiPolygon(kept)


def _by_size(area: shapely.Geometry) -> list[shapely.Polygon]:
    """The polygons of an area, largest first."""
    return sorted(shapely.get_parts(area), key=lambda part: -part.area)


def _offset(
    area: shapely.Geometry, distance: float, join: m3.JoinType = m3.JoinType.Miter
) -> shapely.Geometry:
    """Parallel outlines. Where corners are mitred, they are blunt beyond `CORNER` distances.

    Made by Clipper2. (shapely simplifies an outline by a percent of the distance before, which
    would make walls that much too thin.)
    """
    if area.is_empty:
        return area
    return areas_of(_moved(_section(area), distance, join))


def _section(area: shapely.Geometry) -> m3.CrossSection:
    return m3.CrossSection(rings_of(area), m3.FillRule.EvenOdd)


def _moved(section: m3.CrossSection, distance: float, join: m3.JoinType) -> m3.CrossSection:
    return section.offset(distance, join, miter_limit=CORNER, circular_segments=_ARC)


def rings_of(area: shapely.Geometry) -> list[np.ndarray]:
    """All outlines (n_i, 2) of an area, holes included, mm."""
    return [
        np.array(ring.coords)[:-1]
        for part in shapely.get_parts(area)
        for ring in (part.exterior, *part.interiors)
    ]


def areas_of(section: m3.CrossSection) -> shapely.Geometry:
    """The polygons, holes included, of a section."""
    areas = []
    for part in section.decompose():
        rings = sorted(map(shapely.Polygon, part.to_polygons()), key=lambda ring: -ring.area)
        if rings:
            holes = [ring.exterior for ring in rings[1:]]
            areas.append(shapely.Polygon(rings[0].exterior, holes))
    return shapely.union_all(areas)


def is_printable(area: shapely.Polygon, wall: float) -> bool:
    """Whether no wall of a polygon is thinner than `wall`, mm."""
    core = _offset(area, -0.5 * wall, m3.JoinType.Round)
    if core.is_empty or shapely.get_num_geometries(core) != 1:
        return False
    rim = shapely.points(shapely.get_coordinates(shapely.segmentize(area, _STEP)))
    shapely.prepare(core)
    if shapely.distance(rim, core).max() > 0.5 * CORNER * wall + 4.0 * GRID:
        return False
    return not lost_fins(area, wall)


def lost_fins(area: shapely.Polygon, wall: float) -> list[shapely.Polygon]:
    """What is lost of fins narrower than `wall`, mm; corners, which a bead rounds, are none."""
    # Of a ring just as wide as the wall, no corner would be left to grow from.
    whole, half = _section(area), 0.5 * _NARROWER * wall
    joins = m3.JoinType.Round, m3.JoinType.Miter
    printed, sharp = (_moved(_moved(whole, -half, join), half, join) for join in joins)
    kept = printed + sharp
    # Arcs are polygons, and offsets are rounded: what is as thin as that is nothing.
    lost = areas_of(whole - _moved(kept, _ROUNDING * wall, m3.JoinType.Miter))
    near = areas_of(kept)
    return [
        part
        for part in shapely.get_parts(lost)
        if shapely.distance(shapely.points(shapely.get_coordinates(part)), near).max() > FIN * wall
    ]


def smallest_wall(areas: list[shapely.Polygon], start: float) -> float:
    """The width, mm, at which the first of some polygons stops being printable; nan without any.

    Parameters
    ----------
    start : mm, where the search begins: upward if all can be printed with this wall.
    """
    if not areas:
        return float("nan")
    low, high = 0.0, start
    left = [area for area in areas if not is_printable(area, high)]
    while not left:
        low, high = high, _WIDER * high
        left = [area for area in areas if not is_printable(area, high)]
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        if all(is_printable(area, middle) for area in left):
            low = middle
        else:
            high = middle
    return low


def without_thin_parts(area: shapely.Polygon, wall: float) -> shapely.Polygon | None:
    """The largest part of a polygon that can be printed with walls of `wall` mm; None if none can.

    A polygon that can be printed comes back as it is.
    """
    if is_printable(area, wall):
        return area
    for part in _by_size(on_grid(opened(area, wall, wall))):
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

"""Scale outlines: tile polygons clipped by half the gap, at constant width, with mitred corners."""

from __future__ import annotations

import numpy as np
import shapely

from flexscale.errors import PatternError
from flexscale.patterns.cell import polygon_area, turning_angles
from flexscale.patterns.symmetry import FloatArray

MITRE_LIMIT = 20.0  # longest mitre over half the gap; sharper tips (below 6°) are cut off


def scale_outline(polygon: FloatArray, gap: float, number: int) -> FloatArray:
    """Outline (m, 2) of the scale on a tile, counterclockwise, without corners on straight lines.

    Parameters
    ----------
    polygon : (n, 2) corners of the tile, mm.
    gap : mm, whole distance between neighboring scales.
    number : of the tile, for messages.

    Raises
    ------
    PatternError : the scale vanishes or falls apart.
    """
    shape = _inset(polygon, gap)
    if shape.is_empty or shape.geom_type != "Polygon":
        what = "vanishes" if shape.is_empty else f"falls apart into {len(shape.geoms)} pieces"
        raise PatternError(
            f"A gap of {gap:g} mm is too wide for tile {number} "
            f"({polygon_area(polygon):.4g} mm²): its scale {what}. "
            f"Use a gap below {_widest_gap(polygon, gap):.3g} mm."
        )
    return _without_straight_corners(np.array(shapely.orient_polygons(shape).exterior.coords)[:-1])


def mitre_points(polygon: FloatArray, inset: float) -> FloatArray | None:
    """Inset corners (n, 2), one for each of the polygon's, or None if the inset has other corners.

    Parameters
    ----------
    polygon : (n, 2) counterclockwise corners, mm.
    inset : distance between an edge and its inset image, mm.
    """
    turns = turning_angles(polygon)
    forward = np.roll(polygon, -1, axis=0) - polygon
    tangents = forward / np.linalg.norm(forward, axis=1)[:, None]
    normals = np.stack([-tangents[:, 1], tangents[:, 0]], axis=1)
    bisectors = normals + np.roll(normals, 1, axis=0)
    squared = np.sum(bisectors**2, axis=1)
    if (np.abs(turns) > np.pi - 1e-6).any():
        return None
    points = polygon + inset * 2.0 * bisectors / squared[:, None]
    shape = shapely.Polygon(points)
    lengths = np.sum((np.roll(points, -1, axis=0) - points) * tangents, axis=1)
    if (lengths <= 1e-3 * inset).any() or not shape.is_valid:
        return None
    clipped = _inset(polygon, 2.0 * inset)
    same = shapely.symmetric_difference(shape, clipped).area < 1e-9 * shape.area
    return points if same else None


def _inset(polygon: FloatArray, gap: float) -> shapely.Geometry:
    return shapely.buffer(
        shapely.Polygon(polygon), -0.5 * gap, join_style="mitre", mitre_limit=MITRE_LIMIT
    )


def _widest_gap(polygon: FloatArray, too_wide: float) -> float:
    """Bisection for the gap at which the scale stops being one piece, mm."""
    low, high = 0.0, too_wide
    for _ in range(30):
        middle = 0.5 * (low + high)
        shape = _inset(polygon, middle)
        whole = not shape.is_empty and shape.geom_type == "Polygon"
        low, high = (middle, high) if whole else (low, middle)
    return low


def _without_straight_corners(outline: FloatArray) -> FloatArray:
    return outline[np.abs(turning_angles(outline)) > 1e-5]

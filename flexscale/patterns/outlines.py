"""Scale outlines: tile polygons clipped by half the gap, at constant width, with mitred corners.

What is clipped is a strip of this width along every edge, and at corners where the tile is concave
the kite between the ends of two strips. (A buffer as geometry libraries make it simplifies the
polygon first, from its first corner on: not far, but congruent tiles and both sides of a mirror
would get outlines that differ.)
"""

from __future__ import annotations

from collections.abc import Sequence
from decimal import ROUND_FLOOR, Decimal
from functools import cache

import numpy as np
import shapely

from flexscale.arrays import BoolArray, FloatArray, IntArray
from flexscale.errors import PatternError
from flexscale.patterns.cell import polygon_area
from flexscale.patterns.junctions import turning_angles
from flexscale.patterns.overlay import difference, symmetric_difference, union

MITRE_LIMIT = 20.0  # longest mitre over half the gap; sharper notches (below 6°) are cut off
ROUNDING = 1e-9  # of the inset: corners closer than this are one
SHORTEST = 0.05  # of the inset: edges that it leaves shorter are lost


def scale_outlines(
    polygons: Sequence[FloatArray], numbers: Sequence[int], gaps: Sequence[float]
) -> list[FloatArray]:
    """Outlines (m, 2) of the scales on tiles, counterclockwise, no corners on straight lines.

    Parameters
    ----------
    polygons : corners (n_i, 2) of one tile of each shape that the pattern has, mm.
    numbers : of these tiles.
    gaps : mm, of their scales, each of which ends half of its own within the tile.

    Raises
    ------
    PatternError : a scale vanishes or falls apart.
    """
    outlines = []
    for polygon, number, gap in zip(polygons, numbers, gaps, strict=True):
        corners = inset_corners(polygon, 0.5 * gap)
        if corners is None:
            n_pieces = shapely.get_num_geometries(_inset(polygon, 0.5 * gap))
            # What holds for all tiles of one gap is told at once.
            alike = [tile for tile, own in zip(polygons, gaps, strict=True) if own == gap]
            what = "vanishes" if n_pieces < 2 else f"falls apart into {n_pieces} pieces"
            raise PatternError(
                f"A gap of {gap:g} mm is too wide for tile {number} "
                f"({polygon_area(polygon):.4g} mm²): its scale {what}. "
                f"Use a gap of {_widest_gap(alike, gap):g} mm at most."
            )
        outlines.append(corners)
    return outlines


def inset_corners(polygon: FloatArray, inset: float) -> FloatArray | None:
    """Corners (m, 2) of the inset of a polygon (n, 2), mm, or None if it is not in one piece.

    Runs of edges that are no longer than `SHORTEST` times the inset are one corner; there are none
    on straight lines.
    """
    corners, _ = _all_corners(polygon, inset)
    if corners is None:
        return None
    left = _without_straight_corners(merge_runs(corners, SHORTEST * inset)[0])
    return left if len(left) >= 3 else None  # of a strip too narrow, both short ends are corners


def inset_edges(polygon: FloatArray, inset: float) -> FloatArray | None:
    """Images of a polygon's edges in its inset, or None if this is not in one piece.

    Parameters
    ----------
    polygon : (n, 2) counterclockwise corners, mm.
    inset : distance between an edge and its image, mm. Edges with an image shorter than `SHORTEST`
        times this are lost.

    Returns
    -------
    (n, 2, 2) start and end of each image, mm; of a lost edge, both are the corner between the
    images around it.
    """
    corners, mitred = _all_corners(polygon, inset)
    if corners is None:
        return None
    merged, run = merge_runs(corners, SHORTEST * inset)
    if len(merged) < 3:
        return None
    kept = run != np.roll(run, -1)
    sources = (np.arange(len(polygon)) if mitred else _sources(polygon, inset, corners))[kept]
    in_order = np.roll(sources, -int(sources.argmin()))
    if (np.diff(in_order) <= 0).any():
        return None
    images = np.empty((len(polygon), 2, 2))
    images[sources] = np.stack([merged[run], merged[np.roll(run, -1)]], axis=1)[kept]
    lost = np.setdiff1d(np.arange(len(polygon)), sources)
    before = in_order[np.searchsorted(in_order, lost) - 1]
    images[lost] = images[before, 1][:, None]
    return images


def mitre_points(polygon: FloatArray, inset: float) -> FloatArray | None:
    """Inset corners (n, 2), one for each of the polygon's, or None if the inset has other corners.

    Parameters
    ----------
    polygon : (n, 2) counterclockwise corners, mm.
    inset : distance between an edge and its inset image, mm.
    """
    corners, mitred = _all_corners(polygon, inset)
    return corners if mitred else None


def _all_corners(polygon: FloatArray, inset: float) -> tuple[FloatArray | None, bool]:
    """Corners (m, 2) of an inset in one piece, or None; whether they are the polygon's mitres."""
    points = _mitre_tips(polygon, inset)
    if points is not None and (turning_angles(polygon) >= 0.0).all():
        return points, True  # of a convex tile the inset is what all half-planes share
    clipped = _inset(polygon, inset)
    if points is not None:
        shape = shapely.Polygon(points)
        if symmetric_difference(shape, clipped).area < 1e-9 * shape.area:
            return points, True
    return _corners_left(clipped, inset), False


def _mitre_tips(polygon: FloatArray, inset: float) -> FloatArray | None:
    """Points (n, 2) where inset edges meet, if they are an outline with edges as the polygon's."""
    turns, tangents, normals = _frames(polygon)
    bisectors = normals + np.roll(normals, 1, axis=0)
    squared = np.sum(bisectors**2, axis=1)
    # The distance to a mitre's tip is the inset times 2 / |bisector|.
    if (squared < 1e-12).any() or (squared[turns < 0.0] < (2.0 / MITRE_LIMIT) ** 2).any():
        return None
    points: FloatArray = polygon + inset * 2.0 * bisectors / squared[:, None]
    lengths = np.sum((np.roll(points, -1, axis=0) - points) * tangents, axis=1)
    if (lengths <= SHORTEST * inset).any() or not shapely.Polygon(points).is_valid:
        return None
    return points


def merge_runs(corners: FloatArray, reach: float) -> tuple[FloatArray, IntArray]:
    """Corners (n, 2) joined by edges no longer than `reach`, mm, become their mean.

    Runs of such edges longer than twice the reach are no cluster but a fine curve, and stay.

    Returns
    -------
    Means (m, 2), and which of them each corner (n,) belongs to.
    """
    lengths = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1)
    short = lengths <= reach
    if short.any() and not short.all():
        run = _runs(short)
        short &= np.bincount(run, lengths * short)[run] <= 2.0 * reach
    if not short.any() or short.all():
        return corners, np.arange(len(corners))
    run = _runs(short)
    sums = np.stack([np.bincount(run, column) for column in corners.T], axis=1)
    return sums / np.bincount(run)[:, None], run


def _runs(short: BoolArray) -> IntArray:
    """Number (n,) of the run of each corner; edges k, from corner k on, join runs if short."""
    starts = np.roll(~short, 1)
    return (np.cumsum(starts) - 1) % np.count_nonzero(starts)


def _inset(polygon: FloatArray, inset: float) -> shapely.Geometry:
    """What is left of a polygon (n, 2) without the strips along its edges, mm."""
    turns, tangents, normals = _frames(polygon)
    starts, ends = polygon, np.roll(polygon, -1, axis=0)
    deep = inset * normals
    strips = shapely.polygons(np.stack([starts, ends, ends + deep, starts + deep], axis=1))
    concave = np.flatnonzero(turns < 0.0)
    before = concave - 1
    # How far the sides of a kite reach beyond the strips' ends.
    reach = inset * np.minimum(np.tan(-0.5 * turns[concave]), np.sqrt(MITRE_LIMIT**2 - 1.0))
    corners = polygon[concave]
    kites = shapely.multipoints(
        np.stack(
            [
                corners,
                corners + deep[concave],
                corners + deep[concave] - reach[:, None] * tangents[concave],
                corners + deep[before] + reach[:, None] * tangents[before],
                corners + deep[before],
            ],
            axis=1,
        )
    )
    # As hulls, kites are valid also where their two tips coincide but for rounding.
    removed = union(np.concatenate([strips, shapely.convex_hull(kites)]))
    left = shapely.get_parts(difference(shapely.Polygon(polygon), removed))
    return shapely.union_all(left[shapely.area(left) > 1e-9 * shapely.Polygon(polygon).area])


def _frames(polygon: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Turn (n,) at each corner, and tangent and inward normal (n, 2) of the edge after it."""
    forward = np.roll(polygon, -1, axis=0) - polygon
    tangents = forward / np.linalg.norm(forward, axis=1)[:, None]
    return turning_angles(polygon), tangents, np.stack([-tangents[:, 1], tangents[:, 0]], axis=1)


def _widest_gap(polygons: Sequence[FloatArray], too_wide: float) -> float:
    """Gap, mm, that leaves every tile a scale in one piece; three digits, rounded down."""

    @cache
    def is_whole(number: int, gap: float) -> bool:
        return inset_corners(polygons[number], 0.5 * gap) is not None

    widest = too_wide
    for number in range(len(polygons)):
        if is_whole(number, widest):
            continue
        low, high = 0.0, widest
        for _ in range(20):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if is_whole(number, middle) else (low, middle)
            if low > 0.0 and _three_digits(low) == _three_digits(high):
                break
        widest = low
    if widest == 0.0:
        return 0.0
    named = _three_digits(widest)
    # Scales may be whole at some gap, and not at a narrower one: what is named is tried.
    step = _last_of_three_digits(widest)
    while named > 0 and not all(is_whole(k, float(named)) for k in range(len(polygons))):
        named -= step
    return float(named)


def _three_digits(length: float) -> Decimal:
    """A length, mm, rounded down to three digits."""
    return Decimal(length).quantize(_last_of_three_digits(length), ROUND_FLOOR)


def _last_of_three_digits(length: float) -> Decimal:
    return Decimal(1).scaleb(Decimal(length).adjusted() - 2)


def _corners_left(shape: shapely.Geometry, inset: float) -> FloatArray | None:
    """Corners (m, 2) of what is left, counterclockwise, or None if it is not in one piece."""
    if shape.is_empty or shape.geom_type != "Polygon":
        return None
    corners = np.array(shapely.orient_polygons(shape).exterior.coords)[:-1]
    return _without_straight_corners(merge_runs(corners, ROUNDING * inset)[0])


def _sources(polygon: FloatArray, inset: float, corners: FloatArray) -> IntArray:
    """For each edge of the inset with corners (m, 2), the edge of the polygon it lies along."""
    _, tangents, normals = _frames(polygon)
    ends = np.stack([corners, np.roll(corners, -1, axis=0)])
    depths = np.sum(normals * polygon, axis=1)
    off = np.abs(ends @ normals.T - depths - inset).max(axis=0)
    # Of several edges on one line, the one that lies opposite the image's middle.
    middles = ends.mean(axis=0) @ tangents.T
    starts, finish = np.sum(tangents * polygon, axis=1), np.roll(polygon, -1, axis=0)
    half = 0.5 * (np.sum(tangents * finish, axis=1) - starts)
    aside = np.maximum(np.abs(middles - starts - half) - half, 0.0)
    return (off + np.where(off < 1e-6 * inset, 0.0, np.inf) + 1e-9 * aside).argmin(axis=1)


def _without_straight_corners(outline: FloatArray) -> FloatArray:
    return outline[np.abs(turning_angles(outline)) > 1e-5]

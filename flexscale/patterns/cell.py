"""From polygons and two lattice vectors to a checked tiling of the plane.

Corners that coincide modulo the lattice are made to coincide exactly, and corners of one tile on an
edge of another (T-junctions) are inserted there, so that every edge has one partner edge; corners
on a straight line between two tiles are dropped. Edges that pair up and areas that add up to the
cell's are together what "covers the plane" means: the map from the tiles to the torus is then a
covering of degree one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from flexscale.errors import PatternError
from flexscale.patterns.symmetry import BoolArray, FloatArray

IntArray = NDArray[np.int64]

RELATIVE_TOLERANCE = 1e-4  # of the root of the cell's area: corners closer than this are one
AREA_TOLERANCE = 1e-3  # relative: edges that pair up leave only whole multiples of the cell's area
IDLE_TURN = 2e-5  # radians: where two tiles meet, a corner that turns less is none
# Where two tiles meet, a smaller turn is a curve, not a corner; no turn that a regular polygon has.
SHARP_TURN = np.deg2rad(20.1)


@dataclass(frozen=True)
class TiledCell:
    """Tiles of one lattice class each, with every tiling vertex as a corner.

    Attributes
    ----------
    tiles : tuple of (n_i, 2) counterclockwise corners, mm.
    sharp : tuple of (n_i,) flags: three tiles or more meet at this corner, or it turns sharply.
    lattice : (2, 2) rows t1, t2, right-handed, mm.
    tolerance : mm, below it points are the same.
    """

    tiles: tuple[FloatArray, ...]
    sharp: tuple[BoolArray, ...]
    lattice: FloatArray
    tolerance: float


def build_cell(tiles: list[ArrayLike], t1: ArrayLike, t2: ArrayLike) -> TiledCell:
    """Check polygons and lattice vectors and put every tiling vertex into the polygons.

    Parameters
    ----------
    tiles : polygons (n_i, 2), mm, in either orientation, one per lattice class.
    t1, t2 : (2,) lattice vectors, mm.

    Raises
    ------
    PatternError : crossing, degenerate or overlapping polygons, or polygons with holes between.
    """
    lattice = _checked_lattice(t1, t2)
    if len(tiles) == 0:
        raise PatternError("A pattern needs at least one tile polygon, but none was given.")
    area = float(np.linalg.det(lattice))
    tolerance = RELATIVE_TOLERANCE * np.sqrt(area)
    polygons = [_checked_polygon(tile, number, tolerance) for number, tile in enumerate(tiles)]
    total = sum(polygon_area(polygon) for polygon in polygons)
    if abs(total - area) > AREA_TOLERANCE * area:
        remedy = "leave holes" if total < area else "overlap"
        raise PatternError(
            f"The tiles' areas add up to {total:.6g} mm², but the cell of t1 and t2 has "
            f"{area:.6g} mm²: the tiles {remedy}. Give one polygon per lattice class."
        )
    polygons = _merge_corners(polygons, lattice, tolerance)
    polygons = [_insert_junctions(p, polygons, lattice, 2.0 * tolerance) for p in polygons]
    polygons = _without_idle_corners(polygons, corner_classes(polygons, lattice, tolerance))
    classes = corner_classes(polygons, lattice, tolerance)
    _check_edge_partners(polygons, classes, lattice, tolerance)
    return TiledCell(tuple(polygons), tuple(_sharp_corners(polygons, classes)), lattice, tolerance)


def polygon_area(polygon: FloatArray) -> float:
    """Signed area of corners (n, 2): positive when counterclockwise, mm²."""
    x, y = polygon.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


def turning_angles(polygon: FloatArray) -> FloatArray:
    """Turn of the outline at every corner (n,), radians; positive to the left."""
    forward = np.roll(polygon, -1, axis=0) - polygon
    backward = np.roll(forward, 1, axis=0)
    cross = backward[:, 0] * forward[:, 1] - backward[:, 1] * forward[:, 0]
    return np.arctan2(cross, np.sum(backward * forward, axis=1))


def torus_classes(points: FloatArray, lattice: FloatArray, tolerance: float) -> IntArray:
    """Number of the lattice class of each point (n, 2); points closer than `tolerance` are one."""
    fractions = points @ np.linalg.inv(lattice)
    fractions -= np.floor(fractions)
    fractions[fractions >= 1.0] = 0.0
    # A distance in fractions is at most the distance in mm over the least singular value.
    reach = tolerance / np.linalg.svd(lattice, compute_uv=False)[-1]
    pairs = cKDTree(fractions, boxsize=1.0).query_pairs(reach, output_type="ndarray")
    graph = coo_array((np.ones(len(pairs)), pairs.T), shape=(len(points), len(points)))
    return connected_components(graph, directed=False)[1].astype(np.int64)


def corner_classes(
    polygons: list[FloatArray], lattice: FloatArray, tolerance: float
) -> list[IntArray]:
    """Lattice class (n_i,) of every corner of every polygon."""
    labels = torus_classes(np.concatenate(polygons), lattice, tolerance)
    return np.split(labels, np.cumsum([len(polygon) for polygon in polygons])[:-1])


def _checked_lattice(t1: ArrayLike, t2: ArrayLike) -> FloatArray:
    try:
        lattice = np.array([t1, t2], dtype=float)
    except (TypeError, ValueError):
        lattice = np.empty(0)
    if lattice.shape != (2, 2) or not np.isfinite(lattice).all():
        raise PatternError("The lattice vectors t1 and t2 must each be two finite numbers in mm.")
    area = np.linalg.det(lattice)
    if abs(area) <= 1e-9 * np.linalg.norm(lattice[0]) * np.linalg.norm(lattice[1]):
        raise PatternError(
            f"The lattice vectors t1 = {lattice[0].tolist()} and t2 = {lattice[1].tolist()} mm "
            "are parallel or zero: they must span a cell."
        )
    return lattice if area > 0.0 else lattice[::-1].copy()


def _checked_polygon(tile: ArrayLike, number: int, tolerance: float) -> FloatArray:
    try:
        polygon = np.array(tile, dtype=float)
    except (TypeError, ValueError):
        polygon = np.empty(0)
    if polygon.ndim != 2 or polygon.shape[1:] != (2,) or not np.isfinite(polygon).all():
        raise PatternError(f"Tile {number} must be a list of (x, y) corners, finite, in mm.")
    apart = np.linalg.norm(polygon - np.roll(polygon, 1, axis=0), axis=1) > tolerance
    polygon = polygon[apart]  # also drops a last corner that repeats the first
    if len(polygon) < 3:
        raise PatternError(f"Tile {number} has {len(polygon)} distinct corners: give at least 3.")
    shape = shapely.Polygon(polygon)
    if not shape.is_valid:
        raise PatternError(
            f"Tile {number} is not a simple polygon ({shapely.is_valid_reason(shape)} mm): "
            "its outline must not cross or touch itself."
        )
    area = polygon_area(polygon)
    if abs(area) <= tolerance * shape.length:
        raise PatternError(f"Tile {number} has no area: its corners lie on one line.")
    return polygon if area > 0.0 else polygon[::-1].copy()


def _merge_corners(
    polygons: list[FloatArray], lattice: FloatArray, tolerance: float
) -> list[FloatArray]:
    """Corners of one lattice class get positions that differ by lattice vectors to rounding."""
    corners = np.concatenate(polygons)
    labels = torus_classes(corners, lattice, tolerance)
    _, first = np.unique(labels, return_index=True)
    anchors = corners[first[labels]]
    shifts = np.rint((corners - anchors) @ np.linalg.inv(lattice)) @ lattice
    residuals = corners - anchors - shifts
    counts = np.bincount(labels)
    mean = np.stack([np.bincount(labels, residuals[:, k]) / counts for k in (0, 1)], axis=1)
    merged = anchors + mean[labels] + shifts
    return np.split(merged, np.cumsum([len(polygon) for polygon in polygons])[:-1])


def _insert_junctions(
    polygon: FloatArray, polygons: list[FloatArray], lattice: FloatArray, tolerance: float
) -> FloatArray:
    """Put lattice images of all corners that lie inside an edge into that edge."""
    images = _images_near(np.concatenate(polygons), polygon, lattice)
    pieces = []
    for start, end in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        length = np.linalg.norm(end - start)
        tangent = (end - start) / length
        along = (images - start) @ tangent
        across = (images - start) @ np.array([-tangent[1], tangent[0]])
        on_edge = (np.abs(across) < tolerance) & (along > tolerance) & (along < length - tolerance)
        order = np.argsort(along[on_edge], kind="stable")
        found = images[on_edge][order]
        distinct = np.diff(along[on_edge][order], prepend=-np.inf) > tolerance
        pieces.append(np.vstack([start[None], found[distinct]]))
    return np.vstack(pieces)


def _without_idle_corners(polygons: list[FloatArray], classes: list[IntArray]) -> list[FloatArray]:
    """Drop corners that turn nowhere and where two tiles meet: they say nothing of the shape."""
    every = np.concatenate(classes)
    turns = np.abs(np.concatenate([turning_angles(polygon) for polygon in polygons]))
    largest = np.zeros(every.max() + 1)
    np.maximum.at(largest, every, turns)
    idle = (largest < IDLE_TURN) & (np.bincount(every) == 2)
    return [polygon[~idle[labels]] for polygon, labels in zip(polygons, classes, strict=True)]


def _images_near(points: FloatArray, polygon: FloatArray, lattice: FloatArray) -> FloatArray:
    """Lattice images of points (n, 2) in (a little more than) the polygon's bounding box."""
    inverse = np.linalg.inv(lattice)
    low, high = polygon.min(axis=0), polygon.max(axis=0)
    box = np.array([low, (low[0], high[1]), (high[0], low[1]), high]) @ inverse
    fractions = points @ inverse
    first = np.floor(box.min(axis=0) - fractions.max(axis=0)).astype(int)
    last = np.ceil(box.max(axis=0) - fractions.min(axis=0)).astype(int)
    grid = np.mgrid[first[0] : last[0] + 1, first[1] : last[1] + 1].reshape(2, -1).T
    return (points[None] + (grid @ lattice)[:, None]).reshape(-1, 2)


def _check_edge_partners(
    polygons: list[FloatArray], classes: list[IntArray], lattice: FloatArray, tolerance: float
) -> None:
    """Every edge must be some edge, turned around, of exactly one tile."""
    seen: dict[tuple[int, int, int, int], list[tuple[int, FloatArray]]] = {}
    anchors = {}
    for polygon, labels in zip(polygons, classes, strict=True):
        anchors.update({int(label): corner for label, corner in zip(labels, polygon, strict=True)})
    inverse = np.linalg.inv(lattice)
    wanted = []
    for number, (polygon, labels) in enumerate(zip(polygons, classes, strict=True)):
        offsets = np.rint(
            (polygon - np.array([anchors[int(label)] for label in labels])) @ inverse
        ).astype(int)
        for k in range(len(polygon)):
            m = (k + 1) % len(polygon)
            shift = offsets[m] - offsets[k]
            seen.setdefault((labels[k], labels[m], *shift), []).append((number, polygon[k]))
            wanted.append((number, polygon[k], polygon[m], (labels[m], labels[k], *(-shift))))
    for number, start, end, key in wanted:
        if len(seen.get(key, [])) != 1:
            raise PatternError(
                f"The tiles do not cover the plane: the edge of tile {number} from "
                f"({start[0]:.4g}, {start[1]:.4g}) to ({end[0]:.4g}, {end[1]:.4g}) mm does not "
                "meet exactly one tile on its other side. Mend the overlap or hole there; corners "
                f"must agree to {tolerance:.1g} mm."
            )


def _sharp_corners(polygons: list[FloatArray], classes: list[IntArray]) -> list[BoolArray]:
    n_meeting = np.bincount(np.concatenate(classes))
    return [
        (n_meeting[labels] >= 3) | (np.abs(turning_angles(polygon)) > SHARP_TURN)
        for polygon, labels in zip(polygons, classes, strict=True)
    ]

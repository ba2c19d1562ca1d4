"""From polygons and two lattice vectors to a checked tiling of the plane.

Corners that coincide modulo the lattice are made to coincide exactly, and corners of one tile on an
edge of another (T-junctions) are inserted there, so that every edge has one partner edge; corners
on a straight line between two tiles are dropped. Edges that pair up and areas that add up to the
cell's are together what "covers the plane" means: the map from the tiles to the torus is then a
covering of degree one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from flexscale.arrays import BoolArray, FloatArray, IntArray
from flexscale.errors import PatternError
from flexscale.patterns.corners import (
    ROUNDING,
    corner_classes,
    merge_corners,
    numbered,
    split_like,
    successors,
)
from flexscale.patterns.drawing import FINEST, tile_size
from flexscale.patterns.junctions import insert_junctions, turns_of_tiles, without_idle_corners

AREA_TOLERANCE = 1e-3  # relative: edges that pair up leave only whole multiples of the cell's area
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
    size : mm, root of a tile's mean area.
    tolerance : mm, below it corners of different tiles are the same.
    """

    tiles: tuple[FloatArray, ...]
    sharp: tuple[BoolArray, ...]
    lattice: FloatArray
    size: float
    tolerance: float


def build_cell(
    tiles: Sequence[FloatArray], lattice: FloatArray, tolerance: float | None = None
) -> TiledCell:
    """Check polygons and lattice and put every tiling vertex into the polygons.

    Parameters
    ----------
    tiles : polygons (n_i, 2), mm, in either orientation, one per lattice class, near the origin.
    lattice : (2, 2) rows t1, t2, mm, exchanged if left-handed.
    tolerance : mm, below it corners of different tiles are the same; rounding if not given.

    Raises
    ------
    PatternError : crossing, degenerate or overlapping polygons, or polygons with holes between.
    """
    if np.linalg.det(lattice) < 0.0:
        lattice = lattice[::-1].copy()
    size, area = tile_size(lattice, len(tiles)), float(np.linalg.det(lattice))
    tolerance = FINEST * size if tolerance is None else tolerance
    polygons = _checked_polygons(tiles, size)
    total = float(_areas(polygons).sum())
    if abs(total - area) > AREA_TOLERANCE * area:
        remedy = "leave holes" if total < area else "overlap"
        raise PatternError(
            f"The tiles' areas add up to {total:.6g} mm², but the cell of t1 and t2 has "
            f"{area:.6g} mm²: the tiles {remedy}. Give one polygon per lattice class."
        )
    polygons = merge_corners(polygons, lattice, tolerance)
    polygons = insert_junctions(polygons, lattice, 2.0 * tolerance, size)
    classes = corner_classes(polygons, lattice, ROUNDING * size)
    polygons = without_idle_corners(polygons, classes, tolerance)
    classes = corner_classes(polygons, lattice, ROUNDING * size)
    _check_edge_partners(polygons, classes, lattice, tolerance)
    sharp = sharp_corners(polygons, classes)
    return TiledCell(tuple(polygons), tuple(sharp), lattice, size, tolerance)


def polygon_area(polygon: FloatArray) -> float:
    """Signed area of corners (n, 2): positive when counterclockwise, mm²."""
    # About a corner: about an origin far away, products that cancel would take the digits.
    x, y = (polygon - polygon[0]).T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


def _areas(polygons: Sequence[FloatArray]) -> FloatArray:
    """Signed areas (n_tiles,), mm², of polygons without empty ones."""
    tile, start = numbered(polygons)
    corners = np.concatenate(polygons)
    x, y = (corners - corners[start][tile]).T
    end = successors(polygons)
    areas: FloatArray = 0.5 * np.add.reduceat(x * y[end] - y * x[end], start)
    return areas


def _checked_polygons(tiles: Sequence[FloatArray], size: float) -> list[FloatArray]:
    """Counterclockwise polygons of tiles: those that are fine at once, the others one by one."""
    corners, (tile, start) = np.concatenate(tiles), numbered(tiles)
    lengths = np.linalg.norm(corners[successors(tiles)] - corners, axis=1)
    fine = np.minimum.reduceat(lengths, start) > FINEST * size
    fine &= np.bincount(tile) >= 3
    areas = _areas(tiles)
    fine &= np.abs(areas) > FINEST * size * np.add.reduceat(lengths, start)
    inside = fine[tile]
    which = (np.cumsum(fine) - 1)[tile[inside]]
    fine[fine] = shapely.is_valid(
        shapely.polygons(shapely.linearrings(corners[inside], indices=which))
    )
    return [
        (polygon if area > 0.0 else polygon[::-1].copy())
        if is_fine
        else _checked_polygon(polygon, number, size)
        for number, (polygon, area, is_fine) in enumerate(
            zip(tiles, areas.tolist(), fine.tolist(), strict=True)
        )
    ]


def _checked_polygon(tile: FloatArray, number: int, size: float) -> FloatArray:
    polygon = _without_repeated(tile, FINEST * size)
    if len(polygon) < 3:
        raise PatternError(
            f"Tile {number} has {len(polygon)} distinct corners: give at least 3, more than "
            f"{FINEST * size:.1g} mm apart."
        )
    shape = shapely.Polygon(polygon)
    if not shape.is_valid:
        raise PatternError(
            f"Tile {number} is not a simple polygon ({shapely.is_valid_reason(shape)} mm from the "
            "first corner of tile 0): its outline must not cross or touch itself."
        )
    area = polygon_area(polygon)
    if abs(area) <= FINEST * size * shape.length:
        raise PatternError(f"Tile {number} has no area: its corners lie on one line.")
    return polygon if area > 0.0 else polygon[::-1].copy()


def _without_repeated(polygon: FloatArray, tolerance: float) -> FloatArray:
    """Corners farther than a tolerance [mm] from the last one kept, and the last from the first."""
    if (np.linalg.norm(polygon - np.roll(polygon, 1, axis=0), axis=1) > tolerance).all():
        return polygon
    kept = [polygon[0]]
    for corner in polygon[1:]:
        if np.hypot(*(corner - kept[-1])) > tolerance:
            kept.append(corner)
    while len(kept) > 1 and np.hypot(*(kept[-1] - kept[0])) <= tolerance:
        kept.pop()
    return np.array(kept)


def _check_edge_partners(
    polygons: list[FloatArray], classes: list[IntArray], lattice: FloatArray, tolerance: float
) -> None:
    """Every edge must be some edge, turned around, of exactly one tile."""
    here, corners, end = np.concatenate(classes), np.concatenate(polygons), successors(polygons)
    first = np.unique(here, return_index=True)[1]
    places = np.rint((corners - corners[first[here]]) @ np.linalg.inv(lattice)).astype(np.int64)
    steps, there = places[end] - places, here[end]
    edges = np.sort(_edge_names(here, there, steps))
    sought = _edge_names(there, here, -steps)
    found = np.searchsorted(edges, sought, "right") - np.searchsorted(edges, sought, "left")
    if (found == 1).all():
        return
    wrong = int((found != 1).argmax())
    start, stop = corners[wrong], corners[end[wrong]]
    raise PatternError(
        f"The tiles do not cover the plane: the edge of tile {numbered(polygons)[0][wrong]} from "
        f"({start[0]:.6g}, {start[1]:.6g}) to ({stop[0]:.6g}, {stop[1]:.6g}) mm from the "
        "first corner of tile 0 does not meet exactly one tile on its other side. Mend "
        f"the overlap or hole there; corners must agree to {tolerance:.1g} mm, some units "
        "of the last decimal given."
    )


def _edge_names(here: IntArray, there: IntArray, steps: IntArray) -> IntArray:
    """One number (n,) for each edge, by the classes of its ends and the steps (n, 2) between."""
    most = np.abs(steps).max() + 1
    names: IntArray = here * (here.max() + 1) + there
    for column in steps.T:
        names = names * (2 * most) + column + most
    return names


def sharp_corners(polygons: Sequence[FloatArray], classes: list[IntArray]) -> list[BoolArray]:
    """Flags (n_i,) of corners where three tiles or more meet, or that turn sharply."""
    every = np.concatenate(classes)
    sharp = (np.bincount(every)[every] >= 3) | (np.abs(turns_of_tiles(polygons)) > SHARP_TURN)
    return split_like(sharp, list(polygons))

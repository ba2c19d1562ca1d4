"""T-junctions: corners of tiles on edges of others become corners of both; idle corners none."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np
import shapely

from flexscale.arrays import BoolArray, FloatArray, IntArray
from flexscale.patterns.corners import ROUNDING, Image, corner_classes, numbered, successors
from flexscale.tilings.lattice import reduction

IDLE_TURN = 2e-5  # radians: where two tiles meet, a corner that turns less is none


def turning_angles(polygon: FloatArray) -> FloatArray:
    """Turn of the outline at every corner (n,), radians; positive to the left."""
    forward = np.roll(polygon, -1, axis=0) - polygon
    backward = np.roll(forward, 1, axis=0)
    cross = backward[:, 0] * forward[:, 1] - backward[:, 1] * forward[:, 0]
    return np.arctan2(cross, np.sum(backward * forward, axis=1))


def turns_of_tiles(polygons: Sequence[FloatArray]) -> FloatArray:
    """Turns of all outlines at all corners (n,), one tile after the other, radians."""
    corners, end = np.concatenate(polygons), successors(polygons)
    forward = corners[end] - corners
    backward = np.empty_like(forward)
    backward[end] = forward
    cross = backward[:, 0] * forward[:, 1] - backward[:, 1] * forward[:, 0]
    return np.arctan2(cross, np.sum(backward * forward, axis=1))


def insert_junctions(
    polygons: list[FloatArray], lattice: FloatArray, tolerance: float, size: float
) -> list[FloatArray]:
    """Put corners of other tiles that lie on an edge into that edge.

    A point becomes a corner of a tile once, on an edge along which its own edges lead to both
    sides: near an acute corner it may lie within the tolerance of another one.

    Parameters
    ----------
    polygons : (n_i, 2) with corners of one class at positions that differ by lattice vectors.
    tolerance : mm, how far a corner may lie off an edge.
    size : mm, of a tile.
    """
    # Cells of long thin vectors would reach over many times the tiles.
    lattice = reduction(lattice) @ lattice
    corners = np.concatenate(polygons)
    classes = np.concatenate(corner_classes(polygons, lattice, ROUNDING * size))
    _, first = np.unique(classes, return_index=True)
    tile, start = numbered(polygons)
    end = successors(polygons)
    home = np.floor(corners @ np.linalg.inv(lattice)) @ lattice
    segments = np.stack([corners - home, corners[end] - home], axis=1)
    points, known, steps = _images(corners[first], lattice, segments.reshape(-1, 2), tolerance)
    edges, found = shapely.STRtree(shapely.points(points)).query(
        shapely.linestrings(segments), predicate="dwithin", distance=tolerance
    )
    offsets = np.rint((corners - corners[first[classes]]) @ np.linalg.inv(lattice)).astype(int)
    shifts = np.rint(home @ np.linalg.inv(lattice)).astype(int)
    own = set(_images_of(tile, classes, offsets))
    # Edges that a point of the tiling may be put into, by tile and image of the point.
    places: dict[tuple[int, Image], list[tuple[int, int]]] = defaultdict(list)
    keys = _images_of(tile[edges], known[found], steps[found] + shifts[edges])
    for key, edge, point in zip(keys, edges.tolist(), found.tolist(), strict=True):
        if key not in own:
            places[key].append((edge, point))
    leaving = _edges_at(classes, corners, end) if places else {}
    inserted: dict[int, list[FloatArray]] = defaultdict(list)
    for (_, (label, _, _)), choices in places.items():
        for edge, point in choices:
            place = points[point] + home[edge]
            if _leads(corners[edge], corners[end[edge]], place, leaving[label], tolerance):
                inserted[edge].append(place)
                break
    grown = []
    for polygon, first_edge in zip(polygons, start, strict=True):
        edges_here = range(first_edge, first_edge + len(polygon))
        if any(edge in inserted for edge in edges_here):
            parts = [
                _edge_with(corners, end, edge, inserted[edge])
                if edge in inserted
                else corners[edge : edge + 1]
                for edge in edges_here
            ]
            polygon = np.concatenate(parts)
        grown.append(polygon)
    return grown


def _images(
    points: FloatArray, lattice: FloatArray, wanted: FloatArray, margin: float
) -> tuple[FloatArray, IntArray, IntArray]:
    """Lattice images of points (n, 2) in the bounding box of others, mm.

    Returns
    -------
    Images (m, 2), the number (m,) of the point of each, and the lattice vector (m, 2) between.
    """
    inverse = np.linalg.inv(lattice)
    low, high = wanted.min(axis=0) - margin, wanted.max(axis=0) + margin
    box = np.array([low, (low[0], high[1]), (high[0], low[1]), high]) @ inverse
    fractions = points @ inverse
    first = np.floor(box.min(axis=0) - fractions.max(axis=0)).astype(int)
    last = np.ceil(box.max(axis=0) - fractions.min(axis=0)).astype(int)
    grid = np.mgrid[first[0] : last[0] + 1, first[1] : last[1] + 1].reshape(2, -1).T
    images = (points[None] + (grid @ lattice)[:, None]).reshape(-1, 2)
    inside = ((images >= low) & (images <= high)).all(axis=1)
    number = np.tile(np.arange(len(points)), len(grid))
    return images[inside], number[inside], np.repeat(grid, len(points), axis=0)[inside]


def _images_of(tiles: IntArray, classes: IntArray, offsets: IntArray) -> list[tuple[int, Image]]:
    """(tile, (class, m, n)) of corners: hashable names of points of the plane, as a tile's."""
    return [
        (tile, (label, m, n))
        for tile, label, (m, n) in zip(
            tiles.tolist(), classes.tolist(), offsets.tolist(), strict=True
        )
    ]


def _edges_at(classes: IntArray, corners: FloatArray, end: IntArray) -> dict[int, FloatArray]:
    """Vectors (n, 2) of all edges that lead away from the corners of each class, mm."""
    at: dict[int, list[FloatArray]] = defaultdict(list)
    for here, there, vector in zip(
        classes.tolist(), classes[end].tolist(), corners[end] - corners, strict=True
    ):
        at[here].append(vector)
        at[there].append(-vector)
    return {label: np.array(vectors) for label, vectors in at.items()}


def _leads(
    start: FloatArray, end: FloatArray, point: FloatArray, leaving: FloatArray, tolerance: float
) -> bool:
    """Whether a point lies on an edge: its own edges lead along it, both ways, while both last."""
    length = float(np.linalg.norm(end - start))
    if length == 0.0:
        return False
    along = (end - start) / length
    across = np.array([-along[1], along[0]])
    lengths = np.linalg.norm(leaving, axis=1)
    place = float((point - start) @ along)
    if not 0.0 < place < length:
        return False
    for forward, room in ((along, length - place), (-along, place)):
        walks = np.clip(room, 0.0, lengths)[:, None] * leaving / lengths[:, None]
        off = np.abs((point - start) @ across + walks @ across)
        if not ((leaving @ forward > 0.0) & (off <= tolerance)).any():
            return False
    return True


def _edge_with(
    corners: FloatArray, end: IntArray, edge: int, points: list[FloatArray]
) -> FloatArray:
    """Start of an edge and the points on it, in their order."""
    along = corners[end[edge]] - corners[edge]
    order = sorted(points, key=lambda point: float((point - corners[edge]) @ along))
    return np.vstack([corners[edge], *order])


def without_idle_corners(
    polygons: list[FloatArray], classes: list[IntArray], tolerance: float
) -> list[FloatArray]:
    """Drop corners that turn nowhere and where two tiles meet: they say nothing of the shape.

    Parameters
    ----------
    tolerance : mm; corners further from the straight line without them stay: a slight curve of
        many small turns is one.
    """
    every = np.concatenate(classes)
    turns = np.abs(turns_of_tiles(polygons))
    largest = np.zeros(every.max() + 1)
    np.maximum.at(largest, every, turns)
    idle = (largest < IDLE_TURN) & (np.bincount(every) == 2)
    if not idle.any():
        return polygons
    bends = np.zeros(len(idle), dtype=bool)
    for polygon, labels in zip(polygons, classes, strict=True):
        if idle[labels].any():
            bends[labels[_off_line(polygon, idle[labels]) > tolerance]] = True
    idle &= ~bends
    return [polygon[~idle[labels]] for polygon, labels in zip(polygons, classes, strict=True)]


def _off_line(polygon: FloatArray, idle: BoolArray) -> FloatArray:
    """Distance (n,) of each idle corner from the line between the other corners around it, mm."""
    apart = np.zeros(len(polygon))
    kept = np.flatnonzero(~idle)
    if len(kept) < 2:
        return np.where(idle, np.inf, apart)
    dropped = np.flatnonzero(idle)
    following = np.searchsorted(kept, dropped)
    start, end = polygon[kept[following - 1]], polygon[kept[following % len(kept)]]
    along, arms = end - start, polygon[dropped] - start
    cross = along[:, 0] * arms[:, 1] - along[:, 1] * arms[:, 0]
    apart[dropped] = np.abs(cross) / np.maximum(np.linalg.norm(along, axis=1), np.finfo(float).tiny)
    return apart

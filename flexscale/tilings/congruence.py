"""Which isometries carry the tiles of a cell onto tiles, modulo the lattice.

Tiles are compared as shapes: a corner on a straight edge, the corner that comes first and the
orientation do not matter. Two outlines are the same when one can be walked along the other: every
corner of the first lies on the second, in order, once around, and every corner of the second lies
on that edge of the first which passes it.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
import shapely
from scipy.spatial import cKDTree

from flexscale.arrays import FloatArray, IntArray

NEAR_CENTROID = 10.0  # tolerances: noise of centroids adds up along a cell
SAME_SHAPE = 1e-3  # tolerances: outlines this near are compared with others once for all
FEW = 8  # tiles, of whose images most isometries that keep no tiling leave one without a partner


class PlacedTiles:
    """Tiles of a cell by centroid and shape, modulo a lattice.

    Parameters
    ----------
    polygons : (n_i, 2) simple polygons in either orientation, one per lattice class.
    lattice : (2, 2) rows.
    tolerance : length below which outlines and centroids are the same.
    marks : one for each tile; tiles of different marks are not the same. None if there are none.

    Attributes
    ----------
    centroids : (n, 2) of the areas.
    areas : (n,), positive.
    """

    def __init__(
        self,
        polygons: Sequence[FloatArray],
        lattice: FloatArray,
        tolerance: float,
        marks: Sequence[float] | None = None,
    ) -> None:
        self.lattice = lattice
        self.tolerance = tolerance
        self._marks = list(marks) if marks is not None else [0.0] * len(polygons)
        measured = [_area_and_centroid(polygon) for polygon in polygons]
        self.areas = np.array([abs(area) for area, _ in measured])
        self.centroids = np.array([centroid for _, centroid in measured])
        self._shapes = [
            (polygon if area > 0.0 else polygon[::-1]) - centroid
            for polygon, (area, centroid) in zip(polygons, measured, strict=True)
        ]
        self._compared: dict[tuple[int, int, bytes], bool] = {}

    def on(
        self, lattice: FloatArray, tolerance: float, tiles: Sequence[int] | None = None
    ) -> PlacedTiles:
        """The tiles, or those of some numbers, modulo another lattice."""
        which = list(range(len(self)) if tiles is None else tiles)
        other = PlacedTiles((), lattice, tolerance)
        other.areas, other.centroids = self.areas[which], self.centroids[which]
        other._shapes = [self._shapes[tile] for tile in which]
        other._marks = [self._marks[tile] for tile in which]
        return other

    def __len__(self) -> int:
        return len(self._shapes)

    def are_kept(self, linear: FloatArray, translation: FloatArray) -> bool:
        """Whether x -> linear @ x + translation carries every tile onto a tile."""
        return len(self.may_be_kept(linear, translation[None])) > 0 and all(
            partners for partners in self.partners(linear, translation)
        )

    def may_be_kept(self, linear: FloatArray, translations: FloatArray) -> IntArray:
        """Numbers of those translations (n, 2) by which a few tiles are carried onto tiles."""
        left = np.arange(len(translations))
        for tile in self._rarest:
            near = self._near(self.centroids[tile] @ linear.T + translations[left])
            left = left[[self._is_among(tile, others, linear) for others in near]]
            if not len(left):
                break
        return left

    def partners(self, linear: FloatArray, translation: FloatArray) -> list[list[int]]:
        """For each tile the tiles that its image is, modulo the lattice (one or none).

        Where no tile has its centroid at that of an image, shapes are not looked at any more.
        """
        near = self._near(self.centroids @ linear.T + translation)
        if not all(near):
            return [[] for _ in near]
        found = []
        for tile, others in enumerate(near):
            found.append([other for other in others if self._same_shape(tile, other, linear)])
            if not found[-1]:
                break
        return found

    def copies(self, tile: int) -> list[int]:
        """All tiles that lattice vectors carry onto one of them, itself included."""
        (near,) = self._near(self.centroids[tile][None])
        return [other for other in near if self._same_shape(tile, other, np.eye(2))]

    def _near(self, points: FloatArray) -> list[list[int]]:
        """For each point (n, 2) the tiles with their centroids there, modulo the lattice."""
        reach = NEAR_CENTROID * self.tolerance
        found: list[list[int]] = [[] for _ in points]
        # A distance in fractions is at most the distance in mm over the least singular value.
        widest = reach / self._least_stretch
        near = self._tree.query_ball_point(_in_cell(points, self.lattice), widest)
        which = np.repeat(np.arange(len(points)), [len(others) for others in near])
        if not len(which):
            return found
        others = np.concatenate(near).astype(int)
        apart = points[which] - self.centroids[others]
        apart -= np.rint(apart @ np.linalg.inv(self.lattice)) @ self.lattice
        for close, point, other in zip(
            np.hypot(*apart.T) <= reach, which.tolist(), others.tolist(), strict=True
        ):
            if close:
                found[point].append(other)
        return [sorted(same) for same in found]

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(_in_cell(self.centroids, self.lattice), boxsize=1.0)

    @cached_property
    def _least_stretch(self) -> float:
        return float(np.linalg.svd(self.lattice, compute_uv=False)[-1])

    @cached_property
    def _area_between(self) -> list[float]:
        """By how much a tile of the same shape may be larger or smaller, for each tile."""
        tolerance = self.tolerance
        edges = (np.linalg.norm(np.diff(s, axis=0, append=s[:1]), axis=1) for s in self._shapes)
        return [2.0 * tolerance * (float(lengths.sum()) + 4.0 * tolerance) for lengths in edges]

    @cached_property
    def _rarest(self) -> list[int]:
        """A few tiles, of the shapes that the cell has fewest of."""
        kinds = np.array(self._kinds)
        return np.argsort(np.bincount(kinds)[kinds], kind="stable")[:FEW].tolist()

    @cached_property
    def _kinds(self) -> list[int]:
        """Number of each tile's shape; tiles that are copies moved by a vector have the same."""
        known: dict[bytes, int] = {}
        grid = SAME_SHAPE * self.tolerance
        keys = (np.rint(shape / grid).tobytes() for shape in self._shapes)
        return [known.setdefault(key, len(known)) for key in keys]

    def _is_among(self, tile: int, others: list[int], linear: FloatArray) -> bool:
        return any(self._same_shape(tile, other, linear) for other in others)

    def _same_shape(self, tile: int, other: int, linear: FloatArray) -> bool:
        if self._marks[tile] != self._marks[other]:
            return False
        if abs(self.areas[tile] - self.areas[other]) > self._area_between[tile]:
            return False
        key = (self._kinds[tile], self._kinds[other], linear.tobytes())
        if key not in self._compared:
            image = self._shapes[tile] @ linear.T
            if np.linalg.det(linear) < 0.0:
                image = image[::-1]
            self._compared[key] = same_outline(image, self._shapes[other], self.tolerance)
        return self._compared[key]


def _in_cell(points: FloatArray, lattice: FloatArray) -> FloatArray:
    """Points (n, 2) in fractions of a lattice, from 0 to less than 1."""
    fractions = points @ np.linalg.inv(lattice)
    fractions -= np.floor(fractions)
    fractions[fractions >= 1.0] = 0.0
    return fractions


def same_outline(first: FloatArray, second: FloatArray, tolerance: float) -> bool:
    """Whether two polygons are the same shape in the same place.

    Parameters
    ----------
    first, second : (n, 2) and (m, 2) corners of simple polygons, counterclockwise.
    tolerance : how far one outline may lie from the other.
    """
    starts, edges = second, np.roll(second, -1, axis=0) - second
    lengths = np.linalg.norm(edges, axis=1)
    ends = np.cumsum(lengths)
    perimeter = float(ends[-1])
    segments = shapely.linestrings(np.stack([starts, starts + edges], axis=1))
    points, nearest = shapely.STRtree(segments).query_nearest(
        shapely.points(first), max_distance=2.0 * tolerance, all_matches=False
    )
    if len(points) < len(first):
        return False
    distances, fractions = _to_segments(first, starts[nearest], edges[nearest])
    if distances.max() > tolerance:
        return False
    stations = (ends - lengths)[nearest] + fractions * lengths[nearest]
    steps = np.diff(stations, append=stations[0]) % perimeter
    # An edge of a closed outline is never longer than half of it: more is a step back. Rounding
    # makes tiny ones; after a longer one some corner is on no edge that passes it.
    steps[steps > 0.5 * perimeter] -= perimeter
    passed = np.maximum.accumulate(np.concatenate([[0.0], np.cumsum(steps)[:-1]]))
    corners = (ends - lengths - stations[0]) % perimeter
    edge = np.searchsorted(passed, corners, side="right") - 1
    following = np.roll(first, -1, axis=0) - first
    distances, _ = _to_segments(second, first[edge], following[edge])
    return bool(distances.max() <= tolerance)


def _to_segments(
    points: FloatArray, starts: FloatArray, edges: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Distance of points from segments, and where along them it is reached (0 to 1)."""
    arms = points - starts
    squared = np.maximum(np.sum(edges**2, axis=-1), np.finfo(float).tiny)
    fractions = np.clip(np.sum(arms * edges, axis=-1) / squared, 0.0, 1.0)
    return np.linalg.norm(arms - fractions[..., None] * edges, axis=-1), fractions


def _area_and_centroid(polygon: FloatArray) -> tuple[float, FloatArray]:
    """Signed area and centroid, about the first corner so that a far origin costs no digits."""
    arms = polygon - polygon[0]
    after = np.roll(arms, -1, axis=0)
    cross = arms[:, 0] * after[:, 1] - after[:, 0] * arms[:, 1]
    area = 0.5 * float(cross.sum())
    if area == 0.0:
        return area, polygon.mean(axis=0)
    return area, polygon[0] + (cross @ (arms + after)) / (6.0 * area)

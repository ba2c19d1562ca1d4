"""Which isometries carry the tiles of a cell onto tiles, modulo the lattice.

Tiles are compared as shapes: a corner on a straight edge, the corner that comes first and the
orientation do not matter. Two outlines are the same when one can be walked along the other: every
corner of the first lies on the second, in order, once around, and every corner of the second lies
on that edge of the first which passes it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexscale.tilings.bravais import FloatArray

NEAR_CENTROID = 10.0  # tolerances: noise of centroids adds up along a cell


class PlacedTiles:
    """Tiles of a cell by centroid and shape, modulo a lattice.

    Parameters
    ----------
    polygons : (n_i, 2) simple polygons in either orientation, one per lattice class.
    lattice : (2, 2) rows.
    tolerance : length below which outlines and centroids are the same.

    Attributes
    ----------
    centroids : (n, 2) of the areas.
    areas : (n,), positive.
    """

    def __init__(
        self, polygons: Sequence[FloatArray], lattice: FloatArray, tolerance: float
    ) -> None:
        self.lattice = lattice
        self.tolerance = tolerance
        measured = [_area_and_centroid(polygon) for polygon in polygons]
        self.areas = np.array([abs(area) for area, _ in measured])
        self.centroids = np.array([centroid for _, centroid in measured])
        self._shapes = [
            (polygon if area > 0.0 else polygon[::-1]) - centroid
            for polygon, (area, centroid) in zip(polygons, measured, strict=True)
        ]
        self._compared: dict[tuple[int, int, bytes], bool] = {}

    def __len__(self) -> int:
        return len(self._shapes)

    def are_kept(self, linear: FloatArray, translation: FloatArray) -> bool:
        """Whether x -> linear @ x + translation carries every tile onto a tile."""
        return all(partners for partners in self.partners(linear, translation))

    def partners(self, linear: FloatArray, translation: FloatArray) -> list[list[int]]:
        """For each tile the tiles that its image is, modulo the lattice (one or none).

        Where no tile has its centroid at that of an image, shapes are not looked at any more.
        """
        images = self.centroids @ linear.T + translation
        apart = images[:, None] - self.centroids[None]
        apart -= np.rint(apart @ np.linalg.inv(self.lattice)) @ self.lattice
        near = np.linalg.norm(apart, axis=2) <= NEAR_CENTROID * self.tolerance
        if not near.any(axis=1).all():
            return [[] for _ in near]
        found = []
        for tile, row in enumerate(near):
            same = (int(other) for other in np.flatnonzero(row))
            found.append([other for other in same if self._same_shape(tile, other, linear)])
            if not found[-1]:
                break
        return found

    def _same_shape(self, tile: int, other: int, linear: FloatArray) -> bool:
        key = (tile, other, linear.tobytes())
        if key not in self._compared:
            image = self._shapes[tile] @ linear.T
            if np.linalg.det(linear) < 0.0:
                image = image[::-1]
            self._compared[key] = same_outline(image, self._shapes[other], self.tolerance)
        return self._compared[key]


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
    distances, fractions = _to_segments(first[:, None], starts[None], edges[None])
    nearest = np.argmin(distances, axis=1)
    each = np.arange(len(first))
    if distances[each, nearest].max() > tolerance:
        return False
    stations = (ends - lengths)[nearest] + fractions[each, nearest] * lengths[nearest]
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

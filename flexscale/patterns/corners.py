"""Corners of tiles on the torus: which are one point of the tiling, and where it lies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from flexscale.arrays import FloatArray, IntArray
from flexscale.tilings.lattice import reduction

Image = tuple[int, int, int]  # a tile, and the lattice vector that it is moved by

ROUNDING = 1e-9  # of a tile's size: points closer than this are one but for rounding


class Neighbors(NamedTuple):
    """Pairs of points that lie near each other modulo a lattice.

    Attributes
    ----------
    first, second : (n,) numbers of points, first < second.
    steps : (n, 2) lattice vectors from the first to the second, but for the distance.
    distances : (n,) mm.
    """

    first: IntArray
    second: IntArray
    steps: IntArray
    distances: FloatArray


def torus_neighbors(points: FloatArray, lattice: FloatArray, reach: float) -> Neighbors:
    """All pairs of points (n, 2) closer than `reach` [mm] modulo a lattice, whatever its shape."""
    # In a reduced basis few pairs are near in fractions that are not near in mm.
    basis = reduction(lattice) @ lattice
    fractions = points @ np.linalg.inv(basis)
    fractions -= np.floor(fractions)
    fractions[fractions >= 1.0] = 0.0
    # A distance in fractions is at most the distance in mm over the least singular value.
    widest = reach / np.linalg.svd(basis, compute_uv=False)[-1]
    pairs = cKDTree(fractions, boxsize=1.0).query_pairs(widest, output_type="ndarray")
    first, second = pairs.astype(np.int64).T
    apart = points[second] - points[first]
    steps = np.rint(apart @ np.linalg.inv(basis)) @ basis
    distances = np.linalg.norm(apart - steps, axis=1)
    near = distances <= reach
    whole = np.rint(steps[near] @ np.linalg.inv(lattice)).astype(np.int64)
    return Neighbors(first[near], second[near], whole, distances[near])


def torus_classes(points: FloatArray, lattice: FloatArray, tolerance: float) -> IntArray:
    """Number of the lattice class of each point (n, 2); points closer than `tolerance` are one."""
    near = torus_neighbors(points, lattice, tolerance)
    n = len(points)
    graph = coo_array((np.ones(len(near.first)), (near.first, near.second)), shape=(n, n))
    return connected_components(graph, directed=False)[1].astype(np.int64)


def corner_classes(
    polygons: list[FloatArray], lattice: FloatArray, tolerance: float
) -> list[IntArray]:
    """Lattice class (n_i,) of every corner of every polygon."""
    labels = torus_classes(np.concatenate(polygons), lattice, tolerance)
    return split_like(labels, polygons)


def numbered(polygons: Sequence[FloatArray]) -> tuple[IntArray, list[int]]:
    """Tile (n,) of every corner, and the number of each tile's first corner."""
    counts = [len(polygon) for polygon in polygons]
    return np.repeat(np.arange(len(polygons)), counts), np.cumsum([0, *counts[:-1]]).tolist()


def successors(polygons: Sequence[FloatArray]) -> IntArray:
    """Number (n,) of the corner that follows each one around its tile."""
    _, start = numbered(polygons)
    end = np.arange(1, sum(map(len, polygons)) + 1)
    end[np.array([*start[1:], len(end)]) - 1] = start
    return end


def split_like(flat: NDArray, polygons: list[FloatArray]) -> list[NDArray]:
    """What belongs to all corners, one after the other, by polygons."""
    return np.split(flat, np.cumsum([len(polygon) for polygon in polygons])[:-1])


def merge_corners(
    polygons: list[FloatArray], lattice: FloatArray, tolerance: float
) -> list[FloatArray]:
    """Corners that lie within a tolerance [mm] get positions that differ by lattice vectors.

    Two corners of one tile stay two, however near: of corners of its neighbors, each takes the
    nearest.
    """
    corners = np.concatenate(polygons)
    labels = _matched(polygons, torus_neighbors(corners, lattice, tolerance))
    _, first, labels = np.unique(labels, return_index=True, return_inverse=True)
    anchors = corners[first[labels]]
    shifts = np.rint((corners - anchors) @ np.linalg.inv(lattice)) @ lattice
    residuals = corners - anchors - shifts
    counts = np.bincount(labels)
    mean = np.stack([np.bincount(labels, residuals[:, k]) / counts for k in (0, 1)], axis=1)
    merged = anchors + mean[labels] + shifts
    return split_like(merged, polygons)


def farthest_merged(
    polygons: Sequence[FloatArray], lattice: FloatArray, tolerance: float, limit: float
) -> float:
    """How far apart corners lie, in x or y, that `merge_corners` makes one, mm.

    0 if none of them lie farther apart than a limit [mm].
    """
    corners = np.concatenate(polygons)
    near = torus_neighbors(corners, lattice, tolerance)
    steps = near.steps @ lattice
    apart = np.abs(corners[near.second] - corners[near.first] - steps).max(axis=1, initial=0.0)
    if not (apart > limit).any():
        return 0.0
    merged = np.concatenate(merge_corners(list(polygons), lattice, tolerance))
    left = np.abs(merged[near.second] - merged[near.first] - steps).max(axis=1)
    found = apart[(apart > limit) & (left < 1e-3 * limit)]
    return float(found.max(initial=0.0))


def _matched(polygons: list[FloatArray], near: Neighbors) -> IntArray:
    """Class (n,) of every corner: pairs are joined, the nearest first, unless a tile forbids it."""
    owners, _ = numbered(polygons)
    root = list(range(len(owners)))
    members: dict[int, dict[Image, int]] = {
        corner: {(tile, 0, 0): corner} for corner, tile in enumerate(owners.tolist())
    }
    place = [(0, 0)] * len(owners)  # of a corner, from that of its root
    order = np.lexsort((near.second, near.first, near.distances))
    for first, second, (m, n) in zip(
        near.first[order].tolist(),
        near.second[order].tolist(),
        near.steps[order].tolist(),
        strict=True,
    ):
        one, other = root[first], root[second]
        if one == other:
            continue
        if len(members[one]) < len(members[other]):
            one, other, first, second, m, n = other, one, second, first, -m, -n
        # The place of the other root, from that of the one.
        x = place[first][0] + m - place[second][0]
        y = place[first][1] + n - place[second][1]
        moved = {(tile, a + x, b + y): corner for (tile, a, b), corner in members[other].items()}
        if members[one].keys() & moved.keys():
            continue
        for corner in members.pop(other).values():
            root[corner] = one
            place[corner] = (place[corner][0] + x, place[corner][1] + y)
        members[one] |= moved
    return np.array(root)

"""Overlap of neighboring rigid scales."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from flexscale.arrays import FloatArray, IntArray
from flexscale.short_repr import ShortRepr
from flexscale.synthesis.placement import Placement
from flexscale.synthesis.prisms import ConvexParts
from flexscale.synthesis.separation import World, place_parts, separations

TOUCHING = 1e-9  # mm: depths up to this are rounding


@dataclass(frozen=True, eq=False, repr=False)
class Overlap(ShortRepr):
    """What overlaps.

    The depth of a pair of scales is the largest over their convex parts of the smallest translation
    that parts two of these. For convex scales it is the penetration depth itself; for others a
    lower bound of it, and 0 just where the scales do not overlap.

    Attributes
    ----------
    deepest : mm, of all pairs; 0 without overlap.
    pairs : (n, 2) scales that overlap.
    depths : (n,) mm.
    """

    deepest: float
    pairs: IntArray
    depths: FloatArray


def measure_overlap(parts: ConvexParts, placement: Placement) -> Overlap:
    """Overlap of scales where they are."""
    world = place_parts(parts, placement)
    close = close_pairs(parts.owner, world, 0.0)
    distances = separations(world, close).distances
    return overlap_of(parts.owner[close], distances)


def overlap_of(scales: IntArray, distances: FloatArray) -> Overlap:
    """From scales (n, 2) and signed distances (n,) mm of pairs of their parts."""
    inside = distances < -TOUCHING
    if not inside.any():
        return Overlap(0.0, np.zeros((0, 2), dtype=np.int64), np.zeros(0))
    pairs, number = np.unique(np.sort(scales[inside], axis=1), axis=0, return_inverse=True)
    depths = np.zeros(len(pairs))
    np.maximum.at(depths, number.ravel(), -distances[inside])
    return Overlap(float(depths.max()), pairs, depths)


def close_pairs(owner: IntArray, world: World, reach: float) -> IntArray:
    """(n, 2) parts A < B of different scales that may be within `reach` mm of each other: spheres
    and boxes around them are."""
    vertices = world.vertices
    centers = 0.5 * (vertices.min(axis=1) + vertices.max(axis=1))
    radii = np.linalg.norm(vertices - centers[:, None], axis=2).max(axis=1)
    pairs = cKDTree(centers).query_pairs(2.0 * radii.max() + reach, output_type="ndarray")
    a, b = pairs.T
    apart = np.linalg.norm(centers[a] - centers[b], axis=1) - radii[a] - radii[b]
    low, high = vertices.min(axis=1) - 0.5 * reach, vertices.max(axis=1) + 0.5 * reach
    boxed = ((low[a] <= high[b]) & (low[b] <= high[a])).all(axis=1)
    near = (owner[a] != owner[b]) & (apart <= reach) & boxed
    kept = np.sort(pairs[near], axis=1).astype(np.int64)
    return np.asarray(kept[np.lexsort(kept.T[::-1])])

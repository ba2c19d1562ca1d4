"""Does a tiling cover the plane, and curves to draw on its edges."""

from __future__ import annotations

from itertools import product

import numpy as np
import shapely
from scipy.spatial import cKDTree

from flexscale.tilings import Family, Tiling

#: Kind of an edge class -> a curve without symmetry of its own; S and U: the first half.
FLAT_CURVES = {
    "J": [(0.0, 0.0), (0.3, 0.03), (0.6, -0.02), (1.0, 0.0)],
    "S": [(0.0, 0.0), (0.2, 0.03), (0.5, 0.0)],
    "U": [(0.0, 0.0), (0.2, -0.01), (0.3, 0.03), (0.5, 0.02)],
}


def flat_curves(family: Family) -> dict[str, list[tuple[float, float]]]:
    """A curve for every edge class that can have one, no two of one height."""
    kinds = family.curve_kinds()
    return {
        letter: [(x, (1.0 - 0.15 * number) * y) for x, y in FLAT_CURVES[kind]]
        for number, (letter, kind) in enumerate(kinds.items())
        if kind != "I"
    }


def assert_covers_plane(tiling: Tiling, tolerance: float = 1e-9) -> None:
    """Areas add up, every piece of outline is one other piece turned around, nothing overlaps."""
    areas = shapely.area(shapely.polygons(list(tiling.tiles)))
    assert np.allclose(areas, 1.0, rtol=0, atol=tolerance)
    assert abs(np.linalg.det(tiling.lattice) - areas.sum()) < tolerance
    assert_pieces_match(tiling, tolerance)
    assert_no_overlap(tiling)


def assert_pieces_match(tiling: Tiling, tolerance: float) -> None:
    """Each piece, from point to point, is met by exactly one piece modulo the lattice."""
    starts = np.concatenate(tiling.tiles)
    ends = np.concatenate([np.roll(tile, -1, axis=0) for tile in tiling.tiles])
    lengths = np.linalg.norm(ends - starts, axis=1)
    assert lengths.min() > 10.0 * tolerance
    # Points of the torus as points on two circles of circumference 1, beside the piece's vector.
    turns = 2.0 * np.pi * (0.5 * (starts + ends) @ np.linalg.inv(tiling.lattice))
    places = np.concatenate([np.cos(turns), np.sin(turns)], axis=1) / (2.0 * np.pi)
    forward = np.concatenate([places, ends - starts], axis=1)
    backward = np.concatenate([places, starts - ends], axis=1)
    met = cKDTree(forward).query_ball_point(backward, tolerance, return_length=True)
    assert np.array_equal(met, np.ones(len(starts)))


def assert_no_overlap(tiling: Tiling) -> None:
    """A tile, a millionth smaller all around, meets no other tile of the plane.

    Asked as a yes or no: overlays of tiles that touch along whole edges are not reliable.
    """
    shapes = shapely.polygons(list(tiling.tiles))
    size = np.ptp(np.concatenate(tiling.tiles), axis=0).max() + 1.0
    reach = int(np.ceil(size / np.linalg.svd(tiling.lattice, compute_uv=False)[-1]))
    offsets = np.array(list(product(range(-reach, reach + 1), repeat=2))) @ tiling.lattice
    around = np.concatenate([shapely.polygons(np.array(tiling.tiles) + o) for o in offsets])
    tree = shapely.STRtree(around)
    inner = shapely.buffer(shapes, -1e-6, join_style="mitre")
    met = tree.query(inner, predicate="intersects")
    itself = len(shapes) * (len(offsets) // 2) + np.arange(len(shapes))
    assert np.array_equal(met, [np.arange(len(shapes)), itself])
    touched = tree.query(shapes, predicate="dwithin", distance=1e-6)
    assert np.bincount(touched[0]).min() >= 4  # itself and three neighbors

"""Polygons and lattice vectors as callers give them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.errors import PatternError, UnitRangeError, shown
from flexscale.units import require_array, require_series

LONGEST = 1e9  # mm, of a lattice vector: floats then hold 1e-7 mm
MOST_CORNERS = 100_000  # of a tile


def polygons(value: Any, label: str) -> list[FloatArray]:
    """Check of tiles: polygons as arrays (n_i, 2), mm."""
    listed = isinstance(value, Sequence) or (isinstance(value, np.ndarray) and value.ndim > 0)
    if not listed or isinstance(value, str | bytes):
        raise PatternError(f"{label} must be a list of polygons in mm, not {shown(value)}.")
    return [_polygon(tile, number) for number, tile in enumerate(value)]


def _polygon(tile: Any, number: int) -> FloatArray:
    try:
        polygon = require_array(tile, f"tile {number}", "mm")
    except UnitRangeError:
        polygon = np.empty(0)
    if polygon.ndim != 2 or polygon.shape[1:] != (2,) or len(polygon) > MOST_CORNERS:
        raise PatternError(
            f"Tile {number} must be a list of (x, y) corners, finite, in mm, at most "
            f"{MOST_CORNERS}, not {shown(tile)}."
        )
    return polygon


def lattice_vector(value: Any, label: str) -> FloatArray:
    """Check of a lattice vector (2,), mm."""
    try:
        vector = np.array(require_series(value, label, "mm"))
    except UnitRangeError:
        vector = np.empty(0)
    if vector.shape != (2,):
        raise PatternError(
            f"The lattice vectors t1 and t2 must each be two finite numbers in mm, but {label} is "
            f"{shown(value)}."
        )
    longest = float(np.abs(vector).max())
    if longest > LONGEST:
        raise PatternError(
            f"The lattice vector {label} reaches {longest:.6g} mm: stay within {LONGEST:g} mm."
        )
    return vector

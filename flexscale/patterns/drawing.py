"""Polygons as given: numbers, moved to the origin and rounded to the digits that they hold.

The first corner of the first tile is the origin, so that a pattern is the same pattern wherever it
was drawn. Far from the origin floats hold fewer digits of a corner: what is left of them after the
move is rounded, to 1e-9 of a tile's size, and far away to what is held there. Numbers typed with
fewer decimals come back as typed; others are kept to that same 1e-9 also where the pattern lies at
the origin, since two places of one pattern could not be told to be the same otherwise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from flexscale.arrays import FloatArray
from flexscale.errors import PatternError

KEPT = 1e-9  # of a tile's size: how finely corners are kept
HELD = 1e-6  # of a tile's size: where floats hold corners less finely, the pattern is refused
FAR = 10.0  # cells: tiles listed farther from the first one are moved back by lattice vectors
TYPED = 1.2  # units: half of one in both coordinates, and as much again of the images' mean
SPREAD = 3.0  # units: two typed corners of one point may differ in both coordinates, and by t1, t2
ONE_POINT = 1.5  # units: corners of one point that were rounded by themselves differ by one at most
FINEST, COARSEST = 1e-7, 1e-4  # of a tile's size: bounds to the distance of corners that are one


@dataclass(frozen=True)
class Drawing:
    """Tiles and lattice of a pattern, as they are kept.

    Attributes
    ----------
    tiles : tuple of (n_i, 2) corners, mm; the first one of the first tile is the origin.
    lattice : (2, 2) rows t1, t2, mm.
    unit : mm, one in the last decimal of all numbers.
    """

    tiles: tuple[FloatArray, ...]
    lattice: FloatArray
    unit: float

    @property
    def size(self) -> float:
        """Root of the tiles' mean area, mm."""
        return tile_size(self.lattice, len(self.tiles))


def tile_size(lattice: FloatArray, n_tiles: int) -> float:
    """Root of the mean area of a cell's tiles, mm."""
    (a, b), (c, d) = lattice.tolist()
    return float(np.sqrt(abs(a * d - b * c) / n_tiles))


def own_digits(unit: float, size: float) -> float:
    """How far numbers typed to a unit [mm] may be from what is meant, mm."""
    return min(TYPED * unit, COARSEST * size)


def corner_tolerance(unit: float, size: float) -> float:
    """Distance below which corners of tiles [mm] are one, of numbers typed to a unit [mm]."""
    return float(np.clip(SPREAD * unit, FINEST * size, COARSEST * size))


def read_drawing(tiles: Sequence[ArrayLike], t1: ArrayLike, t2: ArrayLike) -> Drawing:
    """Polygons and lattice vectors as numbers, moved to the origin.

    Raises
    ------
    PatternError : not polygons of finite numbers, no lattice, or too far from the origin.
    """
    lattice = _lattice(t1, t2)
    if len(tiles) == 0:
        raise PatternError("A pattern needs at least one tile polygon, but none was given.")
    given = [_polygon(tile, number) for number, tile in enumerate(tiles)]
    size = tile_size(lattice, len(given))
    finest = round(-np.log10(KEPT * size))
    farthest = max(float(np.abs(polygon).max()) for polygon in given)
    held = 4.0 * float(np.spacing(farthest))
    if held > HELD * size:
        raise PatternError(
            f"The tiles lie up to {farthest:.3g} mm from the origin, where floating-point numbers "
            f"hold {held:.1g} mm, too coarse for tiles of about {size:.3g} mm: draw the pattern "
            "nearer to the origin, its place does not matter."
        )
    # So that numbers typed with one decimal more are not rounded this way here and that way there.
    start = given[0][0] - 0.035 * 10.0**-finest
    decimals = min(finest, int(np.floor(-np.log10(held)))) if held > 0.0 else finest
    lattice = np.round(lattice, finest) + 0.0
    moved = [np.round(polygon - start, decimals) for polygon in given]
    kept = tuple(_brought_near(polygon, lattice, decimals) + 0.0 for polygon in moved)
    digits = max(_decimals(array, finest) for array in (*kept, lattice))
    return Drawing(kept, lattice, 10.0**-digits)


def _brought_near(polygon: FloatArray, lattice: FloatArray, decimals: int) -> FloatArray:
    """A tile that is listed cells away from the first one moved into the cell there."""
    steps = np.floor(np.round(polygon[0] @ np.linalg.inv(lattice), 6))
    if np.abs(steps).max() <= FAR:
        return polygon
    return np.round(polygon - steps @ lattice, decimals)


def _decimals(numbers: FloatArray, most: int) -> int:
    """Fewest decimals with which numbers are what they are."""
    for digits in range(min(0, most), most):
        if np.array_equal(np.round(numbers, digits), numbers):
            return digits
    return most


def _lattice(t1: ArrayLike, t2: ArrayLike) -> FloatArray:
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
    return lattice


def _polygon(tile: ArrayLike, number: int) -> FloatArray:
    try:
        polygon = np.array(tile, dtype=float)
    except (TypeError, ValueError):
        polygon = np.empty(0)
    if (
        polygon.ndim != 2
        or polygon.shape[1:] != (2,)
        or not len(polygon)
        or not np.isfinite(polygon).all()
    ):
        raise PatternError(f"Tile {number} must be a list of (x, y) corners, finite, in mm.")
    return polygon

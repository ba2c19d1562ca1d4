"""The tiles of a pattern on a strip without ends: periodic along its length, cut at its sides."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import ArrayLike

from flexscale.arrays import FloatArray
from flexscale.errors import PatternError
from flexscale.patterns.clipped import (
    MOST_TRIES,
    SheetTiles,
    cell_of_pieces,
    no_place,
    pieces_within,
    require_room,
    scales_and_bare,
    tiles_near,
)
from flexscale.patterns.pattern import Pattern
from flexscale.patterns.prototiles import find_prototiles
from flexscale.units import require_finite, require_positive

_LONGEST = 12  # lattice vectors whose sum the strip may follow


def clip_strip(
    pattern: Pattern,
    width: float,
    direction: float = 0.0,
    *,
    periods: int = 1,
    center: ArrayLike | None = None,
) -> SheetTiles:
    """Lay a pattern on a strip along one of its lattice vectors and cut it at the sides.

    Pieces and slivers as of `clip_pattern`.

    Parameters
    ----------
    width : mm.
    direction : degree, of the strip in the pattern; a lattice vector must lie along it.
    periods : of the pattern along the strip, that the result has.
    center : (2,) mm, point of the pattern (as its tiles have it: of polygons that were given, seen
        from the first corner of the first tile) in the middle of the width; else one such that the
        sides cut off nothing too fine to mesh.

    Raises
    ------
    PatternError : no lattice vector lies along the strip, or no place suits.
    """
    width = require_positive(width, "strip width", "mm")
    require_room(width, pattern)
    turn = np.radians(require_finite(direction, "direction", "degree"))
    cosine, sine = np.cos(turn), np.sin(turn)
    rotation = np.array([[cosine, -sine], [sine, cosine]])
    if periods != int(periods) or periods < 1:
        raise PatternError(
            f"A strip has a whole number of periods, at least 1, along it, not {periods!r}."
        )
    period = _period(pattern, pattern.lattice @ rotation, direction)
    length = int(periods) * period
    # A Kronecker sequence, places far from all earlier ones, over the spacing of lattice rows.
    shares = (np.arange(MOST_TRIES) * 0.7548776662 + 0.5) % 1.0 - 0.5
    rows = pattern.cell_area / period * np.array([-sine, cosine])
    refused: list[PatternError] = []
    for place in shares[:, None] * rows if center is None else [_checked(center, pattern)]:
        pieces = _cut(pattern, rotation, place, length, width)
        try:
            cell = cell_of_pieces(pieces, length, width, pattern)
            break
        except PatternError as error:
            refused.append(error)
    else:
        what = f"A strip of {width:g} mm along {direction:g} degree"
        raise no_place(refused, what, "the width" if center is None else "the center or the width")
    with_scales, bare = scales_and_bare(cell, pattern)
    prototiles, copies = find_prototiles(with_scales, pattern.gap)
    no_ends = np.zeros(len(copies), dtype=bool)
    return SheetTiles(
        length, width, float(direction), place, prototiles, copies, no_ends, no_ends, bare
    )


def _checked(center: ArrayLike, pattern: Pattern) -> FloatArray:
    """A point (2,) of the pattern, mm, moved into the cell at the origin."""
    point = np.asarray(center, dtype=float)
    if point.shape != (2,) or not np.isfinite(point).all():
        raise PatternError(f"The center of a strip is a point (x, y) in mm, not {center!r}.")
    shares = point @ np.linalg.inv(pattern.lattice)
    moved: FloatArray = (shares - np.round(shares)) @ pattern.lattice
    return moved


def _period(pattern: Pattern, lattice: FloatArray, direction: float) -> float:
    """Length [mm] of the shortest lattice vector along x, of a lattice in the strip's axes."""
    steps = np.arange(-_LONGEST, _LONGEST + 1)
    sums = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2) @ lattice
    size = np.sqrt(pattern.cell_area)
    along = sums[(sums[:, 0] > 1e-6 * size) & (np.abs(sums[:, 1]) < 1e-6 * size), 0]
    if not len(along):
        raise PatternError(
            f"No lattice vector of the pattern lies along {direction:g} degree: a strip without "
            "ends needs one, for instance along "
            f"{np.degrees(np.arctan2(*pattern.lattice[0, ::-1])):.4g} degree."
        )
    return float(along.min())


def _cut(
    pattern: Pattern, rotation: FloatArray, center: FloatArray, length: float, width: float
) -> list[FloatArray]:
    """Pieces (n_i, 2) of the tiles of one period, in the strip's coordinates."""
    middle = np.array([0.0, 0.5 * width])
    near = tiles_near(pattern, rotation, center, middle, np.array([length, width]))
    # Of the copies along the strip, those whose middle lies in the first period.
    tiles = [tile for tile in near if 0.0 <= tile[:, 0].mean() + 1e-9 * length < length]
    band = shapely.box(-1e3 * length, 0.0, 1e3 * length, width)
    return pieces_within(tiles, band, 1e-9 * length * width)

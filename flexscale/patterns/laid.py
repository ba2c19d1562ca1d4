"""A pattern laid on a sheet of any outline: whole scales, those that the border cuts, bare rests.

Pieces of cut tiles are tiles of their own, with scales half a gap away from the border as from
their neighbors. What carries no scale stays bare: pieces whose scale would be smaller than `SLIVER`
of a tile, or that the gap leaves no scale in one part.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import ArrayLike

from flexscale.arrays import BoolArray, FloatArray
from flexscale.errors import PatternError
from flexscale.patterns.cell import polygon_area
from flexscale.patterns.outlines import inset_corners
from flexscale.patterns.overlay import intersection
from flexscale.patterns.pattern import Pattern
from flexscale.short_repr import ShortRepr

SLIVER = 0.05  # of the tiles' mean area: smaller scales are left out
_NOTHING = 1e-9  # of the mean tile area: pieces that are rounding
ON_LINE = 1e-7  # mm, from a line: rounding


@dataclass(frozen=True, repr=False)
class LaidPattern(ShortRepr):
    """Scales of a sheet.

    Attributes
    ----------
    pattern : whose scales they are.
    border : (n, 2) outline of the sheet, counterclockwise, mm.
    direction : degree, of the sheet's x axis in the pattern.
    tiles : polygons (n_i, 2) with scales, counterclockwise, mm, in the sheet's coordinates.
    outlines : (m_i, 2) of their scales, mm.
    whole : (n_tiles,) whether the border does not cut them.
    gaps : (n_tiles,) mm, of their scales.
    bare : polygons (n_i, 2) of pieces without a scale.
    """

    pattern: Pattern
    border: FloatArray
    direction: float
    tiles: tuple[FloatArray, ...]
    outlines: tuple[FloatArray, ...]
    whole: BoolArray
    gaps: FloatArray
    bare: tuple[FloatArray, ...]

    @property
    def area(self) -> float:
        """mm2, of the sheet."""
        return float(polygon_area(self.border))


def rectangle(length: float, width: float) -> FloatArray:
    """(4, 2) outline of a sheet [0, length] x [0, width], mm."""
    return np.array([[0.0, 0.0], [length, 0.0], [length, width], [0.0, width]])


def disc(radius: float, side: float) -> FloatArray:
    """(n, 2) outline of a disc around the origin, of sides of about a length, mm; it has all
    symmetries that patterns have."""
    n = 12 * max(1, int(np.ceil(2.0 * np.pi * radius / side / 12.0)))
    angles = 2.0 * np.pi * np.arange(n) / n
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def lay_pattern(
    pattern: Pattern,
    border: FloatArray,
    direction: float = 0.0,
    offset: ArrayLike = (0.0, 0.0),
) -> LaidPattern:
    """Lay a pattern on a sheet.

    Parameters
    ----------
    border : (n, 2) outline of the sheet, counterclockwise, mm.
    direction : degree, of the sheet's x axis in the pattern's coordinates.
    offset : (2,) mm, point of the pattern that comes to lie in the middle of the border's box.

    Raises
    ------
    PatternError : no piece of the sheet carries a scale.
    """
    turn, point = np.radians(direction), np.asarray(offset, dtype=float)
    cosine, sine = np.cos(turn), np.sin(turn)
    rotation = np.array([[cosine, -sine], [sine, cosine]])  # x @ rotation
    low, high = border.min(axis=0), border.max(axis=0)
    middle = 0.5 * (low + high)
    edge = shapely.Polygon(border)
    shapely.prepare(edge)
    lattice = pattern.lattice @ rotation
    tiles: list[FloatArray] = []
    outlines: list[FloatArray] = []
    whole: list[bool] = []
    gaps: list[float] = []
    bare: list[FloatArray] = []
    for tile, outline, gap in zip(pattern.tiles, pattern.outlines(), pattern.gaps, strict=True):
        here, own = ((x - point) @ rotation + middle for x in (tile, outline))
        shifts = _shifts(here, lattice, low, high)
        placed = shapely.polygons(here[None] + shifts[:, None])
        inside = shapely.covers(edge, placed)
        for shift in shifts[inside]:
            tiles.append(here + shift)
            outlines.append(own + shift)
            whole.append(True)
        cut = placed[~inside & shapely.intersects(edge, placed)]
        for piece in _pieces(cut, edge, _NOTHING * pattern.tile_area):
            scale = _scale_of(piece, gap, pattern.tile_area)
            if scale is None:
                bare.append(piece)
            else:
                tiles.append(piece)
                outlines.append(scale)
                whole.append(False)
        gaps += [gap] * (len(tiles) - len(gaps))
    if not tiles:
        raise PatternError(
            f"A sheet of {shown_size(border)} cuts all scales of the pattern to slivers: make it "
            "larger, or the tiles smaller."
        )
    return LaidPattern(
        pattern, border, float(direction), tuple(tiles), tuple(outlines), np.array(whole),
        np.array(gaps), tuple(bare),
    )  # fmt: skip


def shown_size(border: FloatArray) -> str:
    """Size of a border's box for messages."""
    return "{:g} x {:g} mm".format(*np.ptp(border, axis=0))


def _shifts(tile: FloatArray, lattice: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
    """(n, 2) lattice vectors that bring a tile's box into that of the sheet, mm."""
    first, last = low - tile.max(axis=0), high - tile.min(axis=0)
    corners = np.array([[x, y] for x in (first[0], last[0]) for y in (first[1], last[1])])
    steps = corners @ np.linalg.inv(lattice)
    m, n = (
        np.arange(np.floor(a), np.ceil(b) + 1.0)
        for a, b in zip(steps.min(axis=0), steps.max(axis=0), strict=True)
    )
    shifts = np.stack(np.meshgrid(m, n, indexing="ij"), axis=-1).reshape(-1, 2) @ lattice
    near = ((shifts > first) & (shifts < last)).all(axis=1)
    return np.asarray(shifts[near])


def _pieces(tiles: Sequence[object], edge: shapely.Polygon, least: float) -> list[FloatArray]:
    """Pieces (n_i, 2), counterclockwise, of tiles within a border, of more than an area, mm2."""
    pieces = []
    for cut in intersection(np.asarray(tiles, dtype=object), edge):
        for part in shapely.get_parts(cut):
            if part.geom_type == "Polygon" and part.area > least:
                pieces.append(np.array(shapely.orient_polygons(part).exterior.coords)[:-1])
    return pieces


def _scale_of(piece: FloatArray, gap: float, tile_area: float) -> FloatArray | None:
    """Outline of a piece's scale; None for a sliver, or where the gap leaves none in one part."""
    outline = inset_corners(piece, 0.5 * gap)
    if outline is None or polygon_area(outline) <= SLIVER * tile_area:
        return None
    return outline


def on_line(tile: FloatArray, x: float) -> bool:
    """Whether a tile has an edge on the line across the sheet at x, mm."""
    near = np.abs(tile[:, 0] - x) < ON_LINE
    return bool((near & np.roll(near, -1)).any())

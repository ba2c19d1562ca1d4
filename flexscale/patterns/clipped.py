"""The tiles of a pattern that lie on a rectangular sheet, cut at its border.

Pieces of cut tiles are tiles of their own, with scales half a gap away from the border as from
their neighbors. Slivers, and pieces that the gap leaves no scale in one part, stay bare. A sheet
that is glued end to end has the pieces of its far end before the near one, a sheet's length away.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from flexscale.arrays import BoolArray, FloatArray
from flexscale.errors import PatternError
from flexscale.patterns.cell import TiledCell, build_cell, polygon_area
from flexscale.patterns.outlines import inset_corners
from flexscale.patterns.overlay import intersection
from flexscale.patterns.pattern import Pattern
from flexscale.patterns.prototiles import Prototile, TileCopy, find_prototiles
from flexscale.short_repr import ShortRepr
from flexscale.units import require_finite, require_positive

SLIVER = 0.05  # of a tile's area: smaller pieces carry no scale
SHORTEST = 0.05  # of a gap: a cut that leaves shorter edges or thinner pieces is moved
CUT = 0.0125  # of a gap: ends of cuts nearer than this, a quarter of the above, are one
TRIES, ENOUGH = 25, 5  # places of the pattern on the sheet that are tried, and that may be used
MOST_TRIES = 8 * TRIES  # where none of the first ones suits


@dataclass(frozen=True, repr=False)
class SheetTiles(ShortRepr):
    """Tiles of a sheet [0, length] x [0, width].

    Attributes
    ----------
    length, width : mm.
    direction : degree, of the pattern along the sheet's length.
    center : (2,) mm, point of the pattern in the middle of the sheet.
    prototiles, copies : of the pieces that carry scales.
    at_end : (n_copies,) pieces at one of the ends.
    at_far_end : (n_copies,) pieces at the far end; none if the sheet is glued end to end.
    bare : polygons (n_i, 2) of the others, mm, with flags (n_i,) of sharp corners.
    glued : whether the far end is where a lattice vector carries the near one.
    """

    length: float
    width: float
    direction: float
    center: FloatArray
    prototiles: tuple[Prototile, ...]
    copies: tuple[TileCopy, ...]
    at_end: BoolArray
    at_far_end: BoolArray
    bare: tuple[tuple[FloatArray, BoolArray], ...]
    glued: bool = True


def clip_pattern(
    pattern: Pattern, length: float, width: float, direction: float = 0.0, glued: bool = True
) -> SheetTiles:
    """Lay a pattern on a rectangle and cut it at the border.

    The pattern is moved, at most by half a cell, until the border cuts off nothing too fine to
    mesh, and what meets across the ends fits.

    Parameters
    ----------
    length, width : mm; the pattern's `direction` [degree] lies along the length.
    glued : end to end, or with two ends of its own; the pattern's place is the same.

    Raises
    ------
    PatternError : the sheet is smaller than one cell, or no place of the pattern suits.
    """
    length = require_positive(length, "sheet length", "mm")
    width = require_positive(width, "sheet width", "mm")
    turn = np.radians(require_finite(direction, "direction", "degree"))
    if length * width < pattern.cell_area:
        raise PatternError(
            f"A sheet of {length:g} x {width:g} mm is smaller than one cell of the pattern, "
            f"{pattern.cell_area:.4g} mm2: make it larger, or the tiles smaller."
        )
    require_room(min(length, width), pattern)
    center, cell = _best_place(pattern, length, width, turn)
    tiles = list(cell.tiles)
    if glued:
        tiles = [_at_near_end(tile, length, cell.tolerance) for tile in tiles]
    with_scales, bare = scales_and_bare(replace(cell, tiles=tuple(tiles)), pattern)
    prototiles, copies = find_prototiles(with_scales, pattern.gap)
    at_near, at_far = (
        np.array([touches_end(tile - [x, 0.0], cell.tolerance) for tile in with_scales.tiles])
        for x in (0.0, length)
    )
    return SheetTiles(
        length, width, float(direction), center, prototiles, copies, at_near | at_far, at_far,
        bare, glued,
    )  # fmt: skip


def require_room(width: float, pattern: Pattern) -> None:
    """Refuse a width, mm, that leaves no scale between two sides."""
    if width <= pattern.gap:
        raise PatternError(
            f"A sheet of {width:g} mm is no wider than the gap of {pattern.gap:g} mm, half of "
            "which stays free at each side: make it wider."
        )


def scales_and_bare(
    cell: TiledCell, pattern: Pattern
) -> tuple[TiledCell, tuple[tuple[FloatArray, BoolArray], ...]]:
    """The pieces that carry scales, and polygons and flags of sharp corners of the others."""
    carries = [_carries_scale(tile, pattern) for tile in cell.tiles]
    pieces = list(zip(cell.tiles, cell.sharp, carries, strict=True))
    kept = replace(
        cell,
        tiles=tuple(tile for tile, _, yes in pieces if yes),
        sharp=tuple(sharp for _, sharp, yes in pieces if yes),
    )
    return kept, tuple((tile, sharp) for tile, sharp, yes in pieces if not yes)


def touches_end(polygon: FloatArray, tolerance: float) -> bool:
    """Whether a piece has an edge on the near end, x = 0."""
    on_end = np.abs(polygon[:, 0]) < tolerance
    return bool((on_end & np.roll(on_end, -1)).any())


def _best_place(
    pattern: Pattern, length: float, width: float, turn: float
) -> tuple[FloatArray, TiledCell]:
    """Point of the pattern in the middle of the sheet, and the pieces.

    Of some places that suit, the one with the fewest bare pieces at the ends, and in all.
    """
    found: list[tuple[tuple[int, int], FloatArray, TiledCell]] = []
    refused: list[PatternError] = []
    for attempt in range(MOST_TRIES):
        if found and attempt == TRIES:
            break
        # A Kronecker sequence: places far from all earlier ones.
        share = (attempt * np.array([0.7548776662, 0.5698402910]) + 0.5) % 1.0 - 0.5
        center = (share if attempt else np.zeros(2)) @ pattern.lattice
        pieces = _cut(pattern, length, width, turn, center)
        try:
            cell = cell_of_pieces(pieces, length, width, pattern)
        except PatternError as error:
            refused.append(error)
            continue
        bare = [tile for tile in cell.tiles if not _carries_scale(tile, pattern)]
        moved = [_at_near_end(tile, length, cell.tolerance) for tile in bare]
        at_end = sum(touches_end(tile, cell.tolerance) for tile in moved)
        found.append(((at_end, len(bare)), center, cell))
        if not bare or len(found) == ENOUGH:
            break
    if not found:
        raise no_place(refused, f"A sheet of {length:g} x {width:g} mm", "a side")
    _, center, cell = min(found, key=lambda place: place[0])
    return center, cell


def cell_of_pieces(
    pieces: list[FloatArray], length: float, width: float, pattern: Pattern
) -> TiledCell:
    """Pieces (n_i, 2) that cover a rectangle, as a cell whose opposite sides meet.

    Raises
    ------
    PatternError : the place of the pattern does not suit: a piece is too fine to mesh, corners on
        opposite sides nearly meet, or no piece carries a scale.
    """
    least = SHORTEST * pattern.gap
    thin = min(finest(piece) for piece in pieces)
    if thin <= least:
        raise PatternError(
            f"The border leaves a piece or an edge of {thin:.3g} mm, finer than {least:.3g} mm."
        )
    cell = build_cell(pieces, np.diag([length, width]), CUT * pattern.gap)
    if not any(_carries_scale(tile, pattern) for tile in cell.tiles):
        raise PatternError(
            f"The border leaves no piece with a scale: all are below {SLIVER:.0%} of a tile, or "
            f"not wide enough for a gap of {pattern.gap:g} mm."
        )
    return cell


def no_place(refused: list[PatternError], what: str, remedy: str) -> PatternError:
    """The error when no place of the pattern suits: how many were tried, and why not the first."""
    return PatternError(
        f"{what} cannot be cut from the pattern at any of the {len(refused)} places that were "
        f"tried. At the first: {refused[0]} Change {remedy} by a few mm."
    )


def _at_near_end(polygon: FloatArray, length: float, tolerance: float) -> FloatArray:
    """A piece at the far end moved before the near one; others as they are."""
    moved = polygon - [length, 0.0]
    return moved if touches_end(moved, tolerance) else polygon


def _cut(
    pattern: Pattern, length: float, width: float, turn: float, center: FloatArray
) -> list[FloatArray]:
    """Pieces (n_i, 2) of all tiles on the rectangle, in its coordinates."""
    cosine, sine = np.cos(turn), np.sin(turn)
    rotation = np.array([[cosine, -sine], [sine, cosine]])
    size = np.array([length, width])
    tiles = tiles_near(pattern, rotation, center, 0.5 * size, size)
    return pieces_within(tiles, shapely.box(0.0, 0.0, length, width), 1e-9 * length * width)


def pieces_within(
    tiles: Sequence[FloatArray], border: shapely.Polygon, least: float
) -> list[FloatArray]:
    """Pieces (n_i, 2), counterclockwise, of tiles within a border, of more than an area [mm2]."""
    pieces = []
    cut = intersection(np.array([shapely.Polygon(tile) for tile in tiles]), border)
    for each in cut:
        for part in shapely.get_parts(each):
            if part.geom_type == "Polygon" and part.area > least:
                pieces.append(np.array(shapely.orient_polygons(part).exterior.coords)[:-1])
    return pieces


def tiles_near(
    pattern: Pattern, rotation: FloatArray, center: FloatArray, middle: FloatArray, size: FloatArray
) -> list[FloatArray]:
    """All tiles (n_i, 2) that may reach into a rectangle [0, size], in its coordinates.

    Parameters
    ----------
    rotation : (2, 2) from the pattern's coordinates to the rectangle's, as x @ rotation.
    center, middle : (2,) mm, point of the pattern, and where on the rectangle it lies.
    size : (2,) mm.
    """
    lattice = pattern.lattice @ rotation
    tiles = [(tile - center) @ rotation + middle for tile in pattern.tiles]
    reach = np.hypot(*size) + max(float(np.ptp(tile, axis=0).max()) for tile in tiles)
    spans = reach * np.linalg.norm(np.linalg.inv(lattice), axis=0)
    m, n = (np.arange(-int(np.ceil(s)), int(np.ceil(s)) + 1) for s in spans)
    shifts = np.stack(np.meshgrid(m, n, indexing="ij"), axis=-1).reshape(-1, 2) @ lattice
    found = []
    for tile in tiles:
        low, high = tile.min(axis=0), tile.max(axis=0)
        near = ((shifts + high > 0.0) & (shifts + low < size)).all(axis=1)
        found += [tile + shift for shift in shifts[near]]
    return found


def finest(polygon: FloatArray) -> float:
    """Shortest edge of a polygon, or its mean width if that is less, mm."""
    lengths = np.linalg.norm(np.roll(polygon, -1, axis=0) - polygon, axis=1)
    return float(min(lengths.min(), 2.0 * polygon_area(polygon) / lengths.sum()))


def _carries_scale(polygon: FloatArray, pattern: Pattern) -> bool:
    """Whether a piece is no sliver, and the gap leaves it a scale in one part."""
    outline = inset_corners(polygon, 0.5 * pattern.gap)
    return outline is not None and polygon_area(outline) > SLIVER * pattern.tile_area

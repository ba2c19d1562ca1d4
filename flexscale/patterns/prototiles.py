"""The tiles of a cell up to congruence."""

from __future__ import annotations

from dataclasses import dataclass

from flexscale.patterns.cell import TiledCell
from flexscale.patterns.outlines import scale_outline
from flexscale.patterns.symmetry import BoolArray, FloatArray, Isometry, polygon_isometries

# Copies and images must meet to rounding: tiles that are congruent only to the digits somebody
# typed are different shapes, and a polygon symmetric only to those digits has no symmetry.
CONGRUENT = 1e-8  # of a tile's size


@dataclass(frozen=True)
class Prototile:
    """One shape of tile, as it is copied about.

    Attributes
    ----------
    polygon : (n, 2) counterclockwise corners, all tiling vertices included, mm.
    sharp : (n,) flags of corners that deserve small elements.
    stabiliser : isometries that carry the tile onto itself, the identity first.
    outline : (m, 2) counterclockwise outline of its scale, mm.
    """

    polygon: FloatArray
    sharp: BoolArray
    stabiliser: tuple[Isometry, ...]
    outline: FloatArray


@dataclass(frozen=True)
class TileCopy:
    """A tile of the cell: which prototile, and the isometry that carries it there."""

    prototile: int
    placement: Isometry


def find_prototiles(
    cell: TiledCell, gap: float
) -> tuple[tuple[Prototile, ...], tuple[TileCopy, ...]]:
    """Sort the tiles by congruence, corners and their sharpness included.

    Symmetries are read off the polygons, so that any symmetric tile gets a symmetric mesh,
    whichever way it was given.

    Parameters
    ----------
    gap : mm, between the scales.

    Raises
    ------
    PatternError : the gap leaves a tile no scale in one piece.
    """
    tolerance = CONGRUENT * cell.size
    prototiles: list[Prototile] = []
    copies: list[TileCopy] = []
    for number, (polygon, sharp) in enumerate(zip(cell.tiles, cell.sharp, strict=True)):
        for index, known in enumerate(prototiles):
            found = polygon_isometries(known.polygon, known.sharp, polygon, sharp, tolerance)
            if found:
                copies.append(TileCopy(index, found[0]))
                break
        else:
            stabiliser = polygon_isometries(polygon, sharp, polygon, sharp, tolerance)
            outline = scale_outline(cell.tiles, number, gap)
            copies.append(TileCopy(len(prototiles), stabiliser[0]))
            prototiles.append(Prototile(polygon, sharp, tuple(stabiliser), outline))
    return tuple(prototiles), tuple(copies)

"""The tiles of a cell up to congruence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexscale.arrays import BoolArray, FloatArray
from flexscale.patterns.cell import TiledCell
from flexscale.patterns.outlines import scale_outlines
from flexscale.patterns.symmetry import Isometry, congruence_measures, polygon_isometries

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
    gap : mm, of its scale, of which half lies within the tile.
    """

    polygon: FloatArray
    sharp: BoolArray
    stabiliser: tuple[Isometry, ...]
    outline: FloatArray
    gap: float


@dataclass(frozen=True)
class TileCopy:
    """A tile of the cell: which prototile, and the isometry that carries it there."""

    prototile: int
    placement: Isometry


def find_prototiles(
    cell: TiledCell, gaps: Sequence[float]
) -> tuple[tuple[Prototile, ...], tuple[TileCopy, ...]]:
    """Sort the tiles by congruence, corners, their sharpness and gaps included.

    Symmetries are read off the polygons, so that any symmetric tile gets a symmetric mesh,
    whichever way it was given.

    Parameters
    ----------
    gaps : mm, of the tiles' scales.

    Raises
    ------
    PatternError : a gap leaves a tile no scale in one piece.
    """
    firsts, copies = _sorted_by_congruence(cell, gaps)
    own = [gaps[number] for number in firsts]
    outlines = scale_outlines([cell.tiles[number] for number in firsts], firsts, own)
    tolerance = CONGRUENT * cell.size
    prototiles = []
    for number, outline in zip(firsts, outlines, strict=True):
        tile, sharp = cell.tiles[number], cell.sharp[number]
        stabiliser = tuple(polygon_isometries(tile, sharp, tile, sharp, tolerance))
        prototiles.append(Prototile(tile, sharp, stabiliser, outline, gaps[number]))
    return tuple(prototiles), tuple(copies)


def _sorted_by_congruence(
    cell: TiledCell, gaps: Sequence[float]
) -> tuple[list[int], list[TileCopy]]:
    """Numbers of the first tile of each shape, and for every tile which shape it is, and where."""
    tolerance = CONGRUENT * cell.size
    measures = congruence_measures(cell.tiles)
    known = np.empty_like(measures)
    firsts: list[int] = []
    copies: list[TileCopy] = []
    for number, (polygon, sharp) in enumerate(zip(cell.tiles, cell.sharp, strict=True)):
        # Of tiles of many shapes few are so much as alike.
        apart = np.abs(known[: len(firsts)] - measures[number]).max(axis=1, initial=0.0)
        for index in np.flatnonzero(apart <= 4.0 * tolerance).tolist():
            if gaps[firsts[index]] != gaps[number]:
                continue
            tile, marks = cell.tiles[firsts[index]], cell.sharp[firsts[index]]
            placement = next(polygon_isometries(tile, marks, polygon, sharp, tolerance), None)
            if placement is not None:
                copies.append(TileCopy(index, placement))
                break
        else:
            itself = next(polygon_isometries(polygon, sharp, polygon, sharp, tolerance))
            known[len(firsts)] = measures[number]
            copies.append(TileCopy(len(firsts), itself))
            firsts.append(number)
    return firsts, copies

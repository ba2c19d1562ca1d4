"""Joints: the lines along which the sheet between two scales is strained, with stations on them.

The scales of two tiles that share an edge face one another across the gap. A scale ends short of
the tiling's vertex, by half the gap over the tangent of half its angle there: at sharp tips its
walls end far from the vertex, and what of the sheet lies beyond is strained little. A joint
therefore runs where both walls face one another, and beyond towards a vertex at a distance d by
d / (1 + d / l), where l is `END_LENGTH` of the gap: by almost all of a short way, and by l at most.

A joint lies in the middle of its gap: on the tiling's edge, unless the two scales have gaps of
their own that differ, g and h: then (h - g) / 4 beyond it, seen from the scale of g.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.spatial import cKDTree

from flexscale.arrays import FloatArray, IntArray
from flexscale.errors import PatternError
from flexscale.patterns.gaps import gap_between
from flexscale.patterns.outlines import inset_edges
from flexscale.patterns.pattern import Pattern

#: Of the gap, by which a joint goes on at most beyond where walls face one another.
END_LENGTH = 1.4
# Stations on a straight piece are exact for polynomials of degree 9; laws have degree 8. A curved
# line is one of many short pieces, which have one or two each.
_MOST = 5
_IN_ALL = 24  # on a line, or more; a fraction of one is one
_STEEPEST = 0.1  # of 1 + cosine of a turn between edges, for the mitre of a line beside them
_SAME = 1e-6  # of the cell, between midpoints of one edge as an edge of two tiles


@dataclass(frozen=True, eq=False)
class Joint:
    """Stations of all joints between one scale and one other.

    Attributes
    ----------
    first, second : numbers of the scales.
    offset : (2,) lattice vector of the second, in whole multiples of t1 and t2.
    points : (n, 2) stations, mm, where the first scale is at home.
    normals : (n, 2) across the joint, from the first to the second.
    weights : (n,) length of joint that a station stands for, mm.
    gaps : (n,) mm, between the walls there; one, unless a scale is a body of several.
    """

    first: int
    second: int
    offset: tuple[int, int]
    points: FloatArray
    normals: FloatArray
    weights: FloatArray
    gaps: FloatArray


def find_joints(pattern: Pattern, end_length: float = END_LENGTH) -> list[Joint]:
    """All joints of one lattice cell, one for each two scales that share edges.

    Parameters
    ----------
    end_length : of the gap, see `END_LENGTH`.

    Raises
    ------
    PatternError : no walls face one another at all. Two scales of which this is so have no joint.
    """
    tiles = pattern.tiles
    partner, offset = _partners(tiles, pattern.lattice)
    if (partner < 0).any():
        raise PatternError(
            "Two tiles do not have an edge between them in common to 1e-6 of the cell: give "
            "corners to more digits."
        )
    return _join(tiles, partner, offset, np.arange(len(tiles)), pattern.gaps, end_length)


def joint_gaps(pattern: Pattern) -> tuple[float, ...]:
    """Gaps of a pattern's joints, mm, each once, the narrowest first.

    Raises
    ------
    PatternError : see `find_joints`.
    """
    if len(set(pattern.gaps)) == 1:
        return pattern.gaps[:1]
    found: list[float] = np.unique([joint.gaps[0] for joint in find_joints(pattern)]).tolist()
    return tuple(found)


def joints_between(
    tiles: Sequence[FloatArray],
    gaps: Sequence[float],
    bodies: IntArray,
    end_length: float = END_LENGTH,
) -> list[Joint]:
    """All joints of a sheet; `first` and `second` of a joint are bodies.

    Edges that no two tiles share, as those on the border, are free.

    Parameters
    ----------
    tiles : polygons (n_i, 2) with scales, mm.
    gaps : mm, of their scales.
    bodies : (n_tiles,) number of the rigid body that each tile's scale is part of.
    """
    return _join(tiles, *_partners(tiles, None), bodies, gaps, end_length)


def _join(
    tiles: Sequence[FloatArray],
    partner: IntArray,
    offset: IntArray,
    bodies: IntArray,
    gaps: Sequence[float],
    end_length: float,
) -> list[Joint]:
    facing = _All()
    start = np.concatenate([[0], np.cumsum([len(tile) for tile in tiles])])
    owner = np.repeat(np.arange(len(tiles)), np.diff(start))
    others = np.where(partner < 0, -1, owner[partner])
    found: dict[tuple[int, int, int, int], list[tuple[FloatArray, ...]]] = {}
    for tile_a, tile in enumerate(tiles):
        a, edges = int(bodies[tile_a]), slice(start[tile_a], start[tile_a + 1])
        keys = [
            (other, *shift)
            for other, shift in zip(others[edges].tolist(), offset[edges].tolist(), strict=True)
        ]
        for run in _runs(keys):
            tile_b, m, n = keys[run[0]]
            if tile_b < 0:
                continue
            b = int(bodies[tile_b])
            if (b, m, n) < (a, 0, 0) or (b == a and (m, n) <= (0, 0)):
                continue  # met from the other side, or within one body
            mine = facing.of(tile, gaps[tile_a])
            its = facing.of(tiles[tile_b], gaps[tile_b])
            here = [mine[k] for k in run]
            there = [its[partner[start[tile_a] + k] - start[tile_b]] for k in run]
            corners = np.array([[tile[k], tile[(k + 1) % len(tile)]] for k in run])
            gap, aside = gap_between(gaps[tile_a], gaps[tile_b]), gaps[tile_b] - gaps[tile_a]
            part = _stations(corners, (here, there), 0.25 * aside, end_length * gap)
            if part is not None:
                whole = (*part, np.full(len(part[0]), gap))
                found.setdefault((a, b, m, n), []).append(whole)
    joints = []
    for (a, b, m, n), parts in found.items():
        arrays = (np.concatenate(items) for items in zip(*parts, strict=True))
        joints.append(Joint(a, b, (m, n), *arrays))
    if not joints and len(tiles) > 1:
        raise PatternError(
            f"No two scales face one another across the gap of {min(gaps):g} mm: narrow it."
        )
    return joints


def _partners(tiles: Sequence[FloatArray], lattice: FloatArray | None) -> tuple[IntArray, IntArray]:
    """For each edge of each tile the number of the same edge of the other tile, -1 for none, and
    the lattice offset (n, 2) of that tile."""
    starts = np.concatenate(tiles)
    ends = np.concatenate([np.roll(tile, -1, axis=0) for tile in tiles])
    places = 0.5 * (starts + ends)
    if lattice is None:
        size = max(float(np.ptp(tile, axis=0).max()) for tile in tiles)
        pairs = cKDTree(places).query_pairs(_SAME * size, output_type="ndarray")
    else:
        places = places @ np.linalg.inv(lattice)
        wrapped = places % 1.0
        wrapped[wrapped >= 1.0] = 0.0
        pairs = cKDTree(wrapped, boxsize=1.0).query_pairs(_SAME, output_type="ndarray")
    partner = np.full(len(places), -1, dtype=np.int64)
    partner[pairs[:, 0]], partner[pairs[:, 1]] = pairs[:, 1], pairs[:, 0]
    if lattice is None:
        return partner, np.zeros((len(places), 2), dtype=np.int64)
    return partner, np.rint(places - places[partner]).astype(np.int64)


class _All:
    """Parts of edges along which scales have walls; most tiles of a sheet are moved copies."""

    def __init__(self) -> None:
        self._known: dict[tuple[bytes, float], FloatArray] = {}

    def of(self, tile: FloatArray, gap: float) -> FloatArray:
        """See `_facing`."""
        key = (np.round(tile - tile[0], 9).tobytes(), gap)
        if key not in self._known:
            self._known[key] = _facing(tile, gap)
        return self._known[key]


def _facing(tile: FloatArray, gap: float) -> FloatArray:
    """(n, 2) part of each edge, from its start, along which the scale has a wall, mm; empty where
    the wall is lost."""
    images = inset_edges(tile, 0.5 * gap)
    if images is None:  # outlines were built, so that this is a matter of rounding
        raise PatternError(f"The walls of a scale are lost at a gap of {gap:g} mm: narrow it.")
    along = np.roll(tile, -1, axis=0) - tile
    along /= np.linalg.norm(along, axis=1)[:, None]
    return np.einsum("nkc,nc->nk", images - tile[:, None], along)


def _runs(keys: list[tuple[int, int, int]]) -> list[list[int]]:
    """Runs of neighboring edges with one key, around the polygon."""
    n = len(keys)
    breaks = [k for k in range(n) if keys[k] != keys[k - 1]]
    if not breaks:
        return [list(range(n))]
    return [[k % n for k in range(begin, end)] for begin, end in pairwise([*breaks, breaks[0] + n])]


def _extension(distance: float, length: float) -> float:
    """By how much a joint goes on towards a vertex at a distance, mm."""
    return max(distance, 0.0) / (1.0 + max(distance, 0.0) / length)


def _stations(
    corners: FloatArray,
    walls: tuple[list[FloatArray], list[FloatArray]],
    aside: float,
    beyond: float,
) -> tuple[FloatArray, FloatArray, FloatArray] | None:
    """Points, normals and weights beside a run of edges; None where no walls face.

    Parameters
    ----------
    corners : (n, 2, 2) mm, ends of the edges.
    walls : of both scales, along each edge; see `_facing`.
    aside : mm, how far the joint lies from the edges, away from the first scale.
    beyond : mm, by which a joint goes on at most beyond where walls face one another.
    """
    along = corners[:, 1] - corners[:, 0]
    lengths = np.linalg.norm(along, axis=1)
    along /= lengths[:, None]
    low = np.array([max(a[0], length - b[1]) for a, b, length in zip(*walls, lengths, strict=True)])
    high = np.array(
        [min(a[1], length - b[0]) for a, b, length in zip(*walls, lengths, strict=True)]
    )
    both = high > low
    if not both.any():
        return None
    if aside:
        corners, begun, lengths = _moved_aside(corners, along, aside)
        low, high = low - begun, high - begun
    starts = np.concatenate([[0.0], np.cumsum(lengths)])
    first, last = (starts[:-1] + low)[both].min(), (starts[:-1] + high)[both].max()
    first -= _extension(first, beyond)
    last += _extension(starts[-1] - last, beyond)
    points, normals, weights = [], [], []
    for k, length in enumerate(lengths):
        begin, end = max(first - starts[k], 0.0), min(last - starts[k], length)
        if end <= begin:
            continue
        n = int(np.clip(np.ceil(_IN_ALL * (end - begin) / (last - first)), 1, _MOST))
        places, shares = np.polynomial.legendre.leggauss(n)
        t = 0.5 * (begin + end) + 0.5 * (end - begin) * places
        points.append(corners[k, 0] + t[:, None] * along[k])
        normals.append(np.repeat([[along[k, 1], -along[k, 0]]], n, axis=0))
        weights.append(0.5 * (end - begin) * shares)
    return np.concatenate(points), np.concatenate(normals), np.concatenate(weights)


def _moved_aside(
    corners: FloatArray, along: FloatArray, aside: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """A run of edges (n, 2, 2) moved along its normals, with mitres between edges, mm.

    Returns
    -------
    Ends of the edges (n, 2, 2); how far each one's start has moved along it (n,); lengths (n,), 0
    of those that are lost.
    """
    normals = np.stack([along[:, 1], -along[:, 0]], axis=1)
    ways = normals.copy()  # of each edge's start
    ways[1:] += normals[:-1]
    cosines = np.sum(normals[1:] * normals[:-1], axis=1)
    ways[1:] /= np.maximum(1.0 + cosines, _STEEPEST)[:, None]
    ends = np.concatenate([ways[1:], normals[-1:]])
    moved = corners + aside * np.stack([ways, ends], axis=1)
    lengths = np.sum((moved[:, 1] - moved[:, 0]) * along, axis=1)
    return moved, aside * np.sum(ways * along, axis=1), np.maximum(lengths, 0.0)

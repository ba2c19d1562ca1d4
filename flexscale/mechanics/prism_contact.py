"""Contact between rigid scales: walls, edges and corners of prisms that stand side by side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numba import njit

from flexscale.arrays import BoolArray, FloatArray, IntArray
from flexscale.mechanics.barrier import MOST_SWEEP_STEPS, SWEEPS, Barrier
from flexscale.mechanics.contact_gaps import LinearGaps
from flexscale.mechanics.prism_candidates import (
    Candidates,
    Memory,
    all_free_share,
    barrier_energy,
    closer_than,
)
from flexscale.mechanics.prism_crossings import any_crossing
from flexscale.mechanics.prism_kernels import N_WORK, barrier_jet

_BASE, _TOP = 0, 1
_MEMORY = 50.0  # d_hat, by which scales move until distances are measured anew: as timed
_LEAST = 1e-3  # d_hat, which scales keep on one way
N_ROWS = 12  # coordinates of a candidate
_JET = 1 + N_ROWS  # of first order


@dataclass(frozen=True, eq=False)
class PrismRows:
    """Corners of pairs of neighboring prisms, as rows of world positions, and what can meet.

    Attributes
    ----------
    table : what kernels take; each pair has rows of its own.
    pair : (n_rows,) pair of scales that a row belongs to.
    """

    table: Candidates
    pair: IntArray

    @property
    def n_rows(self) -> int:
        """How many corners there are, those of a scale once for each pair."""
        return len(self.pair)


@dataclass(frozen=True)
class _OfTwo:
    """Rows and candidates of two prisms."""

    second: BoolArray
    rest: FloatArray
    stencils: IntArray
    is_wall: BoolArray


def find_prism_rows(
    pieces: Sequence[FloatArray],
    meetings: Sequence[tuple[int, int, int]],
    ways: FloatArray,
    heights: tuple[float, float],
    reach: float,
    n_pairs: int,
) -> PrismRows:
    """What can meet of pairs of prisms that stand side by side.

    Parameters
    ----------
    pieces : (m_i, 2) outlines, each from the anchor of its scale, mm. A scale may have several.
    meetings : two pieces, and the number of the pair of scales that they belong to.
    ways : (n_pairs, 2) from the first scale's anchor to the second's, mm.
    heights : of bases and tops above the anchors, mm.
    reach : mm in the plane at rest; features farther apart never meet.
    n_pairs : of scales, whether they can meet or not.
    """
    known: dict[tuple[bytes, bytes, bytes], _OfTwo] = {}
    shapes = [np.round(piece, 9).tobytes() for piece in pieces]
    found: list[list[_OfTwo]] = [[] for _ in range(n_pairs)]
    for a, b, pair in meetings:
        # Most pairs of a large sheet are moved copies of a few.
        key = (shapes[a], shapes[b], np.round(ways[pair], 9).tobytes())
        if key not in known:
            known[key] = _rows_of_two(pieces[a], pieces[b], ways[pair], heights, reach)
        found[pair].append(known[key])
    row_starts, starts = (np.zeros(n_pairs + 1, dtype=np.int64) for _ in range(2))
    stencils = []
    for k, parts in enumerate(found):
        row_starts[k + 1], starts[k + 1] = row_starts[k], starts[k]
        for part in parts:
            stencils.append(part.stencils + row_starts[k + 1])
            row_starts[k + 1] += len(part.rest)
            starts[k + 1] += len(part.stencils)
    parts = [part for each in found for part in each]
    table = Candidates(
        np.concatenate([np.zeros(0, dtype=bool), *(part.second for part in parts)]),
        np.concatenate([np.zeros((0, 3)), *(part.rest for part in parts)]),
        row_starts,
        np.concatenate([np.zeros((0, 4), dtype=np.int64), *stencils]),
        np.concatenate([np.zeros(0, dtype=bool), *(part.is_wall for part in parts)]),
        starts,
    )
    return PrismRows(table, np.repeat(np.arange(n_pairs), np.diff(row_starts)))


def _rows_of_two(
    first: FloatArray,
    second: FloatArray,
    way: FloatArray,
    heights: tuple[float, float],
    reach: float,
) -> _OfTwo:
    rows: dict[tuple[int, int, int], int] = {}
    walls: list[tuple[int, ...]] = []
    edges: list[tuple[int, ...]] = []
    low = heights[_TOP] - heights[_BASE] < reach  # tops of low scales may meet bases
    both = (first, second + way)

    def row(side: int, corner: int, level: int) -> int:
        return rows.setdefault((side, corner % len(both[side]), level), len(rows))

    for side in (0, 1):
        near = _to_segments(both[side], both[1 - side]) < reach
        for i, j in zip(*np.nonzero(near), strict=True):
            wall = [row(1 - side, j, _BASE), row(1 - side, j + 1, _BASE), row(1 - side, j, _TOP)]
            walls += [(row(side, i, level), *wall) for level in (_BASE, _TOP)]
            upright = [row(side, i, _BASE), row(side, i, _TOP)]
            for level in (_BASE, _TOP):
                edge = [row(1 - side, j, level), row(1 - side, j + 1, level)]
                edges.append((*upright, *edge) if side == 0 else (*edge, *upright))
    apart = np.linalg.norm(both[0][:, None] - both[1][None], axis=2)
    for i, j in zip(*np.nonzero(apart < reach), strict=True):
        edges.append((row(0, i, 0), row(0, i, 1), row(1, j, 0), row(1, j, 1)))
    for i, j in zip(*np.nonzero(_between_segments(*both) < reach), strict=True):
        for levels in ((0, 0), (1, 1), *(((0, 1), (1, 0)) if low else ())):
            here = (row(0, i, levels[0]), row(0, i + 1, levels[0]))
            edges.append((*here, row(1, j, levels[1]), row(1, j + 1, levels[1])))
    rest = np.empty((len(rows), 3))
    for k, (side, corner, level) in enumerate(rows):
        rest[k, :2] = (first, second)[side][corner]
        rest[k, 2] = heights[level]
    stencils = np.array([*walls, *edges], dtype=np.int64).reshape(-1, 4)
    is_wall = np.arange(len(stencils)) < len(walls)
    return _OfTwo(np.array([side == 1 for side, _, _ in rows], dtype=bool), rest, stencils, is_wall)


def _to_segments(points: FloatArray, polygon: FloatArray) -> FloatArray:
    """(n, m) distances of points from the edges of a polygon."""
    start, along = polygon, np.roll(polygon, -1, axis=0) - polygon
    arrows = points[:, None] - start[None]
    t = np.clip(np.einsum("nmc,mc->nm", arrows, along) / np.sum(along**2, axis=1), 0.0, 1.0)
    found: FloatArray = np.linalg.norm(arrows - t[:, :, None] * along[None], axis=2)
    return found


def _between_segments(first: FloatArray, second: FloatArray) -> FloatArray:
    """(n, m) distances between edges of two polygons that do not cross."""
    ends = np.minimum(_to_segments(first, second), np.roll(_to_segments(first, second), -1, axis=0))
    others = _to_segments(second, first).T
    found: FloatArray = np.minimum(ends, np.minimum(others, np.roll(others, -1, axis=1)))
    return found


class PrismContact(Barrier):
    """Barrier energy between rigid prisms, as a function of their corners' positions.

    Parameters
    ----------
    rows : what can meet.
    activation_distance : d_hat, mm.
    stiffness : of the barrier, N mm-3.

    Attributes
    ----------
    memory : distances that kernels measured.
    most : mm, by which scales move until they are measured anew.
    """

    part_names: tuple[str, ...] = ("contact",)

    def __init__(self, rows: PrismRows, activation_distance: float, stiffness: float) -> None:
        super().__init__(activation_distance, stiffness)
        self.rows = rows
        n_pairs = len(rows.table.starts) - 1
        self.memory = Memory(
            np.full((rows.n_rows, 3), np.nan),
            np.zeros(len(rows.table.stencils)),
            np.full(n_pairs, np.inf),
        )
        self.most = _MEMORY * activation_distance

    def positions(self, y: FloatArray) -> FloatArray:
        """(n_rows, 3) mm: the rows are positions."""
        return y

    def spread(self, forces: FloatArray, n_rows: int) -> FloatArray:
        """(n_rows, 3) forces on rows of y for those on corners, which are the rows."""
        return forces

    def energy_parts(self, y: FloatArray) -> FloatArray:
        """(1,) N mm; assumes a state without intersections."""
        energy = barrier_energy(
            y, self.rows.table, self.memory, self.activation_distance, self.most
        )
        return np.array([self.stiffness * energy])

    def closer(self, y: FloatArray, reach: float) -> tuple[IntArray, FloatArray, float]:
        """Candidates closer than a reach, mm, weights of their arrows, and the least distance."""
        table = self.rows.table
        found = np.empty(len(table.stencils), dtype=np.int64)
        shares = np.empty((len(found), 4))
        n, squared = closer_than(y, table, self.memory, reach, self.most, found, shares)
        return found[:n], shares[:n], float(np.sqrt(squared))

    def add_gradient(self, y: FloatArray, gradient: FloatArray) -> None:
        """Add dE/dy [N] to `gradient (n_rows, 3)`."""
        found, _, _ = self.closer(y, self.activation_distance)
        _add_gradient(y, self.rows.table, found, self.activation_distance, self.stiffness, gradient)

    def free_share(self, start: FloatArray, end: FloatArray) -> float:
        """Share of the straight way from y = start to end on which nothing passes through."""
        done, least = 0.0, _LEAST * self.activation_distance
        for _ in range(SWEEPS):
            here = start + done * (end - start) if done else start
            share = all_free_share(
                here, end, self.rows.table, self.memory, self.most, least, MOST_SWEEP_STEPS
            )
            if share >= 1.0:
                return 1.0
            done += (1.0 - done) * share
        return float(done)

    def gaps(self, y: FloatArray, reach: float) -> LinearGaps:
        """Distances of candidates closer than `reach` [mm], linear around y."""
        found, shares, _ = self.closer(y, reach)
        n, stencils = len(found), self.rows.table.stencils[found]
        entries = (shares.ravel(), (np.repeat(np.arange(n), 4), stencils.ravel()))
        matrix = sp.csr_array(entries, shape=(n, len(y)))
        arrows = matrix @ y
        distances = np.linalg.norm(arrows, axis=1)
        pairs = self.rows.pair[stencils[:, 0]] if n else np.zeros(0, dtype=np.int64)
        return LinearGaps(matrix, arrows / distances[:, None], distances, pairs)

    def intersects(self, y: FloatArray) -> bool:
        """Whether scales are in one another."""
        return bool(any_crossing(y, self.rows.table))

    def smallest_distance(self, y: FloatArray, reach: float) -> float:
        """Smallest distance between scales, mm; infinite beyond `reach`."""
        return self.closer(y, reach)[2]

    def active_pairs(self, y: FloatArray) -> int:
        """Number of candidates closer than d_hat."""
        return len(self.closer(y, self.activation_distance)[0])

    def presses(self, y: FloatArray) -> tuple[IntArray, FloatArray, FloatArray]:
        """Where scales press on one another: rows (n, 4) of candidates closer than d_hat, weights
        (n, 2, 4) of these in the nearest points of both things, and lengths (n,) of forces, N."""
        table, d_hat = self.rows.table, self.activation_distance
        found, shares, _ = self.closer(y, d_hat)
        own = np.arange(4) < np.where(table.is_wall[found], 1, 2)[:, None]
        first = np.where(own, shares, 0.0)
        forces, on_rows = np.empty(len(found)), np.zeros_like(y)
        for k, stencil in enumerate(table.stencils[found]):
            _add_gradient(y, table, found[k : k + 1], d_hat, self.stiffness, on_rows)
            forces[k] = np.linalg.norm(on_rows[stencil[own[k]]].sum(axis=0))
            on_rows[stencil] = 0.0
        return table.stencils[found], np.stack([first, first - shares], axis=1), forces

    def force(self, y: FloatArray) -> float:
        """Sum of the contact forces on the first scales' corners, as lengths of vectors, N."""
        forces = np.zeros_like(y)
        self.add_gradient(y, forces)
        return float(np.linalg.norm(forces[~self.rows.table.second], axis=1).sum())


@njit(cache=True, error_model="numpy")
def _add_gradient(
    y: FloatArray,
    table: Candidates,
    found: IntArray,
    d_hat: float,
    stiffness: float,
    gradient: FloatArray,
) -> None:
    work, out = np.empty((N_WORK, _JET)), np.empty(_JET)
    rows = np.zeros((4, 3, _JET))
    for i in range(4):
        for c in range(3):
            rows[i, c, 1 + 3 * i + c] = 1.0
    for s in found:
        for i in range(4):
            for c in range(3):
                rows[i, c, 0] = y[table.stencils[s, i], c]
        if barrier_jet(table.is_wall[s], rows, d_hat * d_hat, work, out, N_ROWS, 1):
            for i in range(4):
                for c in range(3):
                    gradient[table.stencils[s, i], c] += stiffness * out[1 + 3 * i + c]

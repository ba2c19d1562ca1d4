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
from flexscale.mechanics.jets import add_hessian
from flexscale.mechanics.prism_kernels import (
    N,
    all_free_share,
    barrier_jet,
    closer_than,
    total_energy,
)

_BASE, _TOP = 0, 1


@dataclass(frozen=True, eq=False)
class PrismRows:
    """Corners of pairs of neighboring prisms, as rows of world positions, and what can meet.

    Attributes
    ----------
    pair : (n_rows,) pair of scales that a row belongs to; each pair has rows of its own.
    second : (n_rows,) whether it is of the second scale of the pair.
    rest : (n_rows, 3) from the scale's anchor, mm.
    stencils : (n, 4) rows: a corner and three of a wall, or two edges.
    walls : how many of the stencils are corners before walls; they come first.
    """

    pair: IntArray
    second: BoolArray
    rest: FloatArray
    stencils: IntArray
    walls: int


def find_prism_rows(
    outlines: Sequence[FloatArray],
    pairs: Sequence[tuple[int, int]],
    ways: FloatArray,
    heights: tuple[float, float],
    reach: float,
) -> PrismRows:
    """What can meet of pairs of prisms that stand side by side.

    Parameters
    ----------
    outlines : (m_i, 2) of each scale, from its anchor, mm.
    pairs : numbers of both scales of each pair.
    ways : (n_pairs, 2) from the first one's anchor to the second's, mm.
    heights : of bases and tops above the anchors, mm.
    reach : mm in the plane at rest; features farther apart never meet.
    """
    rows: dict[tuple[int, int, int, int], int] = {}
    walls: list[tuple[int, ...]] = []
    edges: list[tuple[int, ...]] = []
    low = heights[_TOP] - heights[_BASE] < reach  # tops of low scales may meet bases

    for number, ((a, b), way) in enumerate(zip(pairs, ways, strict=True)):
        both = (outlines[a], outlines[b] + way)

        def row(side: int, corner: int, level: int, number: int = number, both=both) -> int:
            key = (number, side, corner % len(both[side]), level)
            return rows.setdefault(key, len(rows))

        for side in (0, 1):
            mine, other = both[side], both[1 - side]
            near = _to_segments(mine, other) < reach
            for i, j in zip(*np.nonzero(near), strict=True):
                wall = [
                    row(1 - side, j, _BASE),
                    row(1 - side, j + 1, _BASE),
                    row(1 - side, j, _TOP),
                ]
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
                first = (row(0, i, levels[0]), row(0, i + 1, levels[0]))
                edges.append((*first, row(1, j, levels[1]), row(1, j + 1, levels[1])))
    keys = np.array(list(rows), dtype=np.int64).reshape(-1, 4)
    rest = np.empty((len(keys), 3))
    for k, (number, side, corner, level) in enumerate(keys):
        rest[k, :2] = outlines[pairs[number][side]][corner]
        rest[k, 2] = heights[level]
    stencils = np.array([*walls, *edges], dtype=np.int64).reshape(-1, 4)
    return PrismRows(keys[:, 0], keys[:, 1] == 1, rest, stencils, len(walls))


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
    """Barrier energy between rigid prisms; a `PairEnergy` of their corners' positions.

    Parameters
    ----------
    rows : what can meet.
    activation_distance : d_hat, mm.
    stiffness : of the barrier, N mm-3.
    """

    part_names: tuple[str, ...] = ("contact",)

    def __init__(self, rows: PrismRows, activation_distance: float, stiffness: float) -> None:
        super().__init__(activation_distance, stiffness)
        self.rows = rows

    @property
    def _squared(self) -> float:
        return self.activation_distance**2

    def positions(self, y: FloatArray) -> FloatArray:
        """(n_rows, 3) mm: the rows are positions."""
        return y

    def spread(self, forces: FloatArray, n_rows: int) -> FloatArray:
        """(n_rows, 3) forces on rows of y for those on corners, which are the rows."""
        return forces

    def energy_parts(self, y: FloatArray) -> FloatArray:
        """(1,) N mm; assumes a state without intersections."""
        energy, _, _ = total_energy(y, self.rows.stencils, self.rows.walls, self._squared)
        return np.array([self.stiffness * energy])

    def derivatives(
        self, y: FloatArray, project: bool = False
    ) -> tuple[IntArray, FloatArray, FloatArray]:
        """Stencils (n, 4) that act, their gradients (n, 12) and Hessians (n, 12, 12).

        With `project`, the positive parts of the Hessians.
        """
        found = np.empty(len(self.rows.stencils), dtype=np.int64)
        shares = np.empty((len(found), 4))
        args = (y, self.rows.stencils, self.rows.walls)
        n = closer_than(*args, self._squared, found, shares)
        gradients, hessians = np.empty((n, N)), np.empty((n, N, N))
        _fill_derivatives(*args, self._squared, self.stiffness, found[:n], gradients, hessians)
        if project and n:
            values, modes = np.linalg.eigh(hessians)
            modes *= np.sqrt(np.maximum(values, 0.0))[:, None, :]
            hessians = modes @ modes.transpose(0, 2, 1)
        return self.rows.stencils[found[:n]], gradients, hessians

    def add_gradient(self, y: FloatArray, gradient: FloatArray) -> None:
        """Add dE/dy [N] to `gradient (n_rows, 3)`."""
        stencils, slopes, _ = self.derivatives(y)
        np.add.at(gradient, stencils.ravel(), slopes.reshape(-1, 3))

    def pair_blocks(self, y: FloatArray, project: bool = False) -> tuple[IntArray, FloatArray]:
        """Pairs (n, 2) of rows, a <= b, and blocks (n, 3, 3) of d2E/dy2 or its positive part."""
        stencils, _, hessians = self.derivatives(y, project)
        blocks = hessians.reshape(-1, 4, 3, 4, 3).transpose(0, 1, 3, 2, 4).reshape(-1, 3, 3)
        pairs = np.stack(np.broadcast_arrays(stencils[:, :, None], stencils[:, None, :]), axis=-1)
        pairs = pairs.reshape(-1, 2)
        kept = pairs[:, 0] <= pairs[:, 1]
        return pairs[kept], blocks[kept]

    def near_pairs(self, y: FloatArray) -> IntArray:
        """(0, 2): neighbors have room in the Hessian whether they touch or not."""
        return np.zeros((0, 2), dtype=np.int64)

    def free_share(self, start: FloatArray, end: FloatArray) -> float:
        """Share of the straight way from y = start to end on which nothing passes through."""
        done = 0.0
        for _ in range(SWEEPS):
            here = start + done * (end - start)
            share = all_free_share(here, end, self.rows.stencils, self.rows.walls, MOST_SWEEP_STEPS)
            if share >= 1.0:
                return 1.0
            done += (1.0 - done) * share
        return float(done)

    def gaps(self, y: FloatArray, reach: float) -> LinearGaps:
        """Distances of candidates closer than `reach` [mm], linear around y."""
        found = np.empty(len(self.rows.stencils), dtype=np.int64)
        shares = np.empty((len(found), 4))
        n = closer_than(y, self.rows.stencils, self.rows.walls, reach**2, found, shares)
        stencils = self.rows.stencils[found[:n]]
        entries = (shares[:n].ravel(), (np.repeat(np.arange(n), 4), stencils.ravel()))
        matrix = sp.csr_array(entries, shape=(n, len(y)))
        arrows = matrix @ y
        distances = np.linalg.norm(arrows, axis=1)
        pairs = self.rows.pair[stencils[:, 0]] if n else np.zeros(0, dtype=np.int64)
        return LinearGaps(matrix, arrows / distances[:, None], distances, pairs)

    def intersects(self, y: FloatArray) -> bool:
        """Whether things that can meet are in one another: at rest, neighbors stand apart."""
        return self.smallest_distance(y, np.inf) <= 0.0

    def smallest_distance(self, y: FloatArray, reach: float) -> float:
        """Smallest distance between scales, mm; infinite beyond `reach`."""
        squared = total_energy(y, self.rows.stencils, self.rows.walls, self._squared)[2]
        return float(np.sqrt(squared)) if squared < reach**2 else float("inf")

    def active_pairs(self, y: FloatArray) -> int:
        """Number of candidates closer than d_hat."""
        return int(total_energy(y, self.rows.stencils, self.rows.walls, self._squared)[1])

    def force(self, y: FloatArray) -> float:
        """Sum of the contact forces on the first scales' corners, as lengths of vectors, N."""
        forces = np.zeros_like(y)
        self.add_gradient(y, forces)
        return float(np.linalg.norm(forces[~self.rows.second], axis=1).sum())


@njit(cache=True, error_model="numpy")
def _fill_derivatives(
    y: FloatArray,
    stencils: IntArray,
    walls: int,
    squared: float,
    stiffness: float,
    found: IntArray,
    gradients: FloatArray,
    hessians: FloatArray,
) -> None:
    size = 1 + N + N * N
    work, out, x = np.empty((16, size)), np.empty(size), np.empty((4, 3))
    for m in range(len(found)):
        k = found[m]
        for i in range(4):
            x[i] = y[stencils[k, i]]
        barrier_jet(k < walls, x, squared, work, out)
        for i in range(N):
            gradients[m, i] = stiffness * out[1 + i]
        hessians[m] = 0.0
        add_hessian(hessians[m], stiffness, out, N)

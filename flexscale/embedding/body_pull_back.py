"""Sparse Hessian of a cell whose scales are bodies.

The inner pull-back assembles the sheet's Hessian in the bodies' points and vectors; their
Jacobians J then turn their rows and columns into those of the bodies' unknowns. Contact acts on
bodies alone, and all bodies of a cell are taken to be coupled with one another: the pattern never
changes.
"""

from __future__ import annotations

import itertools

import numpy as np
import scipy.sparse as sp

from flexscale.embedding.body_map import BodyMap, BodySecondOrder, BodyWorld
from flexscale.embedding.pull_back import PairBlocks, PullBack
from flexscale.mechanics.energy import NOTHING, FloatArray, IntArray, PairEnergy


class BodyPullBack:
    """Assembles the Hessian in the active unknowns; the same interface as `PullBack`.

    Parameters
    ----------
    body_map : the map z -> y.
    inner : pull-back of the sheet on all unknowns of the inner map, in its order.
    active : (n_active,) indices into z.
    contact : contact energy between bodies; None without.
    """

    def __init__(
        self,
        body_map: BodyMap,
        inner: PullBack,
        active: IntArray,
        contact: PairEnergy | None = None,
    ) -> None:
        self.map, self.inner, self.contact = body_map, inner, contact
        self.n_active = len(active)
        self._position = np.full(body_map.n_unknowns, -1, dtype=np.int64)
        self._position[active] = np.arange(self.n_active)
        self._n_points = 3 * int(body_map.point_starts[-1])
        self._n_bodies = int(body_map.starts[-1])
        self._split_inner()
        self._build_pattern()

    def _split_inner(self) -> None:
        """Parts of the inner matrix: points with points, sheet with points, sheet with sheet."""
        m, n = self._n_points, len(self.inner.indptr) - 1
        rows = np.repeat(np.arange(n), np.diff(self.inner.indptr))
        columns = self.inner.indices
        slots = np.arange(len(columns)) + 1  # 0 would be dropped
        on_points = (rows < m) & (columns < m)
        mixed = (rows < m) & (columns >= m)
        self._sheet_entries = np.flatnonzero((rows >= m) & (columns >= m))
        self._sheet_pairs = (rows[self._sheet_entries] - m, columns[self._sheet_entries] - m)
        below = on_points & (rows != columns)
        points = sp.csr_array(
            (
                np.concatenate([slots[on_points], slots[below]]),
                (
                    np.concatenate([rows[on_points], columns[below]]),
                    np.concatenate([columns[on_points], rows[below]]),
                ),
            ),
            shape=(m, m),
        )
        coupling = sp.csr_array((slots[mixed], (columns[mixed] - m, rows[mixed])), shape=(n - m, m))
        starts = 3 * self.map.point_starts
        self._point_blocks, self._couplings = [], []
        for k, (a, b) in enumerate(itertools.pairwise(starts)):
            for j, (c, d) in enumerate(itertools.pairwise(starts)):
                block = sp.csr_array(points[a:b, c:d])
                if j >= k and block.nnz:
                    self._point_blocks.append((k, j, block))
            part = sp.csr_array(coupling[:, a:b])
            used = np.flatnonzero(np.diff(part.indptr))
            self._couplings.append((used, sp.csr_array(part[used])))

    def _build_pattern(self) -> None:
        """CSR pattern of the upper triangle, and where each part's values go in it."""
        n_bodies, n = self._n_bodies, self.map.n_unknowns
        bodies = np.arange(n_bodies)
        stretch = np.arange(n - 3, n)
        dense = np.concatenate([bodies, stretch])
        pairs = [_all_pairs(dense, dense)]
        self._sheet_rows = []
        for k, (used, _) in enumerate(self._couplings):
            own = np.arange(self.map.starts[k], self.map.starts[k + 1])
            self._sheet_rows.append(_all_pairs(n_bodies + used, own))
        pairs += [*self._sheet_rows, np.stack(self._sheet_pairs) + n_bodies]
        low_high = [self._ordered(part) for part in pairs]
        keys = np.concatenate([p[0] * self.n_active + p[1] for p in low_high])
        kept = np.concatenate([p[2] for p in low_high])
        diagonal = np.arange(self.n_active) * (self.n_active + 1)
        unique = np.unique(np.concatenate([keys[kept], diagonal]))
        self.indptr = np.searchsorted(unique, np.arange(self.n_active + 1) * self.n_active)
        self.indices = unique % self.n_active
        self._dense, self._unique = dense, unique
        slots = [np.where(p[2], np.searchsorted(unique, p[0] * self.n_active + p[1]), len(unique))
                 for p in low_high]  # fmt: skip
        self._dense_slots = slots[0].reshape(len(dense), len(dense))
        # The whole square is summed up: its lower half goes to the slot that is dropped.
        self._dense_slots[np.tril_indices(len(dense), -1)] = len(unique)
        self._row_slots = slots[1:-1]
        self._sheet_slots = slots[-1]

    def _ordered(self, pairs: IntArray) -> tuple[IntArray, IntArray, np.ndarray]:
        first, second = self._position[pairs[0]], self._position[pairs[1]]
        kept = (first >= 0) & (second >= 0)
        return np.minimum(first, second), np.maximum(first, second), kept

    @property
    def diagonal(self) -> IntArray:
        """(n_active,) slots of the diagonal."""
        return self.indptr[:-1].astype(np.int64)

    def cover(self, y: FloatArray) -> bool:
        """There is room for contact at all states."""
        return False

    def fit_room(self, y: FloatArray) -> bool:
        """There is room for contact at all states."""
        return False

    def pair_blocks(self, y: FloatArray, project: str = NOTHING) -> PairBlocks:
        """Blocks of d2E/dy2, optionally of a positive part of contact or of all."""
        found = self.inner.pair_blocks(y, project)
        if self.contact is None:
            return found
        touching, blocks = self.contact.pair_blocks(y, project != NOTHING)
        return PairBlocks(
            np.concatenate([found.pairs, touching]), np.concatenate([found.blocks, blocks])
        )

    def multiply(self, blocks: PairBlocks, rates: FloatArray) -> FloatArray:
        """(n_rows, 3): d2E/dy2 applied to rates (n_rows, 3)."""
        return self.inner.multiply(blocks, rates)

    def hessian(
        self, world: BodyWorld, blocks: PairBlocks, forces: FloatArray, second: BodySecondOrder
    ) -> FloatArray:
        """(nnz,) values of the upper triangle; see `PullBack.hessian`."""
        n = self.inner.n_pairs
        on_elements = PairBlocks(blocks.pairs[:n], blocks.blocks[:n])
        inner = self.inner.hessian(world.inner, on_elements, forces, second.inner)
        values = np.zeros(len(self.indices) + 1)
        values[self._sheet_slots] = inner[self._sheet_entries]
        dense = np.zeros((len(self._dense),) * 2)
        for k, block in enumerate(second.blocks):
            own = slice(self.map.starts[k], self.map.starts[k + 1])
            dense[own, own] += block
        jacobians = world.bodies.jacobians
        for k, j, pattern in self._point_blocks:
            block = _fill(pattern, inner) @ jacobians[j]
            self._add(dense, k, j, jacobians[k].T @ block)
        for k, (_, pattern) in enumerate(self._couplings):
            values[self._row_slots[k]] += (_fill(pattern, inner) @ jacobians[k]).ravel()
        self._add_contact(dense, world, blocks.pairs[n:], blocks.blocks[n:])
        # One entry of the square for each slot, but for those of S with S, which the sheet has too.
        values[self._dense_slots.ravel()] += dense.ravel()
        return values[:-1]

    def _add(self, dense: FloatArray, k: int, j: int, block: FloatArray) -> None:
        first = slice(self.map.starts[k], self.map.starts[k + 1])
        second = slice(self.map.starts[j], self.map.starts[j + 1])
        dense[first, second] += block
        if k != j:
            dense[second, first] += block.T

    def _add_contact(
        self, dense: FloatArray, world: BodyWorld, pairs: IntArray, blocks: FloatArray
    ) -> None:
        """Pull the blocks of touching rows back to the bodies and S."""
        if not len(pairs):
            return
        rows, local = np.unique(pairs, return_inverse=True)
        local = local.reshape(-1, 2)
        jacobian = self._row_jacobian(world, rows)
        off = local[:, 0] != local[:, 1]
        index = np.concatenate([local, local[off][:, ::-1]])
        data = np.concatenate([blocks, np.swapaxes(blocks[off], 1, 2)])
        order = np.lexsort((index[:, 1], index[:, 0]))
        indptr = np.searchsorted(index[order, 0], np.arange(len(rows) + 1))
        matrix = sp.bsr_array(
            (data[order], index[order, 1], indptr), shape=(3 * len(rows), 3 * len(rows))
        )
        dense += jacobian.T @ (matrix @ jacobian)

    def _row_jacobian(self, world: BodyWorld, rows: IntArray) -> FloatArray:
        """(3 n, n_bodies + 3) of rows that are images of single points: dy/d(bodies, S)."""
        inner, n_bodies = self.map.inner, self._n_bodies
        images = inner.terms[inner.term_indptr[rows]]
        points = inner.images.nodes[images] // 3
        jacobian = np.zeros((len(rows), 3, n_bodies + 3))
        jacobian[:, :, n_bodies:] = world.inner.image_jacobian[images, :, 3:]
        home = world.inner.image_jacobian[images, :, :3]
        owner = np.searchsorted(self.map.point_starts, points, side="right") - 1
        for k in np.unique(owner):
            mine = np.flatnonzero(owner == k)
            own = slice(self.map.starts[k], self.map.starts[k + 1])
            whole = world.bodies.jacobians[k].reshape(-1, 3, self.map.bodies[k].n_unknowns)
            jacobian[mine, :, own] = home[mine] @ whole[points[mine] - self.map.point_starts[k]]
        return jacobian.reshape(3 * len(rows), -1)

    def kappa_rate(
        self, world: BodyWorld, blocks: PairBlocks, forces: FloatArray, second: BodySecondOrder
    ) -> FloatArray:
        """(n_unknowns,) d(dE/dz)/dkappa at fixed z."""
        rate = self.inner.kappa_rate(world.inner, blocks, forces, second.inner)
        out = self.map.pull_zeta(world, rate)
        for start, mixed in zip(self.map.starts[:-1], second.mixed, strict=True):
            out[start : start + len(mixed)] += mixed
        return out


def _all_pairs(first: IntArray, second: IntArray) -> IntArray:
    return np.stack(np.meshgrid(first, second, indexing="ij")).reshape(2, -1)


def _fill(pattern: sp.csr_array, values: FloatArray) -> sp.csr_array:
    """The matrix whose data are places in `values`, plus 1."""
    return sp.csr_array(
        (values[pattern.data - 1], pattern.indices, pattern.indptr), shape=pattern.shape
    )

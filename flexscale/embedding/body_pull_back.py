"""Sparse Hessian of a cell whose scales are bodies.

The inner pull-back assembles the sheet's Hessian in the bodies' points and vectors; their
Jacobians J then turn their rows and columns into those of the bodies' unknowns. Contact acts on
bodies alone. Bodies are coupled where the sheet or contact's reach makes them neighbors: the
pattern has room for contact at all states, and grows only if others should ever meet.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable

import numpy as np
import scipy.sparse as sp

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.body_map import BodyMap, BodySecondOrder, BodyWorld
from flexscale.embedding.pull_back import PairBlocks, PullBack
from flexscale.mechanics.contact import ScaleContact
from flexscale.mechanics.energy import NOTHING


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
        contact: ScaleContact | None = None,
    ) -> None:
        self.map, self.inner, self.contact = body_map, inner, contact
        self.n_active = len(active)
        self._position = np.full(body_map.n_unknowns, -1, dtype=np.int64)
        self._position[active] = np.arange(self.n_active)
        self._n_points = 3 * int(body_map.point_starts[-1])
        self._n_bodies = int(body_map.starts[-1])
        self._split_inner()
        coupled = {(k, j) for k, j, _ in self._point_blocks}
        if contact is not None:
            coupled |= {(k, j) for k, j in contact.surface.neighbors.tolist()}
        own = {(k, k) for k in range(len(body_map.bodies))}
        self._neighbors = coupled | own
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
        stretch = np.arange(n - 3, n)
        own = [np.arange(a, b) for a, b in itertools.pairwise(self.map.starts)]
        parts = {(k, j): _all_pairs(own[k], own[j]) for k, j in sorted(self._neighbors)}
        borders = [_all_pairs(own[k], stretch) for k in range(len(own))]
        sheet_rows = [
            _all_pairs(n_bodies + used, own[k]) for k, (used, _) in enumerate(self._couplings)
        ]
        sheet = np.stack(self._sheet_pairs) + n_bodies
        corner = _all_pairs(stretch, stretch)
        everything = [*parts.values(), *borders, corner, *sheet_rows, sheet]
        low_high = [self._ordered(part) for part in everything]
        keys = np.concatenate([p[0] * self.n_active + p[1] for p in low_high])
        kept = np.concatenate([p[2] for p in low_high])
        diagonal = np.arange(self.n_active) * (self.n_active + 1)
        unique = np.unique(np.concatenate([keys[kept], diagonal]))
        self.indptr = np.searchsorted(unique, np.arange(self.n_active + 1) * self.n_active)
        self.indices = unique % self.n_active
        slots = [np.where(p[2], np.searchsorted(unique, p[0] * self.n_active + p[1]), len(unique))
                 for p in low_high]  # fmt: skip
        self._block_slots = {}
        for (k, j), block in zip(parts, slots, strict=False):
            square = block.reshape(len(own[k]), len(own[j]))
            if k == j:  # the whole square is summed up: its lower half goes to the slot dropped
                square[np.tril_indices(len(square), -1)] = len(unique)
            self._block_slots[k, j] = square
        slots = slots[len(parts) :]
        self._border_slots = [block.reshape(-1, 3) for block in slots[: len(own)]]
        self._stretch_slots = slots[len(own)].reshape(3, 3)
        self._stretch_slots[np.tril_indices(3, -1)] = len(unique)
        self._row_slots = slots[len(own) + 1 : -1]
        self._sheet_slots = slots[-1]

    def _ordered(self, pairs: IntArray) -> tuple[IntArray, IntArray, np.ndarray]:
        first, second = self._position[pairs[0]], self._position[pairs[1]]
        kept = (first >= 0) & (second >= 0)
        return np.minimum(first, second), np.maximum(first, second), kept

    @property
    def diagonal(self) -> IntArray:
        """(n_active,) slots of the diagonal."""
        return self.indptr[:-1].astype(np.int64)

    @property
    def groups(self) -> IntArray:
        """(n_active,) body of each unknown, -1 for the sheet's; S is a group of its own, the last
        one."""
        owner = np.full(self.map.n_unknowns, -1, dtype=np.int64)
        n_bodies = len(self.map.bodies)
        owner[: self._n_bodies] = np.repeat(np.arange(n_bodies), np.diff(self.map.starts))
        owner[-3:] = n_bodies
        found = np.empty(self.n_active, dtype=np.int64)
        used = self._position >= 0
        found[self._position[used]] = owner[used]
        return found

    def cover(self, y: FloatArray) -> bool:
        """Make room for bodies that meet and are no neighbors; True if the pattern grew."""
        n = len(self.map.bodies)
        if self.contact is None or 2 * len(self._neighbors) == n * (n + 1):  # all are coupled
            return False
        pairs, _ = self.contact.pair_blocks(y)
        owners = np.sort(self._owners(pairs), axis=1)
        meeting = {(int(k), int(j)) for k, j in np.unique(owners, axis=0)}
        if meeting <= self._neighbors:
            return False
        self._neighbors |= meeting
        self._build_pattern()
        return True

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
        parts = _Parts(self.map.starts, self._neighbors)
        for k, own in enumerate(second.blocks):
            parts.blocks[k, k] += own
        jacobians = world.bodies.jacobians
        for k, j, pattern in self._point_blocks:
            parts.blocks[k, j] += jacobians[k].T @ (_fill(pattern, inner) @ jacobians[j])
        for k, (_, pattern) in enumerate(self._couplings):
            values[self._row_slots[k]] += (_fill(pattern, inner) @ jacobians[k]).ravel()
        self._add_contact(parts, world, blocks.pairs[n:], blocks.blocks[n:])
        # One entry of a block for each slot, but for those of S, which the sheet has too.
        for key, block in parts.blocks.items():
            values[self._block_slots[key]] += block
        for slots, block in zip(self._border_slots, parts.borders, strict=True):
            values[slots] += block
        values[self._stretch_slots] += parts.stretch
        return values[:-1]

    def _add_contact(
        self, parts: _Parts, world: BodyWorld, pairs: IntArray, blocks: FloatArray
    ) -> None:
        """Pull the blocks of touching rows back to the bodies and S, two bodies at a time."""
        if not len(pairs):
            return
        off = pairs[:, 0] != pairs[:, 1]
        index = np.concatenate([pairs, pairs[off][:, ::-1]])
        data = np.concatenate([blocks, np.swapaxes(blocks[off], 1, 2)])
        owners = self._owners(index)
        for k, j in np.unique(owners[owners[:, 0] <= owners[:, 1]], axis=0).tolist():
            here = np.all(owners == (k, j), axis=1)
            first, row = np.unique(index[here, 0], return_inverse=True)
            second, column = np.unique(index[here, 1], return_inverse=True)
            order = np.lexsort((column, row))
            indptr = np.searchsorted(row[order], np.arange(len(first) + 1))
            matrix = sp.bsr_array(
                (data[here][order], column[order], indptr),
                shape=(3 * len(first), 3 * len(second)),
            )
            left = self._row_jacobian(world, first, k)
            right = left if k == j else self._row_jacobian(world, second, j)
            parts.add(k, j, left.T @ (matrix @ right))

    def _owners(self, rows: IntArray) -> IntArray:
        """Bodies of rows that are images of single points."""
        inner = self.map.inner
        points = inner.images.nodes[inner.terms[inner.term_indptr[rows]]] // 3
        found = np.searchsorted(self.map.point_starts, points, side="right") - 1
        return np.asarray(found, dtype=np.int64)

    def _row_jacobian(self, world: BodyWorld, rows: IntArray, k: int) -> FloatArray:
        """(3 n, n_k + 3) of rows that are images of points of body k: dy/d(its unknowns, S)."""
        inner, body = self.map.inner, self.map.bodies[k]
        images = inner.terms[inner.term_indptr[rows]]
        points = inner.images.nodes[images] // 3 - self.map.point_starts[k]
        whole = world.bodies.jacobians[k].reshape(-1, 3, body.n_unknowns)
        image = world.inner.image_jacobian[images]
        jacobian = np.concatenate([image[:, :, :3] @ whole[points], image[:, :, 3:]], axis=2)
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


class _Parts:
    """Blocks of the Hessian among the bodies and S; those of k <= j, and whole squares for k = j.

    Attributes
    ----------
    blocks : (n_k, n_j) of neighbors k, j.
    borders : (n_k, 3) of each body with S.
    stretch : (3, 3) of S with S.
    """

    def __init__(self, starts: IntArray, neighbors: Iterable[tuple[int, int]]) -> None:
        sizes = np.diff(starts)
        self.blocks = {(k, j): np.zeros((sizes[k], sizes[j])) for k, j in neighbors}
        self.borders = [np.zeros((size, 3)) for size in sizes]
        self.stretch = np.zeros((3, 3))

    def add(self, k: int, j: int, pulled: FloatArray) -> None:
        """Add what the rows of bodies k and j contribute, (n_k + 3, n_j + 3), k <= j."""
        self.blocks[k, j] += pulled[:-3, :-3]
        self.borders[k] += pulled[:-3, -3:]
        self.stretch += pulled[-3:, -3:]
        if k != j:
            self.borders[j] += pulled[-3:, :-3].T
            self.stretch += pulled[-3:, -3:].T


def _all_pairs(first: IntArray, second: IntArray) -> IntArray:
    return np.stack(np.meshgrid(first, second, indexing="ij")).reshape(2, -1)


def _fill(pattern: sp.csr_array, values: FloatArray) -> sp.csr_array:
    """The matrix whose data are places in `values`, plus 1."""
    return sp.csr_array(
        (values[pattern.data - 1], pattern.indices, pattern.indptr), shape=pattern.shape
    )

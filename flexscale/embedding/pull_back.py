"""Sparse Hessian of the pulled-back energy: H = J^T (d2E/dy2) J + sum dE/dy . d2y/dz2.

The pattern is found once per mesh; every later assembly adds into known slots. Only the upper
triangle is kept. Element blocks are first summed into blocks of world-vector pairs (a, b), a <= b,
so that each pair is pulled back once however many elements share it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp
from numba import njit

from flexscale.embedding.world_map import SecondOrder, World, WorldMap
from flexscale.mechanics.energy import (
    ALL,
    NOTHING,
    Energy,
    FloatArray,
    IntArray,
    PairEnergy,
    block_pairs,
    project_blocks,
)


class PullBack:
    """Assembles the Hessian in the active unknowns.

    Parameters
    ----------
    world_map : the map z -> y.
    energies : energies over the rows of y; their elements fix the pattern of nonzeros.
    contact : contact energy, whose pairs of rows change; None without.
    contact_pairs : (n, 2) pairs of rows, a < b, that get room from the start.
    active : (n_active,) indices into z that are unknowns of the linear systems.

    Attributes
    ----------
    indptr, indices : CSR pattern of the upper triangle, (n_active + 1,) and (nnz,), diagonal
        included.
    """

    def __init__(
        self,
        world_map: WorldMap,
        energies: Sequence[Energy],
        active: IntArray,
        contact: PairEnergy | None = None,
        contact_pairs: IntArray | None = None,
    ) -> None:
        self.world_map = world_map
        self.energies = tuple(energies)
        self.contact = contact
        self._position = np.full(world_map.n_unknowns, -1, dtype=np.int64)
        self._position[active] = np.arange(len(active))
        self.n_active = len(active)
        none = np.zeros((0, 2), dtype=np.int64)
        self._contact_pairs = none if contact_pairs is None else contact_pairs
        self._build(self._contact_pairs)
        self._grown = False

    def _build(self, contact_pairs: IntArray) -> None:
        self._number_pairs(contact_pairs)
        self.indptr, self.indices = self._pattern(self._position)
        self.diagonal = self.indptr[:-1].astype(np.int64)
        self._slots(self._position)

    def cover(self, y: FloatArray) -> bool:
        """Make room for the contact pairs at a state; True if the pattern grew."""
        if self.contact is None:
            return False
        pairs, _ = self.contact.pair_blocks(y)
        if not len(pairs) or np.isin(self._keys_of(pairs), self._keys).all():
            return False
        self._build(np.concatenate([self.pairs, pairs]))
        self._grown = True
        return True

    def reset(self) -> bool:
        """Back to the pairs given at the start; True if the pattern had grown."""
        grown, self._grown = self._grown, False
        if grown:
            self._build(self._contact_pairs)
        return grown

    def _keys_of(self, pairs: IntArray) -> IntArray:
        return np.asarray(pairs[:, 0] * self.world_map.n_rows + pairs[:, 1])

    def _number_pairs(self, contact_pairs: IntArray) -> None:
        n = self.world_map.n_rows
        keys = [self._keys_of(contact_pairs)]
        for energy in self.energies:
            i, j = block_pairs(energy.vectors.shape[1])
            first, second = energy.vectors[:, i], energy.vectors[:, j]
            keys.append(np.minimum(first, second) * n + np.maximum(first, second))
        unique = np.unique(np.concatenate([k.ravel() for k in keys]))
        self._keys = unique
        self.pairs = np.stack([unique // n, unique % n], axis=1)
        self._element_pairs, self._element_flips = [], []
        for energy, key in zip(self.energies, keys[1:], strict=True):
            i, j = block_pairs(energy.vectors.shape[1])
            self._element_pairs.append(np.searchsorted(unique, key))
            self._element_flips.append(energy.vectors[:, i] > energy.vectors[:, j])

    def _pattern(self, position: IntArray) -> tuple[IntArray, IntArray]:
        m = self.world_map
        columns = position[m.columns]
        rows = np.repeat(np.arange(m.n_rows), np.diff(m.indptr))
        kept = columns >= 0
        ones = np.ones(int(kept.sum()), dtype=np.float32)
        jacobian = sp.csr_array(
            (ones, (rows[kept], columns[kept])), shape=(m.n_rows, self.n_active)
        )
        ones = np.ones(len(self.pairs), dtype=np.float32)
        blocks = sp.csr_array((ones, self.pairs.T), shape=(m.n_rows, m.n_rows))
        blocks = blocks + blocks.T
        product = jacobian.T @ (blocks @ jacobian)
        upper = sp.csr_array(sp.triu(product + sp.eye_array(self.n_active, dtype=np.float32)))
        upper.sort_indices()
        return upper.indptr.astype(np.int64), upper.indices.astype(np.int64)

    def _slots(self, position: IntArray) -> None:
        m = self.world_map
        columns = position[m.columns]
        widths = np.diff(m.indptr)
        counts = widths[self.pairs[:, 0]] * widths[self.pairs[:, 1]]
        self._pair_indptr = np.concatenate([[0], np.cumsum(counts)])
        self._pair_slots = np.empty(self._pair_indptr[-1], dtype=np.int32)
        csr = (self.indptr, self.indices)
        _find_pair_slots(self.pairs, m.indptr, columns, self._pair_indptr, *csr, self._pair_slots)
        images = m.images
        local = np.empty((len(images.kinds), 6), dtype=np.int64)
        shifted = np.any(images.shifts != 0.0, axis=1)
        for c in range(3):
            local[:, c] = position[images.nodes + c]
            local[:, 3 + c] = np.where(shifted, position[m.n_unknowns - 3 + c], -1)
        self._image_slots = np.empty((len(images.kinds), 6, 6), dtype=np.int32)
        _find_image_slots(local, *csr, self._image_slots)
        slide_columns = np.where(m.slide >= 0, position[m.slide], -1)
        self._slide_slots = np.full((len(columns), 2), len(self.indices), dtype=np.int32)
        _find_slide_slots(slide_columns, m.indptr, columns, *csr, self._slide_slots)

    def pair_blocks(self, y: FloatArray, project: str = NOTHING) -> FloatArray:
        """(n_pairs, 3, 3) blocks of d2E/dy2, optionally of a positive part of contact or of all."""
        out = np.zeros((len(self.pairs), 3, 3))
        for energy, pairs, flips in zip(
            self.energies, self._element_pairs, self._element_flips, strict=True
        ):
            blocks = energy.hessian_blocks(y)
            if project == ALL:
                blocks = project_blocks(blocks, energy.vectors.shape[1])
            _gather(blocks, pairs, flips, out)
        if self.contact is not None:
            contact_pairs, blocks = self.contact.pair_blocks(y, project != NOTHING)
            np.add.at(out, np.searchsorted(self._keys, self._keys_of(contact_pairs)), blocks)
        return out

    def multiply(self, blocks: FloatArray, rates: FloatArray) -> FloatArray:
        """(n_rows, 3): d2E/dy2 applied to rates (n_rows, 3)."""
        out = np.zeros_like(rates)
        _multiply_pairs(self.pairs, blocks, rates, out)
        return out

    def hessian(
        self, world: World, blocks: FloatArray, forces: FloatArray, second: SecondOrder
    ) -> FloatArray:
        """(nnz,) values of the upper triangle on the fixed pattern.

        `blocks` from `pair_blocks`; `forces` = dE/dy and `second` = `WorldMap.second_order`, the
        map's own part.
        """
        m = self.world_map
        values = np.zeros(len(self.indices) + 1)  # the last slot swallows entries that are not kept
        _pull_pairs(
            self.pairs,
            blocks,
            m.indptr,
            m.columns,
            world.jacobian,
            self._pair_indptr,
            self._pair_slots,
            values,
        )
        _add_images(second.hessian, self._image_slots, values)
        _add_slides(
            m.slide, m.indptr, m.term_indptr, m.terms, m.weights, m.shifted, forces,
            world.image_jacobian, self._slide_slots, values,
        )  # fmt: skip
        return values[:-1]

    def kappa_rate(
        self, world: World, blocks: FloatArray, forces: FloatArray, second: SecondOrder
    ) -> FloatArray:
        """(n_unknowns,) d(dE/dz)/dkappa at fixed z, for prediction along a sweep."""
        m = self.world_map
        out = m.pull_gradient(world, self.multiply(blocks, world.kappa_rate))
        for c in range(3):
            np.add.at(out, m.images.nodes + c, second.mixed[:, c])
            out[m.n_unknowns - 3 + c] += second.mixed[:, 3 + c].sum()
        _add_slide_rates(
            m.slide, m.term_indptr, m.terms, m.weights, forces, world.image_kappa_rate, out
        )
        return out


@njit(cache=True)
def _slot(i, j, indptr, indices):
    """Slot of (i, j) in the upper triangle; the extra slot if either is not an active unknown."""
    if i < 0 or j < 0:
        return len(indices)
    row, column = min(i, j), max(i, j)
    low, high = indptr[row], indptr[row + 1]
    while low < high:
        middle = (low + high) // 2
        if indices[middle] < column:
            low = middle + 1
        else:
            high = middle
    return low


@njit(cache=True)
def _find_pair_slots(pairs, row_indptr, columns, pair_indptr, indptr, indices, slots):
    for p in range(len(pairs)):
        a, b = pairs[p]
        k = pair_indptr[p]
        for i in range(row_indptr[a], row_indptr[a + 1]):
            for j in range(row_indptr[b], row_indptr[b + 1]):
                if a == b and j < i:
                    slots[k] = len(indices)
                else:
                    slots[k] = _slot(columns[i], columns[j], indptr, indices)
                k += 1


@njit(cache=True)
def _find_image_slots(local, indptr, indices, slots):
    for n in range(len(local)):
        for i in range(6):
            for j in range(6):
                slots[n, i, j] = (
                    _slot(local[n, i], local[n, j], indptr, indices) if i <= j else len(indices)
                )


@njit(cache=True)
def _find_slide_slots(slide_columns, row_indptr, columns, indptr, indices, slots):
    for r in range(len(slide_columns)):
        if slide_columns[r] >= 0:
            for k in range(row_indptr[r], row_indptr[r + 1] - 2):
                slots[k, 0] = _slot(slide_columns[r], columns[k], indptr, indices)
                slots[k, 1] = _slot(slide_columns[r] + 1, columns[k], indptr, indices)


@njit(cache=True)
def _gather(blocks, pairs, flips, out):
    for e in range(blocks.shape[0]):
        for p in range(blocks.shape[1]):
            target = out[pairs[e, p]]
            for r in range(3):
                for c in range(3):
                    target[r, c] += blocks[e, p, c, r] if flips[e, p] else blocks[e, p, r, c]


@njit(cache=True)
def _multiply_pairs(pairs, blocks, rates, out):
    for p in range(len(pairs)):
        a, b = pairs[p]
        for r in range(3):
            for c in range(3):
                out[a, r] += blocks[p, r, c] * rates[b, c]
                if a != b:
                    out[b, c] += blocks[p, r, c] * rates[a, r]


@njit(cache=True)
def _pull_pairs(pairs, blocks, row_indptr, columns, jacobian, pair_indptr, slots, values):
    for p in range(len(pairs)):
        a, b = pairs[p]
        k = pair_indptr[p]
        m = blocks[p]
        for i in range(row_indptr[a], row_indptr[a + 1]):
            u0 = jacobian[i, 0] * m[0, 0] + jacobian[i, 1] * m[1, 0] + jacobian[i, 2] * m[2, 0]
            u1 = jacobian[i, 0] * m[0, 1] + jacobian[i, 1] * m[1, 1] + jacobian[i, 2] * m[2, 1]
            u2 = jacobian[i, 0] * m[0, 2] + jacobian[i, 1] * m[1, 2] + jacobian[i, 2] * m[2, 2]
            for j in range(row_indptr[b], row_indptr[b + 1]):
                value = u0 * jacobian[j, 0] + u1 * jacobian[j, 1] + u2 * jacobian[j, 2]
                # An unknown shared by two different rows meets itself in (a, b) and in (b, a).
                if a != b and columns[i] == columns[j]:
                    value *= 2.0
                values[slots[k]] += value
                k += 1


@njit(cache=True)
def _add_images(hessian, slots, values):
    for n in range(len(hessian)):
        for i in range(6):
            for j in range(i, 6):
                values[slots[n, i, j]] += hessian[n, i, j]


@njit(cache=True)
def _add_slides(
    slide, row_indptr, term_indptr, terms, weights, shifted, forces, image_jacobian, slots, values
):
    for r in range(len(slide)):
        if slide[r] < 0:
            continue
        k = row_indptr[r]
        stretch = k + 3 * (term_indptr[r + 1] - term_indptr[r])
        for t in range(term_indptr[r], term_indptr[r + 1]):
            j = image_jacobian[terms[t]]
            for d in range(3):
                pulled = forces[r, 0] * j[0, d] + forces[r, 1] * j[1, d] + forces[r, 2] * j[2, d]
                values[slots[k + d, 0]] += weights[t, 1] * pulled
                values[slots[k + d, 1]] += weights[t, 2] * pulled
                if shifted[r]:
                    pulled = (
                        forces[r, 0] * j[0, 3 + d]
                        + forces[r, 1] * j[1, 3 + d]
                        + forces[r, 2] * j[2, 3 + d]
                    )
                    values[slots[stretch + d, 0]] += weights[t, 1] * pulled
                    values[slots[stretch + d, 1]] += weights[t, 2] * pulled
            k += 3


@njit(cache=True)
def _add_slide_rates(slide, term_indptr, terms, weights, forces, image_rate, out):
    for r in range(len(slide)):
        if slide[r] < 0:
            continue
        for t in range(term_indptr[r], term_indptr[r + 1]):
            x = image_rate[terms[t]]
            pulled = forces[r, 0] * x[0] + forces[r, 1] * x[1] + forces[r, 2] * x[2]
            out[slide[r]] += weights[t, 1] * pulled
            out[slide[r] + 1] += weights[t, 2] * pulled

"""Sparse Hessian of the pulled-back energy: H = J^T (d2E/dy2) J + sum dE/dy . d2y/dz2.

The elements' pattern is found once per mesh; every assembly adds into known slots. Only the upper
triangle is kept. Element blocks are first summed into blocks of world-vector pairs (a, b), a <= b,
so that each pair is pulled back once however many elements share it. Contact couples other pairs at
every state: the pattern makes room for those that touch or nearly do.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding import pull_kernels as kernels
from flexscale.embedding.pair_pattern import SlotArray, element_pattern, find_slots, number_pairs
from flexscale.embedding.world_map import SecondOrder, World, WorldMap
from flexscale.mechanics.energy import ALL, NOTHING, Energy, PairEnergy, project_blocks


@dataclass(frozen=True)
class PairBlocks:
    """d2E/dy2 as blocks of pairs of rows.

    Attributes
    ----------
    pairs : (n, 2) rows a <= b; those of elements first, the same at every state, then contact's.
    blocks : (n, 3, 3).
    """

    pairs: IntArray
    blocks: FloatArray


class PullBack:
    """Assembles the Hessian in the active unknowns.

    Parameters
    ----------
    world_map : the map z -> y.
    energies : energies over the rows of y.
    contact : contact energy, whose pairs of rows change; None without.
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
    ) -> None:
        self.world_map = world_map
        self.energies = tuple(energies)
        self.contact = contact
        self._position = np.full(world_map.n_unknowns, -1, dtype=np.int64)
        self._position[active] = np.arange(len(active))
        self.n_active = len(active)
        self._columns = self._position[world_map.columns]
        keys, self._element_pairs, self._element_flips = number_pairs(
            self.energies, world_map.n_rows
        )
        self._pairs = self._pairs_of(keys)
        self.indptr, self.indices = element_pattern(
            world_map.indptr,
            self._columns,
            self._pairs,
            self.n_active,
            # Images that contact alone uses: their second derivatives couple home and S.
            self._image_columns(),
        )
        self._element_slots = self._slots = self._find_slots()
        self._entries = self._row_keys(self.indptr, self.indices)
        self._room = np.zeros(0, dtype=np.int64)

    @property
    def diagonal(self) -> IntArray:
        """(n_active,) slots of the diagonal."""
        return self.indptr[:-1].astype(np.int64)

    @property
    def n_pairs(self) -> int:
        """Number of pairs of rows that elements couple."""
        return len(self._pairs)

    def cover(self, y: FloatArray) -> bool:
        """Make room for contact at a state, beside the room there is; True if the pattern grew."""
        if self.contact is None:
            return False
        if np.isin(self._keys_of(self.contact.pair_blocks(y)[0]), self._room).all():
            return False
        return self._make_room(np.union1d(self._room, self._keys_of(self.contact.near_pairs(y))))

    def fit_room(self, y: FloatArray) -> bool:
        """Make room for contact at a state and for no other; True if the pattern changed."""
        if self.contact is None:
            return False
        return self._make_room(np.unique(self._keys_of(self.contact.near_pairs(y))))

    def _make_room(self, room: IntArray) -> bool:
        if np.array_equal(room, self._room):
            return False
        self._room = room
        m, n = self.world_map, self.n_active
        pairs = self._pairs_of(room)
        widths = np.diff(m.indptr)
        entry = np.repeat(np.arange(len(pairs)), widths[pairs[:, 0]] * widths[pairs[:, 1]])
        place = np.arange(len(entry)) - np.searchsorted(entry, entry)
        i, j = np.divmod(place, widths[pairs[entry, 1]])
        first = self._columns[m.indptr[pairs[entry, 0]] + i]
        second = self._columns[m.indptr[pairs[entry, 1]] + j]
        kept = (first >= 0) & (second >= 0)
        low, high = np.minimum(first, second)[kept], np.maximum(first, second)[kept]
        more = np.unique(low * n + high)
        places = np.searchsorted(self._entries, more)
        more = more[self._entries[places] != more]  # the last entry is the largest there can be
        places = np.searchsorted(self._entries, more)
        entries = np.insert(self._entries, places, more)
        self.indptr = np.searchsorted(entries, np.arange(n + 1) * n)
        self.indices = entries % n
        added = np.bincount(places, minlength=len(self._entries) + 1).cumsum()
        moved = (np.arange(len(added)) + added).astype(np.int32)
        pair, image, slide = self._element_slots
        self._slots = (moved[pair], moved[image], moved[slide])
        return True

    def _row_keys(self, indptr: IntArray, indices: IntArray) -> IntArray:
        return np.repeat(np.arange(self.n_active), np.diff(indptr)) * self.n_active + indices

    def _keys_of(self, pairs: IntArray) -> IntArray:
        return np.asarray(pairs[:, 0] * self.world_map.n_rows + pairs[:, 1])

    def _pairs_of(self, keys: IntArray) -> IntArray:
        return np.stack(np.divmod(keys, self.world_map.n_rows), axis=1)

    def _image_columns(self) -> IntArray:
        """(n_images, 6) positions of home and S, -1 for what is no unknown or does not matter."""
        m, images = self.world_map, self.world_map.images
        columns = np.empty((len(images.kinds), 6), dtype=np.int64)
        shifted = np.any(images.shifts != 0.0, axis=1)
        for c in range(3):
            columns[:, c] = self._position[images.nodes + c]
            stretch = self._position[m.n_unknowns - 3 + c]
            columns[:, 3 + c] = np.where(shifted, stretch, -1)
        return columns

    def _find_slots(self) -> tuple[SlotArray, SlotArray, SlotArray]:
        """Slots of pairs, images and slides; the one past the end takes what is not kept."""
        m, position = self.world_map, self._position
        self._pair_indptr, pair_slots = self._pair_slots(self._pairs)
        local = self._image_columns()
        image_slots = np.empty((len(local), 6, 6), dtype=np.int32)
        kernels.find_image_slots(local, self.indptr, self.indices, image_slots)
        slide_columns = np.where(m.slide >= 0, position[m.slide], -1)
        slide_slots = np.full((len(self._columns), 2), len(self.indices), dtype=np.int32)
        kernels.find_slide_slots(
            slide_columns, m.indptr, self._columns, self.indptr, self.indices, slide_slots
        )
        return pair_slots, image_slots, slide_slots

    def _pair_slots(self, pairs: IntArray) -> tuple[IntArray, SlotArray]:
        """Where the entries of each pair begin (n + 1,), and their slots."""
        return find_slots(pairs, self.world_map.indptr, self._columns, self.indptr, self.indices)

    def pair_blocks(self, y: FloatArray, project: str = NOTHING) -> PairBlocks:
        """Blocks of d2E/dy2, optionally of a positive part of contact or of all."""
        out = np.zeros((len(self._pairs), 3, 3))
        for energy, pairs, flips in zip(
            self.energies, self._element_pairs, self._element_flips, strict=True
        ):
            blocks = energy.hessian_blocks(y)
            if project == ALL:
                blocks = project_blocks(blocks, energy.vectors.shape[1])
            kernels.gather(blocks, pairs, flips, out)
        if self.contact is None:
            return PairBlocks(self._pairs, out)
        touching, blocks = self.contact.pair_blocks(y, project != NOTHING)
        return PairBlocks(np.concatenate([self._pairs, touching]), np.concatenate([out, blocks]))

    def multiply(self, blocks: PairBlocks, rates: FloatArray) -> FloatArray:
        """(n_rows, 3): d2E/dy2 applied to rates (n_rows, 3)."""
        out = np.zeros_like(rates)
        kernels.multiply_pairs(blocks.pairs, blocks.blocks, rates, out)
        return out

    def hessian(
        self, world: World, blocks: PairBlocks, forces: FloatArray, second: SecondOrder
    ) -> FloatArray:
        """(nnz,) values of the upper triangle on the present pattern, which must cover contact.

        `blocks` from `pair_blocks`; `forces` = dE/dy and `second` = `WorldMap.second_order`, the
        map's own part.
        """
        m = self.world_map
        values = np.zeros(len(self.indices) + 1)  # the last slot swallows entries that are not kept
        pair_slots, image_slots, slide_slots = self._slots
        n = len(self._pairs)
        touching = blocks.pairs[n:]
        for part, pairs, indptr, slots in (
            (blocks.blocks[:n], self._pairs, self._pair_indptr, pair_slots),
            (blocks.blocks[n:], touching, *self._pair_slots(touching)),
        ):
            kernels.pull_pairs(
                pairs, part, m.indptr, m.columns, world.jacobian, indptr, slots, values
            )
        kernels.add_images(second.hessian, image_slots, values)
        kernels.add_slides(
            m.slide, m.indptr, m.term_indptr, m.terms, m.weights, m.shifted, forces,
            world.image_jacobian, slide_slots, values,
        )  # fmt: skip
        return values[:-1]

    def kappa_rate(
        self, world: World, blocks: PairBlocks, forces: FloatArray, second: SecondOrder
    ) -> FloatArray:
        """(n_unknowns,) d(dE/dz)/dkappa at fixed z, for prediction along a sweep."""
        m = self.world_map
        out = m.pull_gradient(world, self.multiply(blocks, world.kappa_rate))
        for c in range(3):
            np.add.at(out, m.images.nodes + c, second.mixed[:, c])
            out[m.n_unknowns - 3 + c] += second.mixed[:, 3 + c].sum()
        kernels.add_slide_rates(
            m.slide, m.term_indptr, m.terms, m.weights, forces, world.image_kappa_rate, out
        )
        return out

"""Pattern of a sparse Hessian from the pairs of rows that elements couple, found once per mesh."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from flexscale.arrays import IntArray
from flexscale.embedding import pull_kernels as kernels
from flexscale.mechanics.energy import Energy, block_pairs

SlotArray = NDArray[np.int32]


def number_pairs(
    energies: Sequence[Energy], n_rows: int
) -> tuple[IntArray, list[IntArray], list[NDArray[np.bool_]]]:
    """Pairs of rows (a, b), a <= b, in the elements of energies.

    Returns
    -------
    keys : (n_pairs,) a n_rows + b, sorted.
    element_pairs : per energy (n_elements, k (k + 1) / 2), the pair of each block.
    element_flips : whether the block is that of (b, a).
    """
    keys = []
    for energy in energies:
        i, j = block_pairs(energy.vectors.shape[1])
        first, second = energy.vectors[:, i], energy.vectors[:, j]
        keys.append(np.minimum(first, second) * n_rows + np.maximum(first, second))
    unique = np.unique(np.concatenate([k.ravel() for k in keys]))
    element_pairs, element_flips = [], []
    for energy, key in zip(energies, keys, strict=True):
        i, j = block_pairs(energy.vectors.shape[1])
        element_pairs.append(np.searchsorted(unique, key))
        element_flips.append(energy.vectors[:, i] > energy.vectors[:, j])
    return unique, element_pairs, element_flips


def element_pattern(
    row_indptr: IntArray,
    columns: IntArray,
    pairs: IntArray,
    n_active: int,
    groups: IntArray | None = None,
) -> tuple[IntArray, IntArray]:
    """CSR pattern (indptr, indices) of the upper triangle, diagonal included.

    Parameters
    ----------
    row_indptr : (n_rows + 1,) columns of each row.
    columns : (row_indptr[-1],) active unknowns; -1 for others.
    pairs : (n_pairs, 2) coupled rows.
    groups : (n, k) active unknowns that are coupled among themselves besides; -1 for others.
    """
    n_rows = len(row_indptr) - 1
    rows = np.repeat(np.arange(n_rows), np.diff(row_indptr))
    kept = columns >= 0
    ones = np.ones(int(kept.sum()), dtype=np.float32)
    jacobian = sp.csr_array((ones, (rows[kept], columns[kept])), shape=(n_rows, n_active))
    ones = np.ones(len(pairs), dtype=np.float32)
    blocks = sp.csr_array((ones, pairs.T), shape=(n_rows, n_rows))
    blocks = blocks + blocks.T
    product = jacobian.T @ (blocks @ jacobian)
    if groups is not None:
        kept = groups >= 0
        ones = np.ones(int(kept.sum()), dtype=np.float32)
        members = sp.csr_array(
            (ones, (np.nonzero(kept)[0], groups[kept])), shape=(len(groups), n_active)
        )
        product = product + members.T @ members
    upper = sp.csr_array(sp.triu(product + sp.eye_array(n_active, dtype=np.float32)))
    upper.sort_indices()
    return upper.indptr.astype(np.int64), upper.indices.astype(np.int64)


def find_slots(
    pairs: IntArray, row_indptr: IntArray, columns: IntArray, indptr: IntArray, indices: IntArray
) -> tuple[IntArray, SlotArray]:
    """Where the entries of each pair begin (n + 1,), and their slots in the upper triangle."""
    widths = np.diff(row_indptr)
    counts = widths[pairs[:, 0]] * widths[pairs[:, 1]]
    pair_indptr = np.concatenate([[0], np.cumsum(counts)])
    slots = np.empty(pair_indptr[-1], dtype=np.int32)
    kernels.find_pair_slots(pairs, row_indptr, columns, pair_indptr, indptr, indices, slots)
    return pair_indptr, slots

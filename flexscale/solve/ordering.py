"""The order in which unknowns are eliminated, where more is known of them than their pattern.

A scale's unknowns are coupled with one another and with all of the sheet around it: to an ordering
that sees the pattern alone they look like any others. Eliminated after the sheet, scale by scale,
they leave less than half of the operations for a cell of four scales. But eliminating all of the
sheet couples every scale with every other: for many scales nested dissection is better, once it
does not see the lattice's strain, which every element depends on. A sheet that is a solid has so
many unknowns of its own that it takes nested dissection, and scales come after it too.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg

from flexscale.arrays import IntArray
from flexscale.solve.linear import nested_dissection

MANY = 14  # scales, from which on nested dissection leaves fewer operations
LARGE = 20_000  # unknowns of the sheet, likewise


def grouped_order(indptr: IntArray, indices: IntArray, groups: IntArray) -> IntArray:
    """The unknown that is eliminated at each place.

    Parameters
    ----------
    indptr, indices : CSR pattern of the upper triangle, n rows.
    groups : (n,) -1 for unknowns that come first, in an order of least fill; those of a group 0, 1,
        … together, groups in an order of least fill; the last group last.

    Returns
    -------
    (n,)
    """
    n = len(groups)
    pattern = sp.csr_array((np.ones(len(indices)), indices, indptr), shape=(n, n))
    single = np.flatnonzero(groups < 0)
    last = int(groups.max())
    entries = sp.coo_array(pattern)
    first, second = groups[entries.row], groups[entries.col]
    inner = (np.minimum(first, second) >= 0) & (np.maximum(first, second) < last)
    between = sp.csr_array((entries.data[inner], (first[inner], second[inner])), shape=(last, last))
    members = [np.flatnonzero(groups == k) for k in [*minimum_degree(between), last]]
    sheet = sp.csr_array(pattern[single][:, single])
    sheet.sort_indices()
    dissected = nested_dissection(sheet.indptr, sheet.indices) if len(single) > LARGE else None
    first = minimum_degree(sheet) if dissected is None else dissected
    return np.concatenate([single[first], *members])


def elimination_order(indptr: IntArray, indices: IntArray, groups: IntArray) -> IntArray | None:
    """The better of both orders for so many groups; arguments and result as of `grouped_order`.

    None where nested dissection is wanted but not at hand.
    """
    if groups.max() < MANY:
        return grouped_order(indptr, indices, groups)
    n = len(groups)
    last = groups == groups.max()
    pattern = sp.csr_array((np.ones(len(indices)), indices, indptr), shape=(n, n))
    others = sp.csr_array(pattern[~last][:, ~last])
    others.sort_indices()
    order = nested_dissection(others.indptr, others.indices)
    if order is None:
        return None
    return np.concatenate([np.flatnonzero(~last)[order], np.flatnonzero(last)])


def minimum_degree(pattern: sp.csr_array) -> IntArray:
    """Multiple minimum degree order (n,) of a symmetric pattern of which one triangle is given."""
    n = pattern.shape[0]
    if n < 2:
        return np.arange(n)
    both = sp.csc_array(pattern + pattern.T)
    both.data[:] = 1.0
    # SuperLU has the ordering, and shows it with a factorization: of a matrix that has one.
    both = sp.csc_array(both + sp.diags_array(1.0 + np.diff(both.indptr)))
    factors = scipy.sparse.linalg.splu(
        both,
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    return np.argsort(factors.perm_c)

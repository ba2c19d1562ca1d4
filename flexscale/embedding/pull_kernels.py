"""Kernels of the pull-back: slots of entries in the sparse upper triangle, and sums into them."""

from __future__ import annotations

from numba import njit


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
def find_pair_slots(pairs, row_indptr, columns, pair_indptr, indptr, indices, slots):
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
def find_image_slots(local, indptr, indices, slots):
    for n in range(len(local)):
        for i in range(6):
            for j in range(6):
                slots[n, i, j] = (
                    _slot(local[n, i], local[n, j], indptr, indices) if i <= j else len(indices)
                )


@njit(cache=True)
def find_slide_slots(slide_columns, row_indptr, columns, indptr, indices, slots):
    for r in range(len(slide_columns)):
        if slide_columns[r] >= 0:
            for k in range(row_indptr[r], row_indptr[r + 1] - 2):
                slots[k, 0] = _slot(slide_columns[r], columns[k], indptr, indices)
                slots[k, 1] = _slot(slide_columns[r] + 1, columns[k], indptr, indices)


@njit(cache=True)
def gather(blocks, pairs, flips, out):
    for e in range(blocks.shape[0]):
        for p in range(blocks.shape[1]):
            target = out[pairs[e, p]]
            for r in range(3):
                for c in range(3):
                    target[r, c] += blocks[e, p, c, r] if flips[e, p] else blocks[e, p, r, c]


@njit(cache=True)
def multiply_pairs(pairs, blocks, rates, out):
    for p in range(len(pairs)):
        a, b = pairs[p]
        for r in range(3):
            for c in range(3):
                out[a, r] += blocks[p, r, c] * rates[b, c]
                if a != b:
                    out[b, c] += blocks[p, r, c] * rates[a, r]


@njit(cache=True)
def pull_pairs(pairs, blocks, row_indptr, columns, jacobian, pair_indptr, slots, values):
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
def add_images(hessian, slots, values):
    for n in range(len(hessian)):
        for i in range(6):
            for j in range(i, 6):
                values[slots[n, i, j]] += hessian[n, i, j]


@njit(cache=True)
def add_slides(
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
def add_slide_rates(slide, term_indptr, terms, weights, forces, image_rate, out):
    for r in range(len(slide)):
        if slide[r] < 0:
            continue
        for t in range(term_indptr[r], term_indptr[r + 1]):
            x = image_rate[terms[t]]
            pulled = forces[r, 0] * x[0] + forces[r, 1] * x[1] + forces[r, 2] * x[2]
            out[slide[r]] += weights[t, 1] * pulled
            out[slide[r] + 1] += weights[t, 2] * pulled

"""Forces between things that may part but not overlap: a linear complementarity problem.

With p >= 0 the forces and S their compliance, S p >= m where m is missing to the distances that are
to be kept, and p = 0 where S p > m. Such p are those of the largest p . m - 1/2 p . S p, and solve
non-negative least squares. Few of them act at a time: the set that does is grown one by one, and
what would have to pull leaves it (Lawson and Hanson 1974, ch. 23).
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from flexscale.arrays import FloatArray, IntArray

_TOLERANCE = 1e-9  # share of what is missing most, and of a diagonal entry of S


@njit(cache=True)
def unilateral_forces(
    compliance: FloatArray, missing: FloatArray, active: IntArray, forces: FloatArray
) -> int:
    """Fill active (n,) with the indices that act and forces (n,) with theirs, in that order.

    Parameters
    ----------
    compliance : (n, n) S, symmetric and not negative; entries may depend on others.
    missing : (n,) m. Where no p fulfills all, as S is singular, some stay short.

    Returns
    -------
    How many act.
    """
    n, n_active = len(missing), 0
    limit = _TOLERANCE * max(missing.max(), 0.0) if n else 0.0
    acts, out = np.zeros(n, dtype=np.bool_), np.zeros(n, dtype=np.bool_)
    lower, wanted = np.empty((n, n)), np.empty(n)
    for _ in range(4 * n):
        best, enters = limit, -1
        for i in range(n):
            if acts[i] or out[i]:
                continue
            short = missing[i]
            for a in range(n_active):
                short -= compliance[i, active[a]] * forces[a]
            if short > best:
                best, enters = short, i
        if enters < 0:
            break
        active[n_active], forces[n_active] = enters, 0.0
        if _add_row(compliance, active, n_active, lower):
            acts[enters] = True
            n_active += 1
        else:
            # What enters does as those that act do together: it takes over until one is released.
            released = _take_over(lower, n_active, forces, wanted)
            if released < 0:
                out[enters] = True
                continue
            acts[active[released]], acts[enters] = False, True
            active[released], forces[released] = enters, forces[n_active]
            n_active = _rows_from(compliance, active, forces, acts, released, n_active, lower)
        while n_active > 0:
            _solve(lower, missing, active, n_active, wanted)
            share, leaves = 1.0, -1
            for a in range(n_active):
                if wanted[a] <= 0.0 and forces[a] <= share * (forces[a] - wanted[a]):
                    share, leaves = forces[a] / (forces[a] - wanted[a]), a
            for a in range(n_active):
                forces[a] += share * (wanted[a] - forces[a])
            if leaves < 0:
                break
            acts[active[leaves]] = False
            out[:] = False
            n_active -= 1
            for a in range(leaves, n_active):
                active[a], forces[a] = active[a + 1], forces[a + 1]
            n_active = _rows_from(compliance, active, forces, acts, leaves, n_active, lower)
    return n_active


@njit(cache=True)
def _add_row(compliance: FloatArray, active: IntArray, row: int, lower: FloatArray) -> bool:
    """Row of the Cholesky factor of the active part; False where it depends on those before."""
    i = active[row]
    for a in range(row):
        value = compliance[i, active[a]]
        for b in range(a):
            value -= lower[row, b] * lower[a, b]
        lower[row, a] = value / lower[a, a]
    value = compliance[i, i]
    for b in range(row):
        value -= lower[row, b] ** 2
    if value <= _TOLERANCE * compliance[i, i]:
        return False
    lower[row, row] = np.sqrt(value)
    return True


@njit(cache=True)
def _rows_from(
    compliance: FloatArray,
    active: IntArray,
    forces: FloatArray,
    acts: NDArray[np.bool_],
    first: int,
    n: int,
    lower: FloatArray,
) -> int:
    """Rows of the factor from `first` on; leaves out what rounding makes depend on those before."""
    row = first
    for a in range(first, n):
        active[row], forces[row] = active[a], forces[a]
        if _add_row(compliance, active, row, lower):
            row += 1
        else:
            acts[active[row]] = False
    return row


@njit(cache=True)
def _take_over(lower: FloatArray, n: int, forces: FloatArray, shares: FloatArray) -> int:
    """Move force from the first n entries to the one after, whose row of the factor is there.

    All distances stay as they are. Returns the first entry without force, -1 where none gets there.
    """
    for a in range(n - 1, -1, -1):
        value = lower[n, a]
        for b in range(a + 1, n):
            value -= lower[b, a] * shares[b]
        shares[a] = value / lower[a, a]
    step, released = np.inf, -1
    for a in range(n):
        if shares[a] > _TOLERANCE and forces[a] < step * shares[a]:
            step, released = forces[a] / shares[a], a
    if released >= 0:
        for a in range(n):
            forces[a] = max(forces[a] - step * shares[a], 0.0)
        forces[n] = step
    return released


@njit(cache=True)
def _solve(
    lower: FloatArray, missing: FloatArray, active: IntArray, n: int, out: FloatArray
) -> None:
    """Fill out with the forces that make up for what is missing at the active entries."""
    for a in range(n):
        value = missing[active[a]]
        for b in range(a):
            value -= lower[a, b] * out[b]
        out[a] = value / lower[a, a]
    for a in range(n - 1, -1, -1):
        value = out[a]
        for b in range(a + 1, n):
            value -= lower[b, a] * out[b]
        out[a] = value / lower[a, a]

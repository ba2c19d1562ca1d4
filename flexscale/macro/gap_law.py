"""Energy per rest area of a sheet whose gaps close as those of its flat cell, with derivatives.

States as in `tensor_law`: e = a − I and b [mm-1]. With strain E = (e11/2, e22/2, e12) and
curvature k = (b11, b22, 2 b12)

    W = ½ E·A E + soft(½ k·C k, s) + soft(W_c(k), s_c) + ½ w det(b)²,
    soft(x, s) = log(1 + s x)/s,
    W_c(k) = max over p >= 0 of  −p·h(k) − ½ p·S p,   h(k) = g + G k + ½ k·Q k,

g, G, S the gaps of `flat_contact`, and Q their turns, which only a fit knows. dW_c/dk = −Hᵀp with
H = dh/dk, and the second derivative Hᵀ S⁻¹ H − p·Q of the closed ones jumps as one more closes.
Without turns W_c is convex.

A table is that of `tensor_law`, for all but contact, followed by n, s_c, g (n), G (n, 3), S (n, n),
and Q (n, 3, 3).
"""

from __future__ import annotations

import numpy as np
from numba import njit

from flexscale.arrays import FloatArray
from flexscale.macro import tensor_law
from flexscale.macro.tensor_law import N_TABLE
from flexscale.solve.unilateral import unilateral_forces

_N, _SOFTENING, _GAPS = N_TABLE, N_TABLE + 1, N_TABLE + 2


def build_gap_table(
    rest: FloatArray,
    distances: FloatArray,
    slopes: FloatArray,
    compliance: FloatArray,
    softening: float,
    turns: FloatArray | None = None,
) -> FloatArray:
    """Table of a gap law.

    Parameters
    ----------
    rest : (60,) table of `tensor_law` without contact.
    distances, slopes, compliance : (n,), (n, 3), (n, n) of the gaps, see `FlatContact`.
    softening : s_c, mm N-1.
    turns : (n, 3, 3) Q of the gaps, mm3; none if not given.
    """
    head, n = np.array([len(distances), softening], dtype=float), len(distances)
    turned = np.zeros(9 * n) if turns is None else turns.ravel()
    return np.concatenate([rest, head, distances, slopes.ravel(), compliance.ravel(), turned])


@njit(cache=True)
def gap_table_end(table: FloatArray) -> int:
    """How long the table of a gap law is, which may be followed by more."""
    n = int(table[_N])
    return _GAPS + n * (13 + n)


@njit(cache=True)
def energy(e: FloatArray, b: FloatArray, parameters: FloatArray) -> float:
    """Energy per rest area [N mm-1]; e, b (3,), parameters a table."""
    value: float = tensor_law.energy(e, b, parameters)
    k = (b[0], b[2], 2.0 * b[1])
    if closes(k, parameters):
        touch = contact_energy(k, parameters, np.empty(3), np.empty((0, 0)))
        softening = parameters[_SOFTENING]
        value += np.log1p(softening * touch) / softening if softening > 0.0 else touch
    return value


@njit(cache=True)
def law(
    e: FloatArray, b: FloatArray, parameters: FloatArray, grad: FloatArray, hess: FloatArray
) -> None:
    """Fill gradient (6,) and Hessian (6, 6) in (a11, a12, a22, b11, b12, b22), as `tensor_law`."""
    tensor_law.law(e, b, parameters, grad, hess)
    k = (b[0], b[2], 2.0 * b[1])
    if not closes(k, parameters):
        return
    by_k = np.empty(3)
    twice = np.empty((3, 3)) if hess.shape[0] > 0 else np.empty((0, 0))
    touch, softening = contact_energy(k, parameters, by_k, twice), parameters[_SOFTENING]
    rate = 1.0 / (1.0 + softening * touch)
    order, scale = (0, 2, 1), (1.0, 1.0, 2.0)
    for i in range(3):
        grad[3 + order[i]] += rate * scale[i] * by_k[i]
        if hess.shape[0] > 0:
            for j in range(3):
                curve = rate * (twice[i, j] - softening * rate * by_k[i] * by_k[j])
                hess[3 + order[i], 3 + order[j]] += scale[i] * scale[j] * curve


@njit(cache=True)
def _gap(k: tuple[float, float, float], table: FloatArray, i: int, slope: FloatArray) -> float:
    """h of gap i, mm, if no force holds it; fills its slope (3,) by k, mm2."""
    n = int(table[_N])
    slopes, turns = _GAPS + n + 3 * i, _GAPS + n * (4 + n) + 9 * i
    gap = table[_GAPS + i]
    for c in range(3):
        turned = 0.0
        for d in range(3):
            turned += table[turns + 3 * c + d] * k[d]
        slope[c] = table[slopes + c] + turned
        gap += (table[slopes + c] + 0.5 * turned) * k[c]
    return gap


@njit(cache=True)
def closes(k: tuple[float, float, float], table: FloatArray) -> bool:
    """Whether any gap would close without a force."""
    slope, least = np.empty(3), np.inf
    for i in range(int(table[_N])):
        least = min(least, _gap(k, table, i, slope))
    return least < 0.0


@njit(cache=True)
def contact_energy(
    k: tuple[float, float, float], table: FloatArray, by_k: FloatArray, twice: FloatArray
) -> float:
    """W_c, its gradient (3,) by k, and its Hessian (3, 3); a `twice` of shape (0, 0) is skipped."""
    n = int(table[_N])
    compliances, turns = _GAPS + 4 * n, _GAPS + n * (4 + n)
    compliance = table[compliances : compliances + n * n].reshape((n, n))
    missing, slopes = np.empty(n), np.empty((n, 3))
    for i in range(n):
        missing[i] = -_gap(k, table, i, slopes[i])
    active, forces = np.empty(n, dtype=np.int64), np.empty(n)
    m = unilateral_forces(compliance, missing, active, forces)
    value = 0.0
    by_k[:] = 0.0
    for a in range(m):
        i = active[a]
        value += 0.5 * forces[a] * missing[i]  # S p = m where p > 0
        for c in range(3):
            by_k[c] -= forces[a] * slopes[i, c]
    if twice.shape[0] > 0:
        closed, rates = np.empty((m, m)), np.empty((m, 3))
        for a in range(m):
            for c in range(3):
                rates[a, c] = slopes[active[a], c]
            for d in range(m):
                closed[a, d] = compliance[active[a], active[d]]
        twice[:] = 0.0
        if m > 0:
            held = np.linalg.solve(closed, rates)
            for a in range(m):
                for c in range(3):
                    for d in range(3):
                        turn = table[turns + 9 * active[a] + 3 * c + d]
                        twice[c, d] += rates[a, c] * held[a, d] - forces[a] * turn
    return value

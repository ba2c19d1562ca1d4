"""Energy per rest area of a sheet under any bending: gaps that close, times a smooth correction.

States as in `gap_law`. With the bending energy W_g(k) of that law, without strain,

    W = ½ E·A E + exp(c(k)) W_g(k),

c a cubic spline over (κ_xx, κ_yy, √2 κ_xy), whose length |k| is that of the principal curvatures,
on a regular grid. Gaps have what is sharp, the onset of each contact, and the correction what is
left: it does not jump where both principal curvatures are equal, since nothing is said of these.
Beyond the sampled length R the correction is taken where the ray ends in a sphere of (1 + μ) R,
which it approaches as R (1 + μ (1 − exp((1 − |k|/R)/μ))).

A table is that of `gap_law`, followed by n, R and the n³ coefficients of the spline.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from flexscale.arrays import FloatArray, IntArray
from flexscale.macro import tensor_law
from flexscale.macro.gap_law import closes, contact_energy, gap_table_end
from flexscale.macro.tensor_law import IN_PLANE, N_TABLE, SOFTENING, TANGENT

MARGIN = 0.1  # μ
_CONTACT_SOFTENING = N_TABLE + 1
_ROOT = float(np.sqrt(0.5))  # of the third coordinate by 2 κ_xy


def build_corrected_table(gaps: FloatArray, reach: float, coefficients: FloatArray) -> FloatArray:
    """Table of the law.

    Parameters
    ----------
    gaps : table of a gap law.
    reach : R, mm-1.
    coefficients : (n, n, n) of the spline, n >= 4.
    """
    return np.concatenate([gaps, [len(coefficients), reach], coefficients.ravel()])


@njit(cache=True)
def energy(e: FloatArray, b: FloatArray, parameters: FloatArray) -> float:
    """Energy per rest area [N mm-1]; e, b (3,), parameters a table."""
    strain = (0.5 * e[0], 0.5 * e[2], e[1])
    value: float = tensor_law.quadratic(parameters, IN_PLANE, strain)
    return value + _bending(b, parameters, np.empty(3), np.empty((0, 0)))


@njit(cache=True)
def law(
    e: FloatArray, b: FloatArray, parameters: FloatArray, grad: FloatArray, hess: FloatArray
) -> None:
    """Fill gradient (6,) and Hessian (6, 6) in (a11, a12, a22, b11, b12, b22), as `tensor_law`."""
    grad[:] = 0.0
    hess[:] = 0.0
    strain = (0.5 * e[0], 0.5 * e[2], e[1])
    tensor_law.add_quadratic(parameters, IN_PLANE, strain, (0.5, 0.5, 1.0), 0, grad, hess)
    by_k = np.empty(3)
    twice = np.empty((3, 3)) if hess.shape[0] > 0 else np.empty((0, 0))
    _bending(b, parameters, by_k, twice)
    order, scale = (0, 2, 1), (1.0, 1.0, 2.0)
    for i in range(3):
        grad[3 + order[i]] = scale[i] * by_k[i]
        if hess.shape[0] > 0:
            for j in range(3):
                hess[3 + order[i], 3 + order[j]] = scale[i] * scale[j] * twice[i, j]


@njit(cache=True)
def _bending(b: FloatArray, table: FloatArray, by_k: FloatArray, twice: FloatArray) -> float:
    """exp(c) W_g, gradient (3,) and Hessian (3, 3) by k; a `twice` of shape (0, 0) is skipped."""
    k = (b[0], b[2], 2.0 * b[1])
    x = (b[0], b[2], 2.0 * _ROOT * b[1])
    value = _of_gaps(k, table, by_k, twice)
    first, second = np.empty(3), _matrix(twice)
    factor = np.exp(correction(x, table, gap_table_end(table), first, second))
    first[2] *= _ROOT
    if twice.shape[0] > 0:
        for i in range(3):
            second[i, 2] *= _ROOT
            second[2, i] *= _ROOT
        for i in range(3):
            for j in range(3):
                bend = twice[i, j] + by_k[i] * first[j] + first[i] * by_k[j]
                twice[i, j] = factor * (bend + value * (first[i] * first[j] + second[i, j]))
    for i in range(3):
        by_k[i] = factor * (by_k[i] + value * first[i])
    return factor * value


@njit(cache=True)
def _matrix(like: FloatArray) -> FloatArray:
    return np.empty((3, 3)) if like.shape[0] > 0 else np.empty((0, 0))


@njit(cache=True)
def _of_gaps(
    k: tuple[float, float, float], table: FloatArray, by_k: FloatArray, twice: FloatArray
) -> float:
    """W_g, likewise."""
    rest = 0.0
    for i in range(3):
        by_k[i] = 0.0
        for j in range(3):
            by_k[i] += tensor_law.entry_of(table, TANGENT, i, j) * k[j]
        rest += 0.5 * by_k[i] * k[i]
    if twice.shape[0] > 0:
        for i in range(3):
            for j in range(3):
                twice[i, j] = tensor_law.entry_of(table, TANGENT, i, j)
    value = _soften(rest, table[SOFTENING], by_k, twice)
    if closes(k, table):
        also, again = np.empty(3), _matrix(twice)
        touch = contact_energy(k, table, also, again)
        value += _soften(touch, table[_CONTACT_SOFTENING], also, again)
        for i in range(3):
            by_k[i] += also[i]
        if twice.shape[0] > 0:
            twice += again
    return value


@njit(cache=True)
def _soften(value: float, softening: float, first: FloatArray, second: FloatArray) -> float:
    """log(1 + s W)/s, and its derivatives from those of W."""
    if softening <= 0.0:
        return value
    rate = 1.0 / (1.0 + softening * value)
    if second.shape[0] > 0:
        for i in range(3):
            for j in range(3):
                second[i, j] = rate * (second[i, j] - softening * rate * first[i] * first[j])
    for i in range(3):
        first[i] *= rate
    return np.log1p(softening * value) / softening


@njit(cache=True)
def correction(
    x: tuple[float, float, float], table: FloatArray, at: int, first: FloatArray, second: FloatArray
) -> float:
    """c, its gradient (3,) and Hessian (3, 3) by x; a `second` of shape (0, 0) is skipped.

    at : where in the table n, R and the coefficients begin.
    """
    reach = table[at + 1]
    length = np.sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2])
    if length <= reach:
        return _spline(x, table, at, first, second)
    # y = φ x, with the derivatives of φ by |x|.
    there = np.exp((1.0 - length / reach) / MARGIN)
    radius = reach * (1.0 + MARGIN * (1.0 - there))
    phi = radius / length
    by_length = (there - phi) / length
    again = -there / (MARGIN * reach * length) - 2.0 * by_length / length
    value = _spline((phi * x[0], phi * x[1], phi * x[2]), table, at, first, second)
    g = (first[0], first[1], first[2])
    along = g[0] * x[0] + g[1] * x[1] + g[2] * x[2]
    if second.shape[0] > 0:
        on_x = np.empty(3)
        for i in range(3):
            on_x[i] = second[i, 0] * x[0] + second[i, 1] * x[1] + second[i, 2] * x[2]
        twice = on_x[0] * x[0] + on_x[1] * x[1] + on_x[2] * x[2]
        share = by_length / length
        for i in range(3):
            for j in range(3):
                both = x[i] * x[j]
                value_ij = phi * phi * second[i, j] + share * share * twice * both
                value_ij += phi * share * (on_x[i] * x[j] + x[i] * on_x[j])
                value_ij += share * (g[i] * x[j] + x[i] * g[j])
                value_ij += along * (again - share) * both / (length * length)
                if i == j:
                    value_ij += along * share
                second[i, j] = value_ij
    for i in range(3):
        first[i] = phi * g[i] + along * by_length / length * x[i]
    return value


@njit(cache=True)
def _spline(
    y: tuple[float, float, float], table: FloatArray, at: int, first: FloatArray, second: FloatArray
) -> float:
    n, span = int(table[at]), (1.0 + MARGIN) * table[at + 1]
    size = 2.0 * span / (n - 3)
    b, cell = np.empty((3, 3, 4)), np.empty(3, dtype=np.int64)
    for a in range(3):
        cell[a] = cubic_weights((y[a] + span) / size, n - 3, b[a])
    start, value = at + 2, 0.0
    first[:] = 0.0
    second[:] = 0.0
    for i in range(4):
        plane = np.zeros(6)  # by (y, z): none, z, zz, y, yz, yy
        for j in range(4):
            row = start + ((cell[0] + i) * n + cell[1] + j) * n + cell[2]
            v, vz, vzz = 0.0, 0.0, 0.0
            for m in range(4):
                c = table[row + m]
                v, vz, vzz = v + b[2, 0, m] * c, vz + b[2, 1, m] * c, vzz + b[2, 2, m] * c
            plane[0] += b[1, 0, j] * v
            plane[1] += b[1, 0, j] * vz
            plane[2] += b[1, 0, j] * vzz
            plane[3] += b[1, 1, j] * v
            plane[4] += b[1, 1, j] * vz
            plane[5] += b[1, 2, j] * v
        value += b[0, 0, i] * plane[0]
        first[0] += b[0, 1, i] * plane[0]
        first[1] += b[0, 0, i] * plane[3]
        first[2] += b[0, 0, i] * plane[1]
        if second.shape[0] > 0:
            second[0, 0] += b[0, 2, i] * plane[0]
            second[0, 1] += b[0, 1, i] * plane[3]
            second[0, 2] += b[0, 1, i] * plane[1]
            second[1, 1] += b[0, 0, i] * plane[5]
            second[1, 2] += b[0, 0, i] * plane[4]
            second[2, 2] += b[0, 0, i] * plane[2]
    for i in range(3):
        first[i] /= size
        if second.shape[0] > 0:
            for j in range(i, 3):
                second[i, j] /= size * size
                second[j, i] = second[i, j]
    return value


@njit(cache=True)
def cubic_weights(u: float, n_cells: int, weights: FloatArray) -> int:
    """Weights (3, 4) of the four cubic B-splines around u, in cells, and their two derivatives.

    Returns
    -------
    The first of the four.
    """
    cell = min(max(int(np.floor(u)), 0), n_cells - 1)
    t = u - cell
    s = 1.0 - t
    weights[0] = (s**3 / 6.0, (3.0 * t**3 - 6.0 * t * t + 4.0) / 6.0,
                  (3.0 * s**3 - 6.0 * s * s + 4.0) / 6.0, t**3 / 6.0)  # fmt: skip
    weights[1] = (-0.5 * s * s, 1.5 * t * t - 2.0 * t, 2.0 * s - 1.5 * s * s, 0.5 * t * t)
    weights[2] = (s, 3.0 * t - 2.0, 3.0 * s - 2.0, t)
    return cell


@njit(cache=True)
def spline_rows(x: FloatArray, n: int, reach: float, columns: IntArray, values: FloatArray) -> None:
    """Fill the coefficients (p, 64) that the correction at (p, 3) depends on, and what multiplies
    them in it and in its gradient (4, p, 64); within the reach."""
    span = (1.0 + MARGIN) * reach
    size = 2.0 * span / (n - 3)
    b, cell = np.empty((3, 3, 4)), np.empty(3, dtype=np.int64)
    for p in range(len(x)):
        for a in range(3):
            cell[a] = cubic_weights((x[p, a] + span) / size, n - 3, b[a])
        at = 0
        for i in range(4):
            for j in range(4):
                for m in range(4):
                    columns[p, at] = ((cell[0] + i) * n + cell[1] + j) * n + cell[2] + m
                    values[0, p, at] = b[0, 0, i] * b[1, 0, j] * b[2, 0, m]
                    values[1, p, at] = b[0, 1, i] * b[1, 0, j] * b[2, 0, m] / size
                    values[2, p, at] = b[0, 0, i] * b[1, 1, j] * b[2, 0, m] / size
                    values[3, p, at] = b[0, 0, i] * b[1, 0, j] * b[2, 1, m] / size
                    at += 1

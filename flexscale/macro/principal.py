"""Principal curvatures and their directions as smooth functions of the curvature tensor [Eq. 16].

With s = (b11 + b22)/2, d = (b11 − b22)/2, o = b12 and r² = d² + o² the principal curvatures are
s ± r, and the direction θ of the first has e^{2iθ} = u = (d + i o)/r; that of the second has −u.
Harmonics of 2θ are polynomials in u, so that no angle is needed. Only r is singular, where the
two curvatures are equal. It is replaced by R,

    R² = r² + η² D²/N + δ²,   D = s² − r² = det b,   N = s² + r²,

in curvatures and directions alike; then |u| = r/R < 1 there, and the harmonics fade to their mean.
η (a number) acts where both curvatures are of one size: D²/N and its gradient vanish in uniaxial
bending, which stays exact, and no length is involved. δ (mm-1) acts where the sheet is nearly flat.
The sum over both directions of any smooth function of (curvature, u) is then smooth: reversing R
merely exchanges the two directions.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from flexscale.arrays import FloatArray

#: b = (b11, b12, b22) from (s, d, o): columns of d(s, d, o)/db.
TO_INVARIANTS = np.array([[0.5, 0.0, 0.5], [0.5, 0.0, -0.5], [0.0, 1.0, 0.0]])


@njit(cache=True)
def smooth_radius(b: FloatArray, eta2: float, delta2: float, jet: FloatArray) -> float:
    """R (mm-1) at b, and its derivatives by (s, d, o).

    Fills jet (4, 3): row 0 the gradient, rows 1 to 3 the Hessian; neither where R = 0.
    """
    s, d, o = 0.5 * (b[0] + b[2]), 0.5 * (b[0] - b[2]), b[1]
    t = d * d + o * o
    n = s * s + t
    if n > 0.0:
        m = (s * s - t) / n
        added = m * m * n
        f_s, f_t = 8.0 * m * s * t / n + 2.0 * s * m * m, m * m - 4.0 * m * s * s / n
        m_s, m_t = 4.0 * s * t / n**2, -2.0 * s * s / n**2
        f_ss = 8.0 * t * (m_s * s + m - 2.0 * m * s * s / n) / n + 2.0 * m * m + 4.0 * s * m * m_s
        f_st = 8.0 * s * (m_t * t + m - m * t / n) / n + 4.0 * s * m * m_t
        f_tt = -4.0 * s * s * (m_t - m / n) / n + 2.0 * m * m_t
    else:
        added = f_s = f_t = f_ss = f_st = f_tt = 0.0
    radius = np.sqrt(t + eta2 * added + delta2)
    if radius == 0.0:
        return radius
    v = (0.0, d, o)
    for i in range(3):
        jet[0, i] = (v[i] * (1.0 + eta2 * f_t) + (0.5 * eta2 * f_s if i == 0 else 0.0)) / radius
    for i in range(3):
        for j in range(3):
            half = 2.0 * eta2 * f_tt * v[i] * v[j]
            if i == 0:
                half += eta2 * f_st * v[j]
            if j == 0:
                half += eta2 * f_st * v[i]
            if i == 0 and j == 0:
                half += 0.5 * eta2 * f_ss
            elif i == j:
                half += 1.0 + eta2 * f_t
            jet[1 + i, j] = (half - jet[0, i] * jet[0, j]) / radius
    return radius


@njit(cache=True)
def principal_state(b: FloatArray, sign: float, radius: float, y: FloatArray) -> None:
    """Fill y (3,) with a principal curvature and its direction, (κ, Re u, Im u).

    Parameters
    ----------
    b : (11, 12, 22), mm-1.
    sign : 1 for the larger curvature, -1 for the smaller.
    radius : as `smooth_radius` gives it; not 0.
    """
    y[0] = 0.5 * (b[0] + b[2]) + sign * radius
    y[1] = sign * 0.5 * (b[0] - b[2]) / radius
    y[2] = sign * b[1] / radius


@njit(cache=True)
def principal_jet(
    b: FloatArray, sign: float, radius: float, radius_jet: FloatArray, jet: FloatArray
) -> None:
    """Derivatives of `principal_state` by (s, d, o).

    `radius_jet` as `smooth_radius` gives it. Fills jet (3, 4, 3): of each entry of y the gradient,
    and the Hessian in rows 1 to 3.
    """
    x = (0.5 * (b[0] + b[2]), 0.5 * (b[0] - b[2]), b[1])
    for i in range(3):
        jet[0, 0, i] = sign * radius_jet[0, i] + (1.0 if i == 0 else 0.0)
        for j in range(3):
            jet[0, 1 + i, j] = sign * radius_jet[1 + i, j]
    w = sign / radius
    for c in range(1, 3):
        for i in range(3):
            w_i = -w * radius_jet[0, i] / radius
            jet[c, 0, i] = x[c] * w_i + (w if i == c else 0.0)
            for j in range(3):
                w_j = -w * radius_jet[0, j] / radius
                w_ij = -w * radius_jet[1 + i, j] / radius + 2.0 * w_i * w_j / w
                jet[c, 1 + i, j] = x[c] * w_ij + (w_j if i == c else 0.0) + (w_i if j == c else 0.0)

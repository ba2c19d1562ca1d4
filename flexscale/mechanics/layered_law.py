"""Energy per rest area of a Neo-Hookean sheet integrated over its thickness, with derivatives.

A point at the height z above the midsurface of a Kirchhoff-Love sheet moves with the normal, so
that its first form there is

    A(z) = a - 2 z b + z^2 b a^-1 b = (1 - z^2 K) a - 2 z (1 - z H) b,

with the mean curvature H = tr(a^-1 b) / 2 and the Gaussian curvature K = det b / det a (Cayley and
Hamilton). Hence, with w = 1 - 2 z H + z^2 K,

    tr A = (1 - z^2 K) tr a - 2 z (1 - z H) tr b,        L = ln sqrt(det A) = ln sqrt(det a) + ln w,

and every layer has the plane-stress energy of `shell_law`, mu/2 (tr A - 2) + m(L). Simpson's rule
over the thickness (z = 0 and the two faces) is exact up to z^3: to second order in strains this is
the energy t Psi(a) + D/2 [...] of `shell_law`. The difference is in what it forbids: no fiber at a
face can be pressed to nothing (w > 0). Energies that add a bending term to that of the midsurface
allow the sheet to fold to radii far below its thickness, and strips between scales then collapse at
their ends, at the size of an element.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from flexscale.mechanics.shell_law import thickness_stretch_squared

FACE_WEIGHT = 1.0 / 6.0  # of Simpson's rule, each face; the midsurface has the rest


@njit(cache=True)
def _layer_energy(trace, log_area, mu, lam):
    """Plane-stress energy per rest volume [MPa] for tr A - 2 and ln sqrt(det A)."""
    d = thickness_stretch_squared(log_area, mu, lam)
    log_volume = log_area + 0.5 * np.log1p(d)
    return 0.5 * mu * (trace + d - 2.0 * log_volume) + 0.5 * lam * log_volume * log_volume


@njit(cache=True)
def layered_energy(e, b, mu, lam, thickness):
    """Energy of the stretched midsurface, and what bending adds, per rest area [N/mm].

    `e` = a - I and `b` [mm-1] as (11, 12, 22). The second is infinite where a face is turned over.
    """
    det_minus_one = e[0] + e[2] + e[0] * e[2] - e[1] * e[1]
    det = 1.0 + det_minus_one
    middle = 0.5 * np.log1p(det_minus_one)
    twice_mean = ((1.0 + e[2]) * b[0] + (1.0 + e[0]) * b[2] - 2.0 * e[1] * b[1]) / det
    gauss = (b[0] * b[2] - b[1] * b[1]) / det
    trace_a, trace_b = 2.0 + e[0] + e[2], b[0] + b[2]
    membrane = _layer_energy(e[0] + e[2], middle, mu, lam)
    faces = 0.0
    for sign in (-1.0, 1.0):
        z = 0.5 * sign * thickness
        fiber = -z * twice_mean + z * z * gauss
        if not (fiber > -1.0 and 1.0 - 0.5 * z * twice_mean > 0.0):
            return thickness * membrane, np.inf
        trace = e[0] + e[2] - z * z * gauss * trace_a - z * (2.0 - z * twice_mean) * trace_b
        layer = _layer_energy(trace, middle + np.log1p(fiber), mu, lam)
        faces += FACE_WEIGHT * (layer - membrane)
    return thickness * membrane, thickness * faces


@njit(cache=True)
def _curvature_derivatives(a0, a1, a2, b, d_log, d_mean, d_gauss, second, mean_2, gauss_2, log_2):
    """Derivatives of ln det a, 2 H and K in s = (a11, a12, a22, b11, b12, b22); returns 2 H, K.

    With second derivatives if `second`.
    """
    det = a0 * a2 - a1 * a1
    top = a2 * b[0] + a0 * b[2] - 2.0 * a1 * b[1]
    bottom = b[0] * b[2] - b[1] * b[1]
    twice_mean, gauss = top / det, bottom / det
    d_log[:] = 0.0
    d_log[0], d_log[1], d_log[2] = a2 / det, -2.0 * a1 / det, a0 / det
    d_top = (b[2], -2.0 * b[1], b[0], a2, -2.0 * a1, a0)
    d_bottom = (0.0, 0.0, 0.0, b[2], -2.0 * b[1], b[0])
    for i in range(6):
        d_mean[i] = d_top[i] / det - twice_mean * d_log[i]
        d_gauss[i] = d_bottom[i] / det - gauss * d_log[i]
    if not second:
        return twice_mean, gauss
    for i in range(6):
        for j in range(6):
            mixed, square, own = 0.0, 0.0, 0.0
            if i < 3 and j < 3:
                own = _pairing(i, j) / det - d_log[i] * d_log[j]
            elif i >= 3 and j >= 3:
                square = _pairing(i - 3, j - 3) / det
            else:
                mixed = _pairing(i % 3, j % 3) / det
            turned = d_log[i] * d_log[j] - own
            log_2[i, j] = own
            crossed = d_top[i] * d_log[j] + d_log[i] * d_top[j]
            mean_2[i, j] = mixed - crossed / det + twice_mean * turned
            crossed = d_bottom[i] * d_log[j] + d_log[i] * d_bottom[j]
            gauss_2[i, j] = square - crossed / det + gauss * turned
    return twice_mean, gauss


@njit(cache=True)
def _pairing(i, j):
    """Second derivatives of det: 1 for (11, 22), -2 for (12, 12)."""
    if i == 1 and j == 1:
        return -2.0
    return 1.0 if i + j == 2 and i != j else 0.0


@njit(cache=True)
def layered_law(e, b, mu, lam, thickness, grad, hess, work):
    """Gradient (6,) and Hessian (6, 6) of both energies of `layered_energy` together.

    In s = (a11, a12, a22, b11, b12, b22). Pass `hess` of shape (0, 0) to skip it; `work` is (23,
    6).
    """
    second = hess.shape[0] > 0
    a0, a1, a2 = 1.0 + e[0], e[1], 1.0 + e[2]
    d_log, d_mean, d_gauss = work[0], work[1], work[2]
    d_trace, d_fiber = work[3], work[4]
    mean_2, gauss_2, log_2 = work[5:11], work[11:17], work[17:23]
    twice_mean, gauss = _curvature_derivatives(
        a0, a1, a2, b, d_log, d_mean, d_gauss, second, mean_2, gauss_2, log_2
    )
    middle = 0.5 * np.log1p(e[0] + e[2] + e[0] * e[2] - e[1] * e[1])
    trace_a, trace_b = a0 + a2, b[0] + b[2]
    grad[:] = 0.0
    if second:
        hess[:] = 0.0
    for layer in range(3):
        z = 0.5 * thickness * (layer - 1)
        weight = thickness * (FACE_WEIGHT if layer != 1 else 1.0 - 2.0 * FACE_WEIGHT)
        fiber = 1.0 - z * twice_mean + z * z * gauss
        y = 1.0 + thickness_stretch_squared(middle + np.log(fiber), mu, lam)
        slope, bend = -mu * y, mu * lam / (mu + 0.5 * lam / y)
        for i in range(6):
            d_trace[i] = z * z * (trace_b * d_mean[i] - trace_a * d_gauss[i])
            d_fiber[i] = (-z * d_mean[i] + z * z * d_gauss[i]) / fiber
        for i in (0, 2):
            d_trace[i] += 1.0 - z * z * gauss
            d_trace[3 + i] -= z * (2.0 - z * twice_mean)
        for i in range(6):
            grad[i] += weight * (0.5 * mu * d_trace[i] + slope * (0.5 * d_log[i] + d_fiber[i]))
        if not second:
            continue
        of_mean = 0.5 * mu * z * z * trace_b - slope * z / fiber
        of_gauss = z * z * (slope / fiber - 0.5 * mu * trace_a)
        for i in range(6):
            d_i = 0.5 * d_log[i] + d_fiber[i]
            for j in range(6):
                d_j = 0.5 * d_log[j] + d_fiber[j]
                hess[i, j] += weight * (
                    of_mean * mean_2[i, j]
                    + of_gauss * gauss_2[i, j]
                    + bend * d_i * d_j
                    + slope * (0.5 * log_2[i, j] - d_fiber[i] * d_fiber[j])
                )
        half = 0.5 * weight * mu * z * z
        for i in (0, 2):
            for j in range(6):
                hess[i, j] -= half * d_gauss[j]
                hess[j, i] -= half * d_gauss[j]
                hess[3 + i, j] += half * d_mean[j]
                hess[j, 3 + i] += half * d_mean[j]

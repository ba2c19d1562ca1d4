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
def layered_law(e, b, mu, lam, thickness, grad, hess, work):
    """Gradient (6,) and Hessian (6, 6) of both energies of `layered_energy` together.

    In s = (a11, a12, a22, b11, b12, b22). Pass `hess` of shape (0, 0) to skip it; `work` is (3,
    6).

    Every layer's energy is a function of l = ln det a, m = 2 H, k = K, tr a and tr b. With P the
    second derivatives of a determinant, 1 for (11, 22) and -2 for (12, 12),

        d2l = P_aa / det a - dl dl,
        d2m = P_ab / det a - m P_aa / det a - dm dl - dl dm,
        d2k = P_bb / det a - k P_aa / det a - dk dl - dl dk,

    so that the Hessian is P times scalars, and products of the three gradients and those of the
    traces; only scalars are summed over the layers.
    """
    a0, a1, a2 = 1.0 + e[0], e[1], 1.0 + e[2]
    det = a0 * a2 - a1 * a1
    mean = (a2 * b[0] + a0 * b[2] - 2.0 * a1 * b[1]) / det  # twice the mean curvature
    gauss = (b[0] * b[2] - b[1] * b[1]) / det
    dl, dm, dk = work[0], work[1], work[2]
    dl[0], dl[1], dl[2] = a2 / det, -2.0 * a1 / det, a0 / det
    for i in range(3):
        mirrored = -2.0 * b[1] if i == 1 else b[2 - i]
        dm[i] = mirrored / det - mean * dl[i]
        dm[3 + i] = dl[i]
        dk[i] = -gauss * dl[i]
        dk[3 + i] = mirrored / det
        dl[3 + i] = 0.0
    middle = 0.5 * np.log1p(e[0] + e[2] + e[0] * e[2] - e[1] * e[1])
    trace_a, trace_b = a0 + a2, b[0] + b[2]
    # Derivatives by l, m, k and the traces of a and b; second ones by pairs of the first three.
    by_l, by_m, by_k, by_a, by_b = 0.0, 0.0, 0.0, 0.0, 0.0
    ll, lm, lk, mm, mk, kk, square = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for layer in range(3):
        z = 0.5 * thickness * (layer - 1)
        weight = thickness * (FACE_WEIGHT if layer != 1 else 1.0 - 2.0 * FACE_WEIGHT)
        half = 0.5 * weight * mu
        fiber = 1.0 - z * mean + z * z * gauss
        y = 1.0 + thickness_stretch_squared(middle + np.log(fiber), mu, lam)
        slope = -weight * mu * y
        bend = weight * mu * lam / (mu + 0.5 * lam / y)
        of_m, of_k = -z / fiber, z * z / fiber  # derivatives of ln w
        by_l += 0.5 * slope
        by_m += half * z * z * trace_b + slope * of_m
        by_k += slope * of_k - half * z * z * trace_a
        by_a += half * (1.0 - z * z * gauss)
        by_b -= half * z * (2.0 - z * mean)
        square += half * z * z
        ll += 0.25 * bend
        lm += 0.5 * bend * of_m
        lk += 0.5 * bend * of_k
        mm += (bend - slope) * of_m * of_m
        mk += (bend - slope) * of_m * of_k
        kk += (bend - slope) * of_k * of_k
    for i in range(6):
        grad[i] = by_l * dl[i] + by_m * dm[i] + by_k * dk[i]
    for i in (0, 2):
        grad[i] += by_a
        grad[3 + i] += by_b
    if hess.shape[0] == 0:
        return
    ll -= by_l
    lm -= by_m
    lk -= by_k
    for i in range(6):
        with_l = ll * dl[i] + lm * dm[i] + lk * dk[i]
        with_m = lm * dl[i] + mm * dm[i] + mk * dk[i]
        with_k = lk * dl[i] + mk * dm[i] + kk * dk[i]
        for j in range(i + 1):
            hess[i, j] = with_l * dl[j] + with_m * dm[j] + with_k * dk[j]
    _add_pairing(hess, 0, 0, (by_l - mean * by_m - gauss * by_k) / det)
    _add_pairing(hess, 3, 0, by_m / det)
    _add_pairing(hess, 3, 3, by_k / det)
    for i in (0, 2):
        # The lower triangle of products of the traces' gradients with dk and dm.
        for j in range(6):
            twice = 2.0 if j == i else 1.0
            hess[max(i, j), min(i, j)] -= twice * square * dk[j]
            twice = 2.0 if j == 3 + i else 1.0
            hess[max(3 + i, j), min(3 + i, j)] += twice * square * dm[j]
    for i in range(6):
        for j in range(i):
            hess[j, i] = hess[i, j]


@njit(cache=True)
def _add_pairing(hess, row, column, factor):
    """Add factor P to the lower triangle of hess, P's first entry at (row, column)."""
    hess[row + 2, column] += factor
    hess[row + 1, column + 1] -= 2.0 * factor
    if row != column:
        hess[row, column + 2] += factor

"""Energy per rest area of a thin Neo-Hookean sheet that is flat at rest, with its derivatives.

The state of a point is the first form a and second form b of the midsurface in rest coordinates,
s = (a11, a12, a22, b11, b12, b22); off-diagonals are one variable each.

Membrane: t Psi with the thickness stretch lambda_3 eliminated (plane stress). With L = ln sqrt(det
a) and y = lambda_3^2 the condition dPsi/dlambda_3 = 0 reads  mu (y - 1) + lambda (L + ln(y)/2) = 0,
and then

    Psi = mu/2 (tr a - 2) + m(L),   m' = -mu y,   m'' = mu lambda / (mu + lambda / (2 y)).

Bending: D/2 [(1 - nu) tr S^2 + nu (tr S)^2] = D/2 [(tr S)^2 - 2 (1 - nu) det S] with the turn of
the normal per rest length, S = U^-1/2 b U^-1/2, U = sqrt(a). This symmetrization of U^-1 b has its
traces. In two dimensions U = (a + J I) / tau with J = sqrt(det a), tau = sqrt(tr a + 2 J), hence
tr S = n f with n = adj(a) : b + J tr b and f = 1 / (tau J), and det S = det b / J.
"""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True)
def thickness_stretch_squared(log_area, mu, lam):
    """y - 1 where y = lambda_3^2 solves mu (y - 1) + lambda (L + ln(y)/2) = 0, L = `log_area`."""
    # In ln y the equation is increasing and convex, so Newton's method converges from any start;
    # near the root Halley's takes an error of 1e-6 to rounding.
    z = -lam * log_area / (mu + 0.5 * lam)
    for _ in range(60):
        growth = np.expm1(z)
        curve = mu * (1.0 + growth)
        step = (mu * growth + lam * (log_area + 0.5 * z)) / (curve + 0.5 * lam)
        if abs(step) < 0.5:
            step /= 1.0 - 0.5 * step * curve / (curve + 0.5 * lam)
        z -= step
        if abs(step) <= 1e-6 * abs(z):
            break
    return np.expm1(z)


@njit(cache=True)
def membrane_energy(e11, e12, e22, mu, lam):
    """Plane-stress energy per rest volume [MPa]; e = a - I."""
    log_area = 0.5 * np.log1p(e11 + e22 + e11 * e22 - e12 * e12)
    d = thickness_stretch_squared(log_area, mu, lam)
    log_volume = log_area + 0.5 * np.log1p(d)
    return 0.5 * mu * (e11 + e22 + d - 2.0 * log_volume) + 0.5 * lam * log_volume * log_volume


@njit(cache=True)
def bending_energy(a, b, area, nu):
    """Bending energy per rest area over D [mm-2]; a, b as (11, 12, 22), area = sqrt(det a)."""
    factor = 1.0 / area
    trace = a[2] * b[0] + a[0] * b[2] - 2.0 * a[1] * b[1]
    tau = np.sqrt(a[0] + a[2] + 2.0 * area)
    trace = (trace + area * (b[0] + b[2])) / (tau * area)
    return 0.5 * trace * trace - (1.0 - nu) * (b[0] * b[2] - b[1] * b[1]) * factor


@njit(cache=True)
def shell_law(e, b, mu, lam, thickness, bending_stiffness, nu, grad, hess):
    """Gradient (6,) and Hessian (6, 6) of the energy per rest area in s = (a11, a12, a22, b11, b12,
    b22).

    `e` = a - I as (11, 12, 22), `b` [mm-1]. Pass `hess` of shape (0, 0) to skip it.
    """
    a0, a1, a2 = 1.0 + e[0], e[1], 1.0 + e[2]
    det_minus_one = e[0] + e[2] + e[0] * e[2] - e[1] * e[1]
    log_area = 0.5 * np.log1p(det_minus_one)
    area = np.sqrt(1.0 + det_minus_one)
    d_log = (0.5 * a2 / area**2, -a1 / area**2, 0.5 * a0 / area**2)
    d_area = (area * d_log[0], area * d_log[1], area * d_log[2])

    y = 1.0 + thickness_stretch_squared(log_area, mu, lam)
    d_m = -mu * y
    grad[0] = thickness * (0.5 * mu + d_m * d_log[0])
    grad[1] = thickness * d_m * d_log[1]
    grad[2] = thickness * (0.5 * mu + d_m * d_log[2])

    trace_b = b[0] + b[2]
    tau = np.sqrt(a0 + a2 + 2.0 * area)
    d_s = (1.0 + 2.0 * d_area[0], 2.0 * d_area[1], 1.0 + 2.0 * d_area[2])  # s = tau^2
    f = 1.0 / (tau * area)
    d_f = np.zeros(6)
    for i in range(3):
        d_f[i] = f * (-0.5 * d_s[i] / tau**2 - d_log[i])
    n = (a2 * b[0] + a0 * b[2] - 2.0 * a1 * b[1]) + area * trace_b
    d_n = np.empty(6)
    d_n[0] = b[2] + trace_b * d_area[0]
    d_n[1] = -2.0 * b[1] + trace_b * d_area[1]
    d_n[2] = b[0] + trace_b * d_area[2]
    d_n[3] = a2 + area
    d_n[4] = -2.0 * a1
    d_n[5] = a0 + area
    trace = n * f
    d_trace = d_n * f + n * d_f
    det_b = b[0] * b[2] - b[1] * b[1]
    d_det_b = (b[2], -2.0 * b[1], b[0])
    gauss = (1.0 - nu) / area
    for i in range(6):
        grad_i = trace * d_trace[i]
        if i < 3:
            grad_i += gauss * det_b * d_log[i]
            grad[i] += bending_stiffness * grad_i
        else:
            grad[i] = bending_stiffness * (grad_i - gauss * d_det_b[i - 3])
    if hess.shape[0] == 0:
        return

    # Second derivatives of ln J and J.
    inv2 = 1.0 / area**2
    dd_log = np.empty((3, 3))
    dd_det = np.zeros((3, 3))
    dd_det[0, 2] = dd_det[2, 0] = 1.0
    dd_det[1, 1] = -2.0
    dd_area = np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            dd_log[i, j] = 0.5 * dd_det[i, j] * inv2 - 2.0 * d_log[i] * d_log[j]
            dd_area[i, j] = area * (dd_log[i, j] + d_log[i] * d_log[j])

    dd_m = mu * lam / (mu + 0.5 * lam / y)
    for i in range(6):
        for j in range(6):
            value = d_trace[i] * d_trace[j] + trace * (d_n[i] * d_f[j] + d_f[i] * d_n[j])
            if i < 3 and j < 3:
                dd_f = d_f[i] * d_f[j] / f + f * (
                    0.5 * d_s[i] * d_s[j] / tau**4 - dd_area[i, j] / tau**2 - dd_log[i, j]
                )
                value += trace * (trace_b * dd_area[i, j] * f + n * dd_f)
                value += gauss * det_b * (dd_log[i, j] - d_log[i] * d_log[j])
            elif i < 3 or j < 3:
                low, high = min(i, j), max(i, j) - 3
                value += trace * f * _mixed_trace_numerator(low, high, d_area)
                value += gauss * d_det_b[high] * d_log[low]
            else:
                value -= gauss * _det_hessian(i - 3, j - 3)
            hess[i, j] = bending_stiffness * value
            if i < 3 and j < 3:
                hess[i, j] += thickness * (dd_m * d_log[i] * d_log[j] + d_m * dd_log[i, j])


@njit(cache=True)
def _mixed_trace_numerator(i, j, d_area):
    """d2n / da_i db_j of n = adj(a) : b + J tr b."""
    trace_part = 0.0 if j == 1 else d_area[i]
    if i == 1:
        return trace_part - (2.0 if j == 1 else 0.0)
    return trace_part + (1.0 if i + j == 2 and j != 1 else 0.0)


@njit(cache=True)
def _det_hessian(i, j):
    if i == 1 and j == 1:
        return -2.0
    return 1.0 if i + j == 2 and i != j else 0.0

"""Rigid scales of a bent cell: poses of scales and of their neighbors, with all derivatives.

A rigid scale has six unknowns: where its anchor moved, w, and how it turned, the Gibbs vector
c = tan(turn / 2) axis, both in a frame at its anchor. Frames of two scales whose anchors are D
apart at rest differ by a motion that D, the in-plane stretch F = I + S and the curvature tensor k
determine alone: the exponential of the twist with translation F D and rotation (k F D) x e3,

    x -> Q x + V F D,   Q = exp[omega],   V = (exp[omega] - 1) / [omega],   omega = (k F D) x e3.

For a single curvature these are the screw motions of a cylinder, which the paper's conditions (3)
to (6) ask for, so that it does not matter over which scales one goes from one scale to another.
For two curvatures it does, by terms of the order of their product and the square of the way: every
pair of neighbors sees its own motion, and no surface needs to fit them all.
"""

from __future__ import annotations

from math import factorial

import numpy as np
from numba import njit

from flexscale.arrays import FloatArray
from flexscale.mechanics.jets import add_product, add_scaled, compose, constant

N_VARIABLES = 16
OF_A, OF_B, OF_S, OF_KAPPA = 0, 6, 12, 15
N_MOTION = 4  # S and kappa, on which the motion between two frames depends
_SMALL, _TERMS = 1.0, 12  # squared turn below which functions of it are series of so many terms
_SERIES = np.array(
    [[(-1.0) ** m / factorial(2 * m + 1 + k) for m in range(_TERMS)] for k in range(3)]
)


@njit(cache=True, error_model="numpy")
def turn_functions(s: float, out: FloatArray) -> None:
    """sin(t)/t, (1 - cos t)/t^2, (t - sin t)/t^3 of s = t^2, each with two derivatives by s.

    out : (3, 3) value, first and second derivative of each.
    """
    if s < _SMALL:
        for k in range(3):  # sum over m of (-s)^m / (2 m + 1 + k)!, the last term first
            value = slope = bend = 0.0
            for m in range(_TERMS - 1, -1, -1):
                bend = 2.0 * slope + s * bend
                slope = value + s * slope
                value = _SERIES[k, m] + s * value
            out[k, 0], out[k, 1], out[k, 2] = value, slope, bend
        return
    t = np.sqrt(s)
    out[0, 0], out[1, 0] = np.sin(t) / t, (1.0 - np.cos(t)) / s
    out[2, 0] = (t - np.sin(t)) / (s * t)
    # By s: d f_k = (f_(k-1) - (k + 1) f_k) / 2 s with f_(-1) = cos t, and d cos t = -f_0 / 2.
    for k in range(3):
        lower = np.cos(t) if k == 0 else out[k - 1, 0]
        out[k, 1] = (lower - (k + 1.0) * out[k, 0]) / (2.0 * s)
    for k in range(3):
        lower = -0.5 * out[0, 0] if k == 0 else out[k - 1, 1]
        out[k, 2] = (lower - (k + 1.0) * out[k, 1]) / (2.0 * s) - out[k, 1] / s


@njit(cache=True, error_model="numpy")
def rotation_of(
    c: FloatArray, rotation: FloatArray, slopes: FloatArray, bends: FloatArray, order: int
) -> None:
    """R = 1 + f C, C = [c] + c c^T - |c|^2, f = 2 / (1 + |c|^2), of a Gibbs vector c.

    rotation : (3, 3); slopes : (3, 3, 3) by c_k; bends : (3, 3, 3, 3) by c_k and c_m, m >= k.
    """
    square = c[0] * c[0] + c[1] * c[1] + c[2] * c[2]
    f = 2.0 / (1.0 + square)
    inner, change = np.empty((3, 3)), np.zeros((3, 3, 3))  # C, and its slopes
    for i in range(3):
        for j in range(3):
            inner[i, j] = c[i] * c[j] - (square if i == j else 0.0)
    for k in range(3):
        i, j = (k + 1) % 3, (k + 2) % 3
        inner[j, i] += c[k]
        inner[i, j] -= c[k]
    for i in range(3):
        for j in range(3):
            rotation[i, j] = f * inner[i, j] + (1.0 if i == j else 0.0)
    if order == 0:
        return
    for k in range(3):
        for i in range(3):
            change[k, k, i] += c[i]
            change[k, i, k] += c[i]
            change[k, i, i] -= 2.0 * c[k]
        i, j = (k + 1) % 3, (k + 2) % 3
        change[k, j, i] += 1.0
        change[k, i, j] -= 1.0
        for i in range(3):
            for j in range(3):
                slopes[k, i, j] = f * change[k, i, j] - f * f * c[k] * inner[i, j]
    if order == 1:
        return
    for k in range(3):
        for m in range(k, 3):
            both = 2.0 * f * f * f * c[k] * c[m] - (f * f if k == m else 0.0)
            for i in range(3):
                for j in range(3):
                    bends[k, m, i, j] = both * inner[i, j] - f * f * (
                        c[k] * change[m, i, j] + c[m] * change[k, i, j]
                    )
            bends[k, m, k, m] += f
            bends[k, m, m, k] += f
            if k == m:
                for i in range(3):
                    bends[k, m, i, i] -= 2.0 * f


@njit(cache=True, error_model="numpy")
def neighbor_motion(
    way: FloatArray,
    lifts: FloatArray,
    base: FloatArray,
    tensor: FloatArray,
    stretch: FloatArray,
    curvature: float,
    work: FloatArray,
    out: FloatArray,
    order: int,
) -> None:
    """The motion (v, Q) between the frames of two scales, with derivatives by S and kappa.

    way : (2,) D at rest, mm; lifts : (2, 2) of a and b, at k_0 and by kappa; base, tensor : (2, 2)
    k_0 and K; stretch : (3,) S; work : (10, jet); out : (12, jet) v, then Q row by row.
    """
    n = N_MOTION
    moved, turn = work[:2], work[2:4]  # F D, and omega
    constant(moved[0], way[0] + stretch[0] * way[0] + stretch[2] * way[1])
    constant(moved[1], way[1] + stretch[2] * way[0] + stretch[1] * way[1])
    if order > 0:
        moved[0, 1], moved[0, 3] = way[0], way[1]
        moved[1, 2], moved[1, 3] = way[1], way[0]
    kappa, bent = work[4], work[5]
    constant(kappa, curvature)
    if order > 0:
        kappa[4] = 1.0
    for i in range(2):  # omega = (k_2, -k_1), k = (k_0 + kappa K) F D
        constant(bent, 0.0)
        constant(turn[i], 0.0)
        for j in range(2):
            add_scaled(bent, tensor[1 - i, j], moved[j])
            add_scaled(turn[i], (1.0 - 2.0 * i) * base[1 - i, j], moved[j])
        add_product(turn[i], 1.0 - 2.0 * i, kappa, bent, n, order)
    square = work[4]
    constant(square, 0.0)
    for i in range(2):
        add_product(square, 1.0, turn[i], turn[i], n, order)
    values = np.empty((3, 3))
    turn_functions(square[0], values)
    f = work[5:8]
    for k in range(3):
        compose(f[k], square, values[k, 0], values[k, 1], values[k, 2], n, order)
    # omega x v = (0, 0, rise); omega (omega . v) - s v = rise (omega_2, -omega_1, 0).
    rise, part = work[8], work[9]
    constant(rise, 0.0)
    add_product(rise, 1.0, turn[0], moved[1], n, order)
    add_product(rise, -1.0, turn[1], moved[0], n, order)
    constant(part, 0.0)
    add_product(part, 1.0, f[2], rise, n, order)
    for i in range(2):
        out[i] = moved[i]
        add_product(out[i], 1.0 - 2.0 * i, part, turn[1 - i], n, order)
    constant(out[2], 0.0)
    add_product(out[2], 1.0, f[1], rise, n, order)
    # Q = 1 + f0 [omega] + f1 (omega omega^T - s)
    q = out[3:]
    for i in range(2):
        for j in range(2):
            constant(part, 0.0)
            if i == j:
                add_product(part, -1.0, turn[1 - i], turn[1 - i], n, order)
            else:
                add_product(part, 1.0, turn[0], turn[1], n, order)
            constant(q[3 * i + j], 1.0 if i == j else 0.0)
            add_product(q[3 * i + j], 1.0, f[1], part, n, order)
        side = 1.0 if i == 0 else -1.0  # [omega] has (0, 2) = omega_2, (1, 2) = -omega_1
        constant(q[3 * i + 2], 0.0)
        add_product(q[3 * i + 2], side, f[0], turn[1 - i], n, order)
        constant(q[6 + i], 0.0)
        add_product(q[6 + i], -side, f[0], turn[1 - i], n, order)
    constant(q[8], 1.0)
    add_product(q[8], -1.0, f[1], square, n, order)
    height = work[4]
    for side in range(2):
        constant(height, lifts[side, 0] + lifts[side, 1] * curvature)
        if order > 0:
            height[4] = lifts[side, 1]
        if side == 0:
            add_scaled(out[2], -1.0, height)
        else:
            for i in range(3):
                add_product(out[i], 1.0, height, q[3 * i + 2], n, order)

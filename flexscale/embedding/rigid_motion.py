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

All of this is the star of scale a: in a's frame, a itself and its neighbors b, as they lie there.
Variables of a pair: w and c of a, w and c of b, S = (S_xx, S_yy, S_xy), and the curvature kappa
along a line k = kappa K of given K.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from flexscale.arrays import FloatArray
from flexscale.mechanics.jets import add_product, add_scaled, compose, constant, variable

N_VARIABLES = 16
OF_A, OF_B, OF_S, OF_KAPPA = 0, 6, 12, 15
_SMALL, _TERMS = 1.0, 14  # squared turn below which functions of it are series of so many terms


@njit(cache=True, error_model="numpy")
def turn_functions(s: float, out: FloatArray) -> None:
    """sin(t)/t, (1 - cos t)/t^2, (t - sin t)/t^3 of s = t^2, each with two derivatives by s.

    out : (3, 3) value, first and second derivative of each.
    """
    if s < _SMALL:
        out[:] = 0.0
        for k in range(3):  # sum over m of (-s)^m / (2 m + 1 + k)!
            factor = 1.0 if k < 2 else 0.5
            factor = factor / 3.0 if k == 2 else (factor / 2.0 if k == 1 else factor)
            for m in range(_TERMS):
                out[k, 0] += factor * s**m
                if m > 0:
                    out[k, 1] += factor * m * s ** (m - 1)
                if m > 1:
                    out[k, 2] += factor * m * (m - 1) * s ** (m - 2)
                factor /= -(2.0 * m + 2.0 + k) * (2.0 * m + 3.0 + k)
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
def rotation_of(c: FloatArray, work: FloatArray, out: FloatArray, n: int, order: int) -> None:
    """R = 1 + 2 ([c] + [c][c]) / (1 + |c|^2) of a Gibbs vector.

    c : (3, jet); work : (2, jet); out : (9, jet), row by row.
    """
    square, factor = work[0], work[1]
    constant(square, 1.0)
    for i in range(3):
        add_product(square, 1.0, c[i], c[i], n, order)
    v = square[0]
    compose(factor, square, 2.0 / v, -2.0 / v**2, 4.0 / v**3, n, order)
    for i in range(3):
        for j in range(3):
            entry = square  # the squared length is not needed any more
            constant(entry, 0.0)
            if i == j:  # c_i^2 - |c|^2
                for k in range(3):
                    if k != i:
                        add_product(entry, -1.0, c[k], c[k], n, order)
            else:
                k = 3 - i - j
                add_product(entry, 1.0, c[i], c[j], n, order)
                add_scaled(entry, -1.0 if (j - i) % 3 == 1 else 1.0, c[k])
            constant(out[3 * i + j], 1.0 if i == j else 0.0)
            add_product(out[3 * i + j], 1.0, factor, entry, n, order)


@njit(cache=True, error_model="numpy")
def neighbor_motion(
    way: FloatArray,
    tensor: FloatArray,
    stretch: FloatArray,
    curvature: float,
    work: FloatArray,
    out: FloatArray,
    n: int,
    order: int,
) -> None:
    """The motion (V F D, Q) between the frames of two scales.

    way : (2,) D at rest, mm; tensor : (2, 2) K; stretch : (3,) S; work : (12, jet); out : (12, jet)
    translation, then Q row by row.
    """
    moved, turn = work[:2], work[2:4]  # F D, and omega
    constant(moved[0], way[0] + stretch[0] * way[0] + stretch[2] * way[1])
    constant(moved[1], way[1] + stretch[2] * way[0] + stretch[1] * way[1])
    if order > 0:
        moved[0, 1 + OF_S], moved[0, 3 + OF_S] = way[0], way[1]
        moved[1, 2 + OF_S], moved[1, 3 + OF_S] = way[1], way[0]
    kappa, bent = work[4], work[5]
    constant(kappa, curvature)
    if order > 0:
        kappa[1 + OF_KAPPA] = 1.0
    for i in range(2):  # omega = (k_2, -k_1), k = kappa K F D
        constant(bent, 0.0)
        for j in range(2):
            add_scaled(bent, tensor[1 - i, j], moved[j])
        constant(turn[i], 0.0)
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


N_WORK = 40  # rows of jets that the kernels below work in


@njit(cache=True, error_model="numpy")
def place_pair(
    a: FloatArray,
    b: FloatArray,
    lifts: FloatArray,
    way: FloatArray,
    tensor: FloatArray,
    stretch: FloatArray,
    curvature: float,
    work: FloatArray,
    out: FloatArray,
    n: int,
    order: int,
) -> None:
    """Poses of a scale and of its neighbor, in the frame of the first.

    a, b : (6,) unknowns of both; lifts : (2,) of their anchors by kappa; way : (2,) between anchors
    at rest, mm; tensor : (2, 2) K; stretch : (3,) S; work : (N_WORK, jet).
    out : (24, jet) of each scale the place of its anchor (3) and its rotation, row by row (9).
    """
    c = work[:3]
    for i in range(3):
        variable(c[i], a[3 + i], OF_A + 3 + i) if order > 0 else constant(c[i], a[3 + i])
    rotation_of(c, work[3:5], out[3:12], n, order)
    for i in range(3):
        constant(out[i], a[i])
        if order > 0:
            out[i, 1 + OF_A + i] = 1.0
    out[2, 0] += curvature * lifts[0]
    if order > 0:
        out[2, 1 + OF_KAPPA] = lifts[0]
    for i in range(3):
        variable(c[i], b[3 + i], OF_B + 3 + i) if order > 0 else constant(c[i], b[3 + i])
    own, place = work[3:12], work[12:15]
    rotation_of(c, work[15:17], own, n, order)
    for i in range(3):
        constant(place[i], b[i])
        if order > 0:
            place[i, 1 + OF_B + i] = 1.0
    place[2, 0] += curvature * lifts[1]
    if order > 0:
        place[2, 1 + OF_KAPPA] = lifts[1]
    motion = work[15:27]
    neighbor_motion(way, tensor, stretch, curvature, work[27:39], motion, n, order)
    for i in range(3):
        out[12 + i] = motion[i]
        for k in range(3):
            add_product(out[12 + i], 1.0, motion[3 + 3 * i + k], place[k], n, order)
        for j in range(3):
            constant(out[15 + 3 * i + j], 0.0)
            for k in range(3):
                add_product(
                    out[15 + 3 * i + j], 1.0, motion[3 + 3 * i + k], own[3 * k + j], n, order
                )


@njit(cache=True, error_model="numpy")
def relative_pose(
    poses: FloatArray,
    arm_a: FloatArray,
    arm_b: FloatArray,
    work: FloatArray,
    out: FloatArray,
    n: int,
    order: int,
) -> None:
    """How a scale lies against another, in the frame midway between the two.

    poses : (24, jet) of `place_pair`; arm_a, arm_b : (3,) mm, from the anchors to a point at rest.
    out : (6, jet) arrow from the point as part of a to it as part of b, mm; then 2 sin(t/2) axis of
    the turn t from a to b. A point at r from the first then opens by arrow + turn x r.
    """
    ra, rb = poses[3:12], poses[15:24]
    arrow, q0, q = work[:3], work[3], out[3:]
    for i in range(3):
        arrow[i] = poses[12 + i]
        add_scaled(arrow[i], -1.0, poses[i])
        for j in range(3):
            add_scaled(arrow[i], arm_b[j], rb[3 * i + j])
            add_scaled(arrow[i], -arm_a[j], ra[3 * i + j])
    constant(q0, 1.0)  # 1 + trace of A^T B
    for i in range(9):
        add_product(q0, 1.0, ra[i], rb[i], n, order)
    v = q0[0]
    root = np.sqrt(v)
    half = work[4]  # 1 / (2 root): of the axial part of A^T B, which has 4 q0 times q, with 2 q
    compose(half, q0, 1.0 / root, -0.5 / (v * root), 0.75 / (v * v * root), n, order)
    compose(q0, q0, 0.5 * root, 0.25 / root, -0.125 / (v * root), n, order)
    axial = work[5]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        constant(axial, 0.0)
        for m in range(3):  # (A^T B)_kj - (A^T B)_jk
            add_product(axial, 1.0, ra[3 * m + k], rb[3 * m + j], n, order)
            add_product(axial, -1.0, ra[3 * m + j], rb[3 * m + k], n, order)
        constant(q[i], 0.0)
        add_product(q[i], 1.0, half, axial, n, order)
    # Half the turn has the Gibbs vector q / (1 + q0), and 2 q is in `out`.
    gibbs, share = work[6:9], work[5]
    v = 1.0 + q0[0]
    compose(share, q0, 0.5 / v, -0.5 / v**2, 1.0 / v**3, n, order)
    for i in range(3):
        constant(gibbs[i], 0.0)
        add_product(gibbs[i], 1.0, share, q[i], n, order)
    rotation_of(gibbs, work[9:11], work[11:20], n, order)
    turned = work[20:23]  # A^T arrow
    for i in range(3):
        constant(turned[i], 0.0)
        for j in range(3):
            add_product(turned[i], 1.0, ra[3 * j + i], arrow[j], n, order)
    for i in range(3):
        constant(out[i], 0.0)
        for j in range(3):
            add_product(out[i], 1.0, work[11 + 3 * j + i], turned[j], n, order)

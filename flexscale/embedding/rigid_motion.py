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

What strains a joint, and what touches, depends on how scale b lies against scale a alone: with A, B
the turns of both, and y the arrow between their anchors in a's frame,

    t = A^T y,   G = A^T Q B,   y = Q w_b + v - w_a,
    v = V F D + kappa (lift_b Q e_3 - lift_a e_3),

where lifts are heights of anchors by kappa. Variables of a pair are w and c of a, w and c of b,
S = (S_xx, S_yy, S_xy), and the curvature kappa along a line k = kappa K of given K. A pose changes
by tau of t, and by alpha of G -> G exp[alpha]. An energy of the pose has a gradient (g, m) and a
Hessian H by these six; by the 16 variables, with J the derivatives of (tau, alpha), its Hessian is
J^T H J and the second derivatives of

    g . t + <N, G>,   N = G_0 [m] / 2,

with g and N held. Each factor of t and G depends on variables of its own.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from flexscale.arrays import FloatArray
from flexscale.mechanics.jets import add_product, add_scaled, compose, constant

N_VARIABLES = 16
OF_A, OF_B, OF_S, OF_KAPPA = 0, 6, 12, 15
N_MOTION = 4  # S and kappa, on which the motion between two frames depends
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
    tensor: FloatArray,
    stretch: FloatArray,
    curvature: float,
    work: FloatArray,
    out: FloatArray,
    order: int,
) -> None:
    """The motion (v, Q) between the frames of two scales, with derivatives by S and kappa.

    way : (2,) D at rest, mm; lifts : (2,) of a and b; tensor : (2, 2) K; stretch : (3,) S; work :
    (10, jet); out : (12, jet) v, then Q row by row.
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
    constant(kappa, curvature)
    if order > 0:
        kappa[4] = 1.0
    for i in range(3):
        add_product(out[i], lifts[1], kappa, q[3 * i + 2], n, order)
    add_scaled(out[2], -lifts[0], kappa)


@njit(cache=True, error_model="numpy")
def _multiply(a: FloatArray, b: FloatArray, out: FloatArray) -> None:
    """out = a b."""
    for i in range(3):
        for j in range(3):
            out[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j]


@njit(cache=True, error_model="numpy")
def _multiply_turned(a: FloatArray, b: FloatArray, out: FloatArray) -> None:
    """out = a^T b."""
    for i in range(3):
        for j in range(3):
            out[i, j] = a[0, i] * b[0, j] + a[1, i] * b[1, j] + a[2, i] * b[2, j]


@njit(cache=True, error_model="numpy")
def _inner(a: FloatArray, b: FloatArray) -> float:
    """Sum of the products of all entries."""
    total = 0.0
    for i in range(3):
        for j in range(3):
            total += a[i, j] * b[i, j]
    return total


@njit(cache=True, error_model="numpy")
def _matrix(motion: FloatArray, entry: int, out: FloatArray) -> None:
    """Q, or a derivative of it."""
    for i in range(3):
        for j in range(3):
            out[i, j] = motion[3 + 3 * i + j, entry]


@njit(cache=True, error_model="numpy")
def _arrow(motion: FloatArray, entry: int, w: FloatArray, out: FloatArray) -> None:
    """Q w + v, or a derivative of it."""
    for i in range(3):
        out[i] = motion[i, entry]
        for j in range(3):
            out[i] += motion[3 + 3 * i + j, entry] * w[j]


@njit(cache=True, error_model="numpy")
def relative_pose(
    own: FloatArray,
    other: FloatArray,
    motion: FloatArray,
    turns: FloatArray,
    pose: FloatArray,
    work: FloatArray,
) -> None:
    """How scale b lies against scale a.

    own, other : (3,) w of both; motion : of `neighbor_motion`; turns : (2, 3, 3) A and B. pose :
    (4, 3) filled with t and G; work : (5, 3, 3), of which `pose_slopes` needs Q, Q B and y again.
    """
    base, turned, way = work[0], work[1], work[2, 0]
    _matrix(motion, 0, base)
    _multiply(base, turns[1], turned)
    _arrow(motion, 0, other, way)
    for i in range(3):
        way[i] -= own[i]
    for i in range(3):
        pose[0, i] = turns[0, 0, i] * way[0] + turns[0, 1, i] * way[1] + turns[0, 2, i] * way[2]
    _multiply_turned(turns[0], turned, pose[1:])


@njit(cache=True, error_model="numpy")
def pose_slopes(
    other: FloatArray,
    motion: FloatArray,
    turns: FloatArray,
    slopes: FloatArray,
    pose: FloatArray,
    n_motion: int,
    work: FloatArray,
    out: FloatArray,
) -> None:
    """J (6, 16) of tau and alpha by the variables; work : as `relative_pose` left it.

    slopes : (2, 3, 3, 3) of A and B; n_motion : 4, or 0 if S and kappa are held.
    """
    base, turned, way, change, spin = work[0], work[1], work[2, 0], work[3], work[4]
    out[:] = 0.0
    for i in range(3):
        for j in range(3):
            out[i, OF_A + j] = -turns[0, j, i]
            out[i, OF_B + j] = (
                turns[0, 0, i] * base[0, j]
                + turns[0, 1, i] * base[1, j]
                + turns[0, 2, i] * base[2, j]
            )
    for k in range(3):
        part = slopes[0, k]
        for i in range(3):
            out[i, OF_A + 3 + k] = part[0, i] * way[0] + part[1, i] * way[1] + part[2, i] * way[2]
        _multiply_turned(part, turned, change)
        _multiply_turned(pose[1:], change, spin)
        _set_axial(spin, out, OF_A + 3 + k)
        _multiply_turned(turns[1], slopes[1, k], spin)
        _set_axial(spin, out, OF_B + 3 + k)
    rate, part = work[2, 1], work[2, 2]
    for m in range(n_motion):
        _arrow(motion, 1 + m, other, rate)
        for i in range(3):
            out[i, OF_S + m] = (
                turns[0, 0, i] * rate[0] + turns[0, 1, i] * rate[1] + turns[0, 2, i] * rate[2]
            )
        _matrix(motion, 1 + m, spin)
        _multiply(spin, turns[1], change)
        _multiply_turned(turned, change, spin)
        _set_axial(spin, out, OF_S + m)


@njit(cache=True, error_model="numpy")
def _set_axial(x: FloatArray, out: FloatArray, column: int) -> None:
    """The vector of an antisymmetric matrix, into the last three rows."""
    out[3, column], out[4, column], out[5, column] = x[2, 1], x[0, 2], x[1, 0]


@njit(cache=True, error_model="numpy")
def add_pose_bends(
    gradient: FloatArray,
    other: FloatArray,
    motion: FloatArray,
    turns: FloatArray,
    slopes: FloatArray,
    bends: FloatArray,
    pose: FloatArray,
    n_motion: int,
    work: FloatArray,
    out: FloatArray,
) -> None:
    """Add the second derivatives of g . t + <N, G> to the upper triangle of out (16, 16).

    gradient : (6,) g and m, by tau and alpha; bends : (2, 3, 3, 3, 3) of A and B; work : (12, 3, 3)
    whose first three are as `relative_pose` left them.
    """
    base, turned, way = work[0], work[1], work[2, 0]
    g, a, b = gradient[:3], OF_A + 3, OF_B + 3
    skew, held, sums, seen = work[3], work[4], work[5], work[6]  # N, V = A N, K, Q^T V
    for i in range(3):
        for j in range(3):
            skew[i, j] = 0.0
    for k in range(3):  # N = G [m] / 2
        i, j = (k + 1) % 3, (k + 2) % 3
        for row in range(3):
            skew[row, i] += 0.5 * gradient[3 + k] * pose[1 + row, j]
            skew[row, j] -= 0.5 * gradient[3 + k] * pose[1 + row, i]
    _multiply(turns[0], skew, held)
    for i in range(3):
        for j in range(3):
            sums[i, j] = way[i] * g[j] + (
                turned[i, 0] * skew[j, 0] + turned[i, 1] * skew[j, 1] + turned[i, 2] * skew[j, 2]
            )
    _multiply_turned(base, held, seen)
    force, pulled, change, third = work[2, 1], work[2, 2], work[7], work[8]
    for i in range(3):  # A g
        force[i] = turns[0, i, 0] * g[0] + turns[0, i, 1] * g[1] + turns[0, i, 2] * g[2]
    for k in range(3):
        for m in range(k, 3):
            out[a + k, a + m] += _inner(bends[0, k, m], sums)
            out[b + k, b + m] += _inner(bends[1, k, m], seen)
        part = slopes[0, k]
        for i in range(3):
            pulled[i] = part[i, 0] * g[0] + part[i, 1] * g[1] + part[i, 2] * g[2]
        for m in range(3):
            out[OF_A + m, a + k] -= pulled[m]
            out[a + k, OF_B + m] += (
                base[0, m] * pulled[0] + base[1, m] * pulled[1] + base[2, m] * pulled[2]
            )
        # <A_k, Q B_m N^T> = <Q^T A_k N, B_m>
        _multiply(part, skew, change)
        _multiply_turned(base, change, third)
        for m in range(3):
            out[a + k, b + m] += _inner(third, slopes[1, m])
    rate, matrix, entry = work[9, 0], work[10], work[11]
    for m in range(n_motion):
        s = OF_S + m
        _matrix(motion, 1 + m, matrix)
        _arrow(motion, 1 + m, other, rate)
        _multiply(matrix, turns[1], change)
        for i in range(3):
            for j in range(3):
                entry[i, j] = rate[i] * g[j] + (
                    change[i, 0] * skew[j, 0]
                    + change[i, 1] * skew[j, 1]
                    + change[i, 2] * skew[j, 2]
                )
        _multiply_turned(matrix, held, third)
        for k in range(3):
            out[a + k, s] += _inner(slopes[0, k], entry)
            out[b + k, s] += _inner(slopes[1, k], third)
            out[OF_B + k, s] += (
                force[0] * matrix[0, k] + force[1] * matrix[1, k] + force[2] * matrix[2, k]
            )
        for n in range(m, n_motion):
            both = 1 + N_MOTION + m * N_MOTION + n
            _arrow(motion, both, other, rate)
            _matrix(motion, both, matrix)
            _multiply(matrix, turns[1], change)
            out[s, OF_S + n] += (
                force[0] * rate[0] + force[1] * rate[1] + force[2] * rate[2]
            ) + _inner(change, held)

"""How a rigid scale lies against its neighbor, with all derivatives.

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

from numba import njit

from flexscale.arrays import FloatArray
from flexscale.embedding.rigid_motion import N_MOTION, OF_A, OF_B, OF_S


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

"""What a joint sees of how a scale lies against another: arrow and turn, in the frame midway."""

from __future__ import annotations

import numpy as np
from numba import njit

from flexscale.arrays import FloatArray
from flexscale.mechanics.jets import add_product, add_scaled, compose, constant, cross

N_POSE = 6  # tau and alpha of `relative_pose`
N_WORK = 18  # rows of jets that the kernels below work in


@njit(cache=True, error_model="numpy")
def turn_jets(pose: FloatArray, out: FloatArray, order: int) -> None:
    """G exp[alpha] as jets (9, jet), row by row; pose : (4, 3) t and G."""
    n = N_POSE
    out[:] = 0.0
    for i in range(3):
        row = pose[1 + i]
        for j in range(3):
            jet = out[3 * i + j]
            jet[0] = row[j]
            if order == 0:
                continue
            k, m = (j + 1) % 3, (j + 2) % 3
            # Column j of [alpha]: e_j turned by alpha, alpha x e_j = alpha_m e_k - alpha_k e_m.
            jet[1 + 3 + m] = row[k]
            jet[1 + 3 + k] = -row[m]
            if order == 1:
                continue
            # [alpha]^2 / 2 e_j = (alpha alpha_j - |alpha|^2 e_j) / 2
            for a in range(3):
                low, high = min(a, j), max(a, j)
                jet[1 + n + (3 + low) * n + 3 + high] += 0.5 * row[a] * (2.0 if a == j else 1.0)
                jet[1 + n + (3 + a) * n + 3 + a] -= row[j]


@njit(cache=True, error_model="numpy")
def place_jets(pose: FloatArray, turn: FloatArray, arm: FloatArray, out: FloatArray) -> None:
    """t + tau + G exp[alpha] arm as jets (3, jet); turn : of `turn_jets`."""
    for i in range(3):
        constant(out[i], pose[0, i])
        if out.shape[1] > 1:
            out[i, 1 + i] = 1.0
        for j in range(3):
            add_scaled(out[i], arm[j], turn[3 * i + j])


@njit(cache=True, error_model="numpy")
def middle_pose(
    pose: FloatArray,
    turn: FloatArray,
    arm_a: FloatArray,
    arm_b: FloatArray,
    work: FloatArray,
    out: FloatArray,
    order: int,
) -> None:
    """Arrow and turn between two scales, in the frame midway between them.

    pose, turn : of `turn_jets`; arm_a, arm_b : (3,) mm, from the anchors to a point at rest. out :
    (6, jet) arrow from the point as part of a to it as part of b, mm; then 2 sin(t/2) axis of the
    turn t from a to b. A point at r from the first then opens by arrow + turn x r.
    """
    n = N_POSE
    arrow, q0, half, axial, q = work[:3], work[3], work[4], work[5], out[3:]
    place_jets(pose, turn, arm_b, arrow)
    for i in range(3):
        arrow[i, 0] -= arm_a[i]
    constant(q0, 1.0)
    for i in range(3):
        add_scaled(q0, 1.0, turn[4 * i])
    v = q0[0]
    root = np.sqrt(v)
    # The axial part of G is 4 cos(t/2) sin(t/2) axis, and the root 2 cos(t/2).
    compose(half, q0, 1.0 / root, -0.5 / (v * root), 0.75 / (v * v * root), n, order)
    compose(q0, q0, 0.5 * root, 0.25 / root, -0.125 / (v * root), n, order)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        constant(axial, 0.0)
        add_scaled(axial, 1.0, turn[3 * k + j])
        add_scaled(axial, -1.0, turn[3 * j + k])
        constant(q[i], 0.0)
        add_product(q[i], 1.0, half, axial, n, order)
    # Half the turn has the Gibbs vector r = q / (2 + 2 q0).
    gibbs, share, factor, square = work[6:9], work[9], work[10], work[11]
    v = 1.0 + q0[0]
    compose(share, q0, 0.5 / v, -0.5 / v**2, 1.0 / v**3, n, order)
    constant(square, 1.0)
    for i in range(3):
        constant(gibbs[i], 0.0)
        add_product(gibbs[i], 1.0, share, q[i], n, order)
        add_product(square, 1.0, gibbs[i], gibbs[i], n, order)
    v = square[0]
    compose(factor, square, 2.0 / v, -2.0 / v**2, 4.0 / v**3, n, order)
    once, twice = work[12:15], work[15:18]  # back: x + f (x x r + (x x r) x r)
    cross(arrow, gibbs, once, n, order)
    cross(once, gibbs, twice, n, order)
    for i in range(3):
        add_scaled(twice[i], 1.0, once[i])
        out[i] = arrow[i]
        add_product(out[i], 1.0, factor, twice[i], n, order)

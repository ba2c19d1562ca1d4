"""Energies of pairs of rigid scales, and of their joints, with derivatives by all unknowns.

Unknowns z: six of each scale (w, c of `rigid_motion`), then S. Each pair has a block of the
variables of `rigid_motion`, curvature included.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from flexscale.arrays import BoolArray, FloatArray, IntArray
from flexscale.embedding.rigid_motion import N_VARIABLES, N_WORK, place_pair, relative_pose
from flexscale.mechanics.jets import add_hessian
from flexscale.mechanics.joint_law import law_at

_N = N_VARIABLES


@njit(cache=True, error_model="numpy")
def unknowns_of(first: int, second: int, n_unknowns: int, out: IntArray) -> None:
    """(16,) numbers of a pair's variables among the unknowns; kappa is one past them."""
    for i in range(6):
        out[i], out[6 + i] = 6 * first + i, 6 * second + i
    for i in range(3):
        out[12 + i] = n_unknowns - 3 + i
    out[15] = n_unknowns


@njit(cache=True, error_model="numpy")
def place_pairs(
    z: FloatArray,
    curvature: float,
    tensor: FloatArray,
    scales: IntArray,
    lifts: FloatArray,
    ways: FloatArray,
    needed: BoolArray,
    order: int,
    out: FloatArray,
) -> None:
    """Poses (n_pairs, 24, jet) of the pairs that are needed, see `place_pair`.

    scales : (n_pairs, 2); lifts : (n_scales,) of anchors by kappa; ways : (n_pairs, 2) mm.
    """
    work = np.empty((N_WORK, out.shape[2]))
    both = np.empty(2)
    stretch = z[len(z) - 3 :]
    for k in range(len(scales)):
        if not needed[k]:
            continue
        a, b = scales[k]
        both[0], both[1] = lifts[a], lifts[b]
        place_pair(
            z[6 * a : 6 * a + 6], z[6 * b : 6 * b + 6], both, ways[k], tensor, stretch, curvature,
            work, out[k], _N, order,
        )  # fmt: skip


@njit(cache=True, error_model="numpy")
def place_rows(
    poses: FloatArray, pair: IntArray, second: BoolArray, rest: FloatArray, y: FloatArray
) -> None:
    """Positions (n_rows, 3) of points of scales, each in the frame of its pair's first scale."""
    for r in range(len(pair)):
        start = 12 if second[r] else 0
        for c in range(3):
            y[r, c] = poses[pair[r], start + c, 0]
            for j in range(3):
                y[r, c] += poses[pair[r], start + 3 + 3 * c + j, 0] * rest[r, j]


@njit(cache=True, error_model="numpy")
def station_opening(
    relative: FloatArray, point: FloatArray, normal: FloatArray, q: FloatArray, rows: FloatArray
) -> float:
    """u, w, s and phi at a station, and their derivatives (4, 6) by the relative pose.

    Other entries of `rows` must be 0. Returns the sine of half the turn about the joint.
    """
    x, y = point
    n0, n1 = normal
    # The arrow at the station is that at the point and turn x (x, y, 0).
    rows[0, 0], rows[0, 1], rows[0, 5] = n0, n1, n1 * x - n0 * y  # u, along n
    rows[1, 2], rows[1, 3], rows[1, 4] = 1.0, y, -x  # w, upward
    rows[2, 0], rows[2, 1], rows[2, 5] = -n1, n0, n0 * x + n1 * y  # s, along (-n1, n0)
    for i in range(3):
        q[i] = 0.0
        for j in range(6):
            q[i] += rows[i, j] * relative[j]
    half = 0.5 * (n0 * relative[4] - n1 * relative[3])
    q[3] = -2.0 * np.arcsin(half)
    root = 1.0 / np.sqrt(1.0 - half * half)
    rows[3, 3], rows[3, 4] = n1 * root, -n0 * root
    return half


@njit(cache=True, error_model="numpy")
def all_openings(
    poses: FloatArray,
    scales: IntArray,
    arms: FloatArray,
    starts: IntArray,
    points: FloatArray,
    normals: FloatArray,
) -> FloatArray:
    """(n_stations, 4) u, w, s [mm] and phi [radian] of all stations; see `all_joints`."""
    out, rows = np.empty((len(points), 4)), np.zeros((4, 6))
    work, relative = np.empty((N_WORK, poses.shape[2])), np.empty((6, poses.shape[2]))
    for k in range(len(scales)):
        relative_pose(poses[k], arms[k, 0], arms[k, 1], work, relative, _N, 0)
        for s in range(starts[k], starts[k + 1]):
            station_opening(relative[:, 0].copy(), points[s], normals[s], out[s], rows)
    return out


@njit(cache=True, error_model="numpy")
def joint_energy(
    relative: FloatArray,
    points: FloatArray,
    normals: FloatArray,
    weights: FloatArray,
    exponents: IntArray,
    coefficients: FloatArray,
    thickness: float,
    modulus: float,
    bounds: FloatArray,
    gradient: FloatArray,
    hessian: FloatArray,
) -> float:
    """Energy of the joints of one pair, N mm, with its derivatives by the relative pose.

    relative : (6,) arrow and turn of `relative_pose`; points : (n, 2) stations from its point, mm;
    normals (n, 2) and weights (n,) mm; the others are a law's. gradient (6,) and hessian (6, 6) are
    filled.
    """
    gradient[:] = 0.0
    hessian[:] = 0.0
    energy = 0.0
    q, slope, bend, rows = np.empty(4), np.empty(4), np.empty((4, 4)), np.zeros((4, 6))
    for s in range(len(points)):
        half = station_opening(relative, points[s], normals[s], q, rows)
        root = 1.0 / np.sqrt(1.0 - half * half)
        energy += weights[s] * law_at(
            exponents, coefficients, thickness, modulus, bounds, q, slope, bend
        )
        # phi is the one that is not linear: d2 phi = -half / 2 root^3 of both factors of half's.
        curl = -0.5 * half * root * slope[3]
        for i in range(6):
            for a in range(4):
                if rows[a, i] == 0.0:
                    continue
                gradient[i] += weights[s] * slope[a] * rows[a, i]
                for j in range(6):
                    for b in range(4):
                        hessian[i, j] += weights[s] * rows[a, i] * bend[a, b] * rows[b, j]
        for i in (3, 4):
            for j in (3, 4):
                hessian[i, j] += weights[s] * curl * rows[3, i] * rows[3, j]
    return energy


@njit(cache=True, error_model="numpy")
def all_joints(
    poses: FloatArray,
    scales: IntArray,
    arms: FloatArray,
    starts: IntArray,
    points: FloatArray,
    normals: FloatArray,
    weights: FloatArray,
    exponents: IntArray,
    coefficients: FloatArray,
    thickness: float,
    modulus: float,
    bounds: FloatArray,
    order: int,
    gradient: FloatArray,
    blocks: FloatArray,
) -> float:
    """Energy of all joints, N mm; their derivatives are added.

    Parameters
    ----------
    poses : (n_pairs, 24, jet) of `place_pairs`, of at least this order.
    arms : (n_pairs, 2, 3) from both anchors to a point of the pair's joints, mm.
    starts : (n_pairs + 1,) of each pair's stations; a pair may have none.
    gradient : (n_unknowns + 1,) the last by kappa.
    blocks : (n_pairs, 16, 16), with order 2.
    """
    size = poses.shape[2]
    work, relative = np.empty((N_WORK, size)), np.empty((6, size))
    slope, bend = np.empty(6), np.empty((6, 6))
    number = np.empty(_N, dtype=np.int64)
    energy = 0.0
    for k in range(len(scales)):
        s0, s1 = starts[k], starts[k + 1]
        if s0 == s1:
            continue
        relative_pose(poses[k], arms[k, 0], arms[k, 1], work, relative, _N, order)
        energy += joint_energy(
            relative[:, 0].copy(), points[s0:s1], normals[s0:s1], weights[s0:s1], exponents,
            coefficients, thickness, modulus, bounds, slope, bend,
        )  # fmt: skip
        if order == 0:
            continue
        unknowns_of(scales[k, 0], scales[k, 1], len(gradient) - 1, number)
        for i in range(_N):
            for c in range(6):
                gradient[number[i]] += slope[c] * relative[c, 1 + i]
        if order == 1:
            continue
        block = blocks[k]
        for c in range(6):
            add_hessian(block, slope[c], relative[c], _N)
        for c in range(6):
            for i in range(_N):
                carried = 0.0
                for d in range(6):
                    carried += bend[c, d] * relative[d, 1 + i]
                for j in range(_N):
                    block[i, j] += carried * relative[c, 1 + j]
    return energy


@njit(cache=True, error_model="numpy")
def pull_forces(
    poses: FloatArray,
    scales: IntArray,
    pair: IntArray,
    second: BoolArray,
    rest: FloatArray,
    forces: FloatArray,
    order: int,
    gradient: FloatArray,
    blocks: FloatArray,
) -> None:
    """Derivatives of forces (n_rows, 3) times positions, added to gradient and blocks as above."""
    total = np.zeros((len(scales), 24))
    for r in range(len(pair)):
        start = 12 if second[r] else 0
        for c in range(3):
            total[pair[r], start + c] += forces[r, c]
            for j in range(3):
                total[pair[r], start + 3 + 3 * c + j] += forces[r, c] * rest[r, j]
    number = np.empty(_N, dtype=np.int64)
    for k in range(len(scales)):
        unknowns_of(scales[k, 0], scales[k, 1], len(gradient) - 1, number)
        for m in range(24):
            load = total[k, m]
            if load == 0.0:
                continue
            for i in range(_N):
                gradient[number[i]] += load * poses[k, m, 1 + i]
            if order > 1:
                add_hessian(blocks[k], load, poses[k, m], _N)


@njit(cache=True, error_model="numpy")
def row_rates(
    poses: FloatArray, pair: int, second: bool, rest: FloatArray, out: FloatArray
) -> None:
    """(3, 16) derivatives of a row's position by the pair's variables."""
    start = 12 if second else 0
    for c in range(3):
        for i in range(_N):
            out[c, i] = poses[pair, start + c, 1 + i]
            for j in range(3):
                out[c, i] += poses[pair, start + 3 + 3 * c + j, 1 + i] * rest[j]


@njit(cache=True, error_model="numpy")
def pull_stencils(
    poses: FloatArray,
    pair: IntArray,
    second: BoolArray,
    rest: FloatArray,
    stencils: IntArray,
    hessians: FloatArray,
    blocks: FloatArray,
) -> None:
    """Add Hessians (n, 12, 12) by the positions of stencils (n, 4) of rows to the pairs' blocks."""
    rates, carried = np.empty((12, _N)), np.empty((12, _N))
    for m in range(len(stencils)):
        k = pair[stencils[m, 0]]
        for v in range(4):
            r = stencils[m, v]
            row_rates(poses, k, second[r], rest[r], rates[3 * v : 3 * v + 3])
        for v in range(12):
            for i in range(_N):
                carried[v, i] = 0.0
                for c in range(12):
                    carried[v, i] += hessians[m, v, c] * rates[c, i]
        for v in range(12):
            for i in range(_N):
                for j in range(_N):
                    blocks[k, i, j] += rates[v, i] * carried[v, j]


@njit(cache=True, error_model="numpy")
def add_blocks(blocks: FloatArray, slots: IntArray, values: FloatArray) -> None:
    """Add the pairs' blocks to the values of the upper triangle; slots of -1 are left out."""
    for k in range(len(blocks)):
        for i in range(_N):
            for j in range(_N):
                slot = slots[k, i, j]
                if slot >= 0:
                    values[slot] += blocks[k, i, j]


@njit(cache=True, error_model="numpy")
def gather_column(blocks: FloatArray, scales: IntArray, column: int, out: FloatArray) -> None:
    """out (n_unknowns + 1,) += one column of all blocks."""
    number = np.empty(_N, dtype=np.int64)
    for k in range(len(blocks)):
        unknowns_of(scales[k, 0], scales[k, 1], len(out) - 1, number)
        for i in range(_N):
            out[number[i]] += blocks[k, i, column]

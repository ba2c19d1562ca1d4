"""Energies of pairs of rigid scales: their joints and their contact, with derivatives.

Unknowns z: six of each scale (w, c of `rigid_motion`), then S. Both energies of a pair depend on
how one scale lies against the other: six derivatives, and as many second ones by two, which are
carried over to the pair's 16 variables, curvature included, and from there to the unknowns.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.middle_pose import (
    N_POSE,
    middle_pose,
    place_jets,
    turn_jets,
)
from flexscale.embedding.middle_pose import N_WORK as N_MIDDLE
from flexscale.embedding.rigid_motion import (
    N_MOTION,
    N_VARIABLES,
    OF_B,
    OF_S,
    add_pose_bends,
    neighbor_motion,
    pose_slopes,
    relative_pose,
    rotation_of,
)
from flexscale.mechanics.jets import add_hessian, jet_length
from flexscale.mechanics.joint_law import LawTable, law_at
from flexscale.mechanics.prism_kernels import N_WORK as N_BARRIER
from flexscale.mechanics.prism_kernels import Candidates, Memory, barrier_jet, moved_since

_N = N_VARIABLES
SLOTS = _N * (_N + 1) // 2  # of the upper triangle of a pair's block
KEEP, LIFT_CONTACT, LIFT_ALL = 0, 1, 2  # Hessians as they are, or parts by their positive parts


class Pairs(NamedTuple):
    """Pairs of neighboring scales.

    scales : (n, 2) numbers; ways : (n, 2) from the first one's anchor to the second's, mm;
    lifts : (n, 2) heights of both anchors by kappa; n_motion : 4, or 0 where S and kappa are held;
    n_unknowns : length of z.
    """

    scales: IntArray
    ways: FloatArray
    lifts: FloatArray
    n_motion: int
    n_unknowns: int


class Stations(NamedTuple):
    """Stations of all joints; those of a pair stand together.

    arms : (n_pairs, 2, 3) from both anchors to a point of the pair's joints, mm; starts :
    (n_pairs + 1,). points : (n, 2) from there, mm; normals : (n, 2); weights : (n,) mm.
    """

    arms: FloatArray
    starts: IntArray
    points: FloatArray
    normals: FloatArray
    weights: FloatArray


class Bending(NamedTuple):
    """How the sheet is bent: kappa, mm-1, the tensor K (2, 2) of its line, and where scales are."""

    z: FloatArray
    curvature: float
    tensor: FloatArray


@njit(cache=True, error_model="numpy")
def unknown_of(pairs: Pairs, k: int, variable: int) -> int:
    """Number among the unknowns of a pair's variable; kappa is one past them."""
    if variable < OF_S:
        side = 0 if variable < OF_B else 1
        return 6 * pairs.scales[k, side] + variable - OF_B * side
    return pairs.n_unknowns - 3 + variable - OF_S


class _Posing(NamedTuple):
    """A pair's motion and turns with derivatives, its pose (4, 3), t and G, and J; see
    `rigid_motion`; the others are to work in."""

    jets: FloatArray
    motion: FloatArray
    turns: FloatArray
    slopes: FloatArray
    bends: FloatArray
    pose: FloatArray
    matrices: FloatArray
    jacobian: FloatArray


@njit(cache=True, error_model="numpy")
def _new_posing(order: int) -> _Posing:
    size = jet_length(N_MOTION, order)
    return _Posing(
        np.empty((10, size)), np.empty((12, size)), np.empty((2, 3, 3)),
        np.empty((2, 3, 3, 3)), np.empty((2, 3, 3, 3, 3)), np.empty((4, 3)), np.empty((12, 3, 3)),
        np.empty((6, _N)),
    )  # fmt: skip


@njit(cache=True, error_model="numpy")
def _set_pose(bending: Bending, pairs: Pairs, k: int, order: int, posing: _Posing) -> None:
    """Pose of pair k with what its derivatives follow from, and J with order 1 or 2."""
    z, p = bending.z, posing
    for side in range(2):
        first = 6 * pairs.scales[k, side]
        rotation_of(z[first + 3 : first + 6], p.turns[side], p.slopes[side], p.bends[side], order)
    neighbor_motion(
        pairs.ways[k], pairs.lifts[k], bending.tensor, z[len(z) - 3 :], bending.curvature, p.jets,
        p.motion, order if pairs.n_motion > 0 else 0,
    )  # fmt: skip
    a, b = 6 * pairs.scales[k, 0], 6 * pairs.scales[k, 1]
    other = z[b : b + 3]
    relative_pose(z[a : a + 3], other, p.motion, p.turns, p.pose, p.matrices)
    if order > 0:
        pose_slopes(
            other, p.motion, p.turns, p.slopes, p.pose, pairs.n_motion, p.matrices, p.jacobian
        )


@njit(cache=True, error_model="numpy")
def place_pairs(bending: Bending, pairs: Pairs, poses: FloatArray) -> None:
    """How the second scale of each pair lies against the first: t and G, (n_pairs, 4, 3)."""
    posing = _new_posing(0)
    for k in range(len(pairs.scales)):
        _set_pose(bending, pairs, k, 0, posing)
        poses[k] = posing.pose


@njit(cache=True, error_model="numpy")
def place_scales(
    bending: Bending, numbers: IntArray, places: FloatArray, lifts: FloatArray
) -> FloatArray:
    """(n, 4, 3) where scales lie, place of the anchor and turn, in the frame at the plane's origin.

    numbers : (n,) of scales; places : (n, 2) of their anchors at rest, or those of images, mm;
    lifts : (n,) heights of anchors by kappa.
    """
    out, posing = np.empty((len(numbers), 4, 3)), _new_posing(0)
    still, lift, z = np.zeros(3), np.zeros(2), bending.z
    posing.turns[0] = np.eye(3)
    for k in range(len(numbers)):
        first, p = 6 * numbers[k], posing
        lift[1] = lifts[k]
        rotation_of(z[first + 3 : first + 6], p.turns[1], p.slopes[1], p.bends[1], 0)
        neighbor_motion(
            places[k], lift, bending.tensor, z[len(z) - 3 :], bending.curvature, p.jets, p.motion, 0
        )
        relative_pose(still, z[first : first + 3], p.motion, p.turns, out[k], p.matrices)
    return out


@njit(cache=True, error_model="numpy")
def place_rows(poses: FloatArray, table: Candidates, y: FloatArray) -> None:
    """Positions (n_rows, 3) of corners in the frames of the pairs' first scales, mm."""
    for k in range(len(table.row_starts) - 1):
        for r in range(table.row_starts[k], table.row_starts[k + 1]):
            for c in range(3):
                if table.second[r]:
                    y[r, c] = poses[k, 0, c]
                    for j in range(3):
                        y[r, c] += poses[k, 1 + c, j] * table.rest[r, j]
                else:
                    y[r, c] = table.rest[r, c]


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
def all_openings(poses: FloatArray, stations: Stations) -> FloatArray:
    """(n_stations, 4) u, w, s [mm] and phi [radian] of all stations."""
    out, rows = np.empty((len(stations.points), 4)), np.zeros((4, 6))
    turn, work, relative = np.empty((9, 1)), np.empty((N_MIDDLE, 1)), np.empty((6, 1))
    for k in range(len(poses)):
        turn_jets(poses[k], turn, 0)
        middle_pose(poses[k], turn, stations.arms[k, 0], stations.arms[k, 1], work, relative, 0)
        for s in range(stations.starts[k], stations.starts[k + 1]):
            station_opening(
                relative[:, 0].copy(), stations.points[s], stations.normals[s], out[s], rows
            )
    return out


@njit(cache=True, error_model="numpy")
def joint_energy(
    relative: FloatArray,
    stations: Stations,
    k: int,
    law: LawTable,
    order: int,
    gradient: FloatArray,
    hessian: FloatArray,
) -> float:
    """Energy of the joints of pair k, N mm, with its derivatives by the relative pose.

    relative : (6,) arrow and turn of `middle_pose`. gradient (6,) and, with order 2, hessian (6, 6)
    are filled.
    """
    gradient[:] = 0.0
    hessian[:] = 0.0
    energy = 0.0
    q, slope, bend, rows = np.empty(4), np.empty(4), np.empty((4, 4)), np.zeros((4, 6))
    carried = np.empty((4, 6))
    for s in range(stations.starts[k], stations.starts[k + 1]):
        weight = stations.weights[s]
        half = station_opening(relative, stations.points[s], stations.normals[s], q, rows)
        root = 1.0 / np.sqrt(1.0 - half * half)
        energy += weight * law_at(law, q, slope, bend, order)
        for i in range(6):
            for a in range(4):
                gradient[i] += weight * slope[a] * rows[a, i]
        if order < 2:
            continue
        for i in range(6):
            for a in range(4):
                carried[a, i] = 0.0
                for b in range(4):
                    carried[a, i] += weight * bend[a, b] * rows[b, i]
        # phi is the one that is not linear: d2 phi = -half / 2 root^3 of both factors of half's.
        curl = -0.5 * half * root * slope[3] * weight
        for i in range(6):
            for j in range(i, 6):
                total = curl * rows[3, i] * rows[3, j]
                for a in range(4):
                    total += rows[a, i] * carried[a, j]
                hessian[i, j] += total
    for i in range(6):
        for j in range(i):
            hessian[i, j] = hessian[j, i]
    return energy


@njit(cache=True, error_model="numpy")
def _add_joint(
    relative: FloatArray,
    slope: FloatArray,
    bend: FloatArray,
    order: int,
    gradient: FloatArray,
    hessian: FloatArray,
) -> None:
    """Carry derivatives by the middle pose over to tau and alpha."""
    n = N_POSE
    if order == 0:
        return
    for i in range(n):
        for c in range(6):
            gradient[i] += slope[c] * relative[c, 1 + i]
    if order == 1:
        return
    for c in range(6):
        add_hessian(hessian, slope[c], relative[c], n)
        for i in range(n):
            carried = 0.0
            for d in range(6):
                carried += bend[c, d] * relative[d, 1 + i]
            for j in range(n):
                hessian[i, j] += carried * relative[c, 1 + j]


@njit(cache=True, error_model="numpy")
def _add_contact(
    pose: FloatArray,
    turn: FloatArray,
    table: Candidates,
    memory: Memory,
    k: int,
    d_hat: float,
    way: float,
    stiffness: float,
    order: int,
    rows: FloatArray,
    work: FloatArray,
    out: FloatArray,
    gradient: FloatArray,
    hessian: FloatArray,
) -> float:
    """Energy of the contact of pair k, and its derivatives by tau and alpha, added."""
    energy, n = 0.0, N_POSE
    for s in range(table.starts[k], table.starts[k + 1]):
        if memory.distances[s] - way >= d_hat:
            continue
        for i in range(4):
            r = table.stencils[s, i]
            if table.second[r]:
                place_jets(pose, turn, table.rest[r], rows[i])
            else:
                for c in range(3):
                    rows[i, c, :] = 0.0
                    rows[i, c, 0] = table.rest[r, c]
        if not barrier_jet(table.is_wall[s], rows, d_hat * d_hat, work, out, n, order):
            continue
        energy += stiffness * out[0]
        if order == 0:
            continue
        for i in range(n):
            gradient[i] += stiffness * out[1 + i]
        if order > 1:
            add_hessian(hessian, stiffness, out, n)
    return energy


@njit(cache=True, error_model="numpy")
def _positive_part(matrix: FloatArray) -> None:
    values, modes = np.linalg.eigh(matrix)
    n = len(values)
    matrix[:] = 0.0
    for k in range(n):
        if values[k] > 0.0:
            for i in range(n):
                for j in range(n):
                    matrix[i, j] += values[k] * modes[i, k] * modes[j, k]


@njit(cache=True, error_model="numpy")
def assemble(
    bending: Bending,
    pairs: Pairs,
    stations: Stations,
    law: LawTable,
    y: FloatArray,
    table: Candidates,
    memory: Memory,
    d_hat: float,
    most: float,
    stiffness: float,
    lift: int,
    gradient: FloatArray,
    slots: IntArray,
    values: FloatArray,
    direction: FloatArray,
    rate: FloatArray,
    split: FloatArray,
) -> tuple[float, float]:
    """Energies of all joints and of all contact, N mm, and their derivatives, added.

    Parameters
    ----------
    y : (n_rows, 3) of `place_rows`; table, memory, d_hat, most : see `prism_kernels`.
    stiffness : of the barrier, N mm-3; 0 without contact, when tables are not looked at.
    lift : `KEEP`, or what is replaced by its positive part.
    gradient : (n_unknowns + 1,) the last by kappa; (0,) if nobody asks for derivatives.
    slots : (n_pairs, SLOTS) place in `values` of the upper triangle of a pair's block, row by row;
        -1 for none. With none at all, (0, SLOTS), second derivatives are not computed.
    values : (nnz,) upper triangle of the Hessian of those unknowns that are sought.
    direction, rate : (n_unknowns + 1,), of which the second is the full Hessian times the first.
    split : (n_pairs, 2) filled with both energies of each pair; (0, 2) if nobody asks.
    """
    order = 2 if len(slots) else (1 if len(gradient) else 0)
    posing, block = _new_posing(order), np.empty((_N, _N))
    pose, jacobian = posing.pose, posing.jacobian
    size = jet_length(N_POSE, order)
    turn, middle = np.empty((9, size)), np.empty((N_MIDDLE, size))
    relative, barrier_work = np.empty((6, size)), np.empty((N_BARRIER, size))
    rows, out = np.empty((4, 3, size)), np.empty(size)
    slope, bend = np.empty(6), np.empty((6, 6))
    total, hessian, touch = np.empty(6), np.empty((6, 6)), np.empty((6, 6))
    joints = contact = 0.0
    for k in range(len(pairs.scales)):
        jointed = stations.starts[k + 1] > stations.starts[k]
        near, way = False, 0.0
        if stiffness > 0.0:
            way = moved_since(y, table, k, memory, most)
            near = memory.least[k] - way < d_hat
        if not jointed and not near:
            continue
        _set_pose(bending, pairs, k, order, posing)
        turn_jets(pose, turn, order)
        total[:] = 0.0
        hessian[:] = 0.0
        energy = touching = 0.0
        if near:
            touching = _add_contact(
                pose, turn, table, memory, k, d_hat, way, stiffness, order, rows, barrier_work, out,
                total, hessian,
            )  # fmt: skip
            if order > 1 and lift != KEEP and total.any():
                touch[:] = hessian
                _positive_part(touch)
                hessian[:] = touch
        if jointed:
            middle_pose(
                pose, turn, stations.arms[k, 0], stations.arms[k, 1], middle, relative, order
            )
            energy = joint_energy(relative[:, 0].copy(), stations, k, law, order, slope, bend)
            _add_joint(relative, slope, bend, order, total, hessian)
        joints += energy
        contact += touching
        if len(split):
            split[k, 0], split[k, 1] = energy, touching
        if order == 0 or (not jointed and not total.any()):
            continue
        last = OF_S + pairs.n_motion
        for i in range(last):
            sum_ = 0.0
            for c in range(6):
                sum_ += total[c] * jacobian[c, i]
            gradient[unknown_of(pairs, k, i)] += sum_
        if order == 1:
            continue
        block[:] = 0.0
        for i in range(last):
            for c in range(6):
                carried = 0.0
                for d in range(6):
                    carried += hessian[c, d] * jacobian[d, i]
                for j in range(i, last):
                    block[i, j] += carried * jacobian[c, j]
        second = 6 * pairs.scales[k, 1]
        add_pose_bends(
            total, bending.z[second : second + 3], posing.motion, posing.turns, posing.slopes,
            posing.bends, pose, pairs.n_motion, posing.matrices, block,
        )  # fmt: skip
        if lift == LIFT_ALL:
            for i in range(last):
                for j in range(i):
                    block[i, j] = block[j, i]
            part = block[: _N - 1, : _N - 1].copy()
            _positive_part(part)
            block[: _N - 1, : _N - 1] = part
        _scatter(block, pairs, k, last, slots[k], values, direction, rate)
    return joints, contact


@njit(cache=True, error_model="numpy")
def _scatter(
    block: FloatArray,
    pairs: Pairs,
    k: int,
    last: int,
    slots: IntArray,
    values: FloatArray,
    direction: FloatArray,
    rate: FloatArray,
) -> None:
    """Add the upper triangle of a pair's block to the Hessian, and to its product."""
    number = np.empty(_N, dtype=np.int64)
    for i in range(last):
        number[i] = unknown_of(pairs, k, i)
    for i in range(last):
        row = i * _N - (i * (i - 1)) // 2 - i  # of slots, less i
        a = number[i]
        for j in range(i, last):
            b, value = number[j], block[i, j]
            rate[a] += value * direction[b]
            if i != j:
                rate[b] += value * direction[a]
                if a == b:  # a scale and its own image
                    value *= 2.0
            slot = slots[row + j]
            if slot >= 0:
                values[slot] += value


@njit(cache=True, error_model="numpy")
def pull_forces(
    bending: Bending,
    pairs: Pairs,
    poses: FloatArray,
    table: Candidates,
    forces: FloatArray,
    out: FloatArray,
) -> None:
    """out (n_unknowns + 1,) += derivative of forces (n_rows, 3) times positions of rows."""
    posing, total, turned = _new_posing(1), np.empty(6), np.empty(3)
    for k in range(len(pairs.scales)):
        total[:] = 0.0
        for r in range(table.row_starts[k], table.row_starts[k + 1]):
            if not table.second[r]:
                continue
            for c in range(3):
                total[c] += forces[r, c]
                turned[c] = 0.0  # G^T f
                for j in range(3):
                    turned[c] += poses[k, 1 + j, c] * forces[r, j]
            for i in range(3):
                m, n = (i + 1) % 3, (i + 2) % 3
                total[3 + i] += table.rest[r, m] * turned[n] - table.rest[r, n] * turned[m]
        if not total.any():
            continue
        _set_pose(bending, pairs, k, 1, posing)
        for i in range(OF_S + pairs.n_motion):
            for c in range(6):
                out[unknown_of(pairs, k, i)] += total[c] * posing.jacobian[c, i]


@njit(cache=True, error_model="numpy")
def row_rates(
    bending: Bending,
    pairs: Pairs,
    poses: FloatArray,
    table: Candidates,
    direction: FloatArray,
    out: FloatArray,
) -> None:
    """Fill out (n_rows, 3) with the change of positions for one of the unknowns and kappa."""
    posing, moved, spun = _new_posing(1), np.empty(6), np.empty(3)
    for k in range(len(pairs.scales)):
        _set_pose(bending, pairs, k, 1, posing)
        moved[:] = 0.0
        for i in range(OF_S + pairs.n_motion):
            for c in range(6):
                moved[c] += posing.jacobian[c, i] * direction[unknown_of(pairs, k, i)]
        for r in range(table.row_starts[k], table.row_starts[k + 1]):
            out[r] = 0.0
            if not table.second[r]:
                continue
            for i in range(3):
                m, n = (i + 1) % 3, (i + 2) % 3
                spun[i] = moved[3 + m] * table.rest[r, n] - moved[3 + n] * table.rest[r, m]
            for c in range(3):
                out[r, c] = moved[c]
                for j in range(3):
                    out[r, c] += poses[k, 1 + c, j] * spun[j]


@njit(cache=True, error_model="numpy")
def gap_slopes(
    bending: Bending,
    pairs: Pairs,
    poses: FloatArray,
    table: Candidates,
    found: IntArray,
    shares: FloatArray,
    normals: FloatArray,
) -> FloatArray:
    """(n, 16) derivatives of distances by their pairs' variables.

    found : (n,) candidates; shares : (n, 4) of their rows in the arrow; normals : (n, 3) along
    which it is measured.
    """
    out, posing, last = np.zeros((len(found), _N)), _new_posing(1), -1
    total, turned, row_starts = np.empty(6), np.empty(3), table.row_starts
    for m in range(len(found)):
        first = table.stencils[found[m], 0]
        if last < 0 or not row_starts[last] <= first < row_starts[last + 1]:
            last = np.searchsorted(row_starts, first, side="right") - 1
            _set_pose(bending, pairs, last, 1, posing)
        total[:] = 0.0
        for j in range(3):
            turned[j] = 0.0
            for c in range(3):
                turned[j] += poses[last, 1 + c, j] * normals[m, c]
        for v in range(4):
            r = table.stencils[found[m], v]
            if not table.second[r]:
                continue
            for c in range(3):
                total[c] += shares[m, v] * normals[m, c]
            for i in range(3):
                j, k = (i + 1) % 3, (i + 2) % 3
                arm = table.rest[r, j] * turned[k] - table.rest[r, k] * turned[j]
                total[3 + i] += shares[m, v] * arm
        for i in range(OF_S + pairs.n_motion):
            for c in range(6):
                out[m, i] += total[c] * posing.jacobian[c, i]
    return out


@njit(cache=True, error_model="numpy")
def add_springs(
    slopes: FloatArray,
    of_pair: IntArray,
    pairs: Pairs,
    stiffness: FloatArray,
    force: FloatArray,
    slots: IntArray,
    values: FloatArray,
    gradient: FloatArray,
) -> None:
    """Add springs in gaps to the Hessian's values, and their forces to the gradient.

    slopes : (n, 16) of `gap_slopes`; of_pair : (n,); stiffness : (n,) N/mm; force : (n,) N, that
    pushes a gap open; gradient : (n_unknowns + 1,).
    """
    block, unused = np.zeros((_N, _N)), np.zeros(len(gradient))
    last = OF_S + pairs.n_motion
    for m in range(len(slopes)):
        k = of_pair[m]
        for i in range(last):
            gradient[unknown_of(pairs, k, i)] -= force[m] * slopes[m, i]
            for j in range(i, last):
                block[i, j] = stiffness[m] * slopes[m, i] * slopes[m, j]
        _scatter(block, pairs, k, last, slots[k], values, unused, unused)

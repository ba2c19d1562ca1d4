"""Energies of pairs of rigid scales: their joints and their contact, with derivatives.

Both energies of a pair depend on how one scale lies against the other: six derivatives, and as many
second ones by two, which are carried over to the pair's 16 variables, curvature included, and from
there to the unknowns of `pair_places`.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.joint_kernels import Stations, joint_energy
from flexscale.embedding.middle_pose import N_POSE, middle_pose, place_jets, turn_jets
from flexscale.embedding.middle_pose import N_WORK as N_MIDDLE
from flexscale.embedding.pair_places import Bending, Pairs, new_posing, set_pose, unknown_of
from flexscale.embedding.relative_pose import add_pose_bends
from flexscale.embedding.rigid_motion import N_VARIABLES, OF_S
from flexscale.mechanics.jets import add_hessian, jet_length
from flexscale.mechanics.prism_candidates import Candidates, Memory, moved_since
from flexscale.mechanics.prism_kernels import N_WORK as N_BARRIER
from flexscale.mechanics.prism_kernels import barrier_jet
from flexscale.mechanics.stacked_laws import LawTables

_N = N_VARIABLES
SLOTS = _N * (_N + 1) // 2  # of the upper triangle of a pair's block
KEEP, LIFT_CONTACT, LIFT_ALL = 0, 1, 2  # Hessians as they are, or parts by their positive parts


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
    laws: LawTables,
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
    y : (n_rows, 3) of `place_rows`; table, memory, d_hat, most : see `prism_candidates`.
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
    posing, block = new_posing(order), np.empty((_N, _N))
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
        set_pose(bending, pairs, k, order, posing)
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
            energy = joint_energy(relative[:, 0].copy(), stations, k, laws, order, slope, bend)
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

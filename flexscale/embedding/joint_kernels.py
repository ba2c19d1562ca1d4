"""Energies of the joints of pairs of scales, at stations along them, by the pose midway."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.middle_pose import N_WORK as N_MIDDLE
from flexscale.embedding.middle_pose import middle_pose, turn_jets
from flexscale.mechanics.joint_law import MOST_POWER, law_at
from flexscale.mechanics.stacked_laws import LawTables, one_law

# Which of u, w, s and phi each part of the relative pose moves.
_MOVED = ((0, 2), (0, 2), (1, 3), (1, 3), (1, 3), (0, 2))


class Stations(NamedTuple):
    """Stations of all joints; those of a pair stand together.

    arms : (n_pairs, 2, 3) from both anchors to a point of the pair's joints, mm; starts :
    (n_pairs + 1,). points : (n, 2) from there, mm; normals : (n, 2); weights : (n,) mm; laws : (n,)
    number of the law.
    """

    arms: FloatArray
    starts: IntArray
    points: FloatArray
    normals: FloatArray
    weights: FloatArray
    laws: IntArray


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
    laws: LawTables,
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
    carried, powers = np.empty((4, 6)), np.empty((4, 3, MOST_POWER + 1))
    number = 0
    law = one_law(laws, number)
    for s in range(stations.starts[k], stations.starts[k + 1]):
        weight = stations.weights[s]
        half = station_opening(relative, stations.points[s], stations.normals[s], q, rows)
        root = 1.0 / np.sqrt(1.0 - half * half)
        if stations.laws[s] != number:
            number = stations.laws[s]
            law = one_law(laws, number)
        energy += weight * law_at(law, q, powers, slope, bend, order)
        for i in range(6):
            one, two = _MOVED[i]
            gradient[i] += weight * (slope[one] * rows[one, i] + slope[two] * rows[two, i])
        if order < 2:
            continue
        for i in range(6):
            one, two = _MOVED[i]
            for a in range(4):
                carried[a, i] = weight * (bend[a, one] * rows[one, i] + bend[a, two] * rows[two, i])
        # phi is the one that is not linear: d2 phi = -half / 2 root^3 of both factors of half's.
        curl = -0.5 * half * root * slope[3] * weight
        for i in range(6):
            one, two = _MOVED[i]
            for j in range(i, 6):
                hessian[i, j] += rows[one, i] * carried[one, j] + rows[two, i] * carried[two, j]
        for i in range(3, 5):
            for j in range(i, 5):
                hessian[i, j] += curl * rows[3, i] * rows[3, j]
    for i in range(6):
        for j in range(i):
            hessian[i, j] = hessian[j, i]
    return energy

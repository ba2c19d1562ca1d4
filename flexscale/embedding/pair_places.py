"""Pairs of rigid scales: their tables, their variables, and how one lies against the other.

Unknowns z: six of each scale (w, c of `rigid_motion`), then S.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.relative_pose import pose_slopes, relative_pose
from flexscale.embedding.rigid_motion import (
    N_MOTION,
    N_VARIABLES,
    OF_B,
    OF_S,
    neighbor_motion,
    rotation_of,
)
from flexscale.mechanics.jets import jet_length
from flexscale.mechanics.prism_candidates import Candidates

_N = N_VARIABLES


class Pairs(NamedTuple):
    """Pairs of neighboring scales.

    scales : (n, 2) numbers; ways : (n, 2) from the first one's anchor to the second's, mm;
    lifts : (n, 2, 2) heights of both anchors, mm, at k_0 and by kappa; n_motion : 4, or 0 where S
    and kappa are held; n_unknowns : length of z.
    """

    scales: IntArray
    ways: FloatArray
    lifts: FloatArray
    n_motion: int
    n_unknowns: int


class Bending(NamedTuple):
    """How the sheet is bent, k = k_0 + kappa K, all mm-1 and (2, 2), and where scales are."""

    z: FloatArray
    curvature: float
    tensor: FloatArray
    base: FloatArray


@njit(cache=True, error_model="numpy")
def unknown_of(pairs: Pairs, k: int, variable: int) -> int:
    """Number among the unknowns of a pair's variable; kappa is one past them."""
    if variable < OF_S:
        side = 0 if variable < OF_B else 1
        return 6 * pairs.scales[k, side] + variable - OF_B * side
    return pairs.n_unknowns - 3 + variable - OF_S


class Posing(NamedTuple):
    """A pair's motion and turns with derivatives, its pose (4, 3), t and G, and J; see
    `relative_pose`; the others are to work in."""

    jets: FloatArray
    motion: FloatArray
    turns: FloatArray
    slopes: FloatArray
    bends: FloatArray
    pose: FloatArray
    matrices: FloatArray
    jacobian: FloatArray


@njit(cache=True, error_model="numpy")
def new_posing(order: int) -> Posing:
    size = jet_length(N_MOTION, order)
    return Posing(
        np.empty((10, size)), np.empty((12, size)), np.empty((2, 3, 3)),
        np.empty((2, 3, 3, 3)), np.empty((2, 3, 3, 3, 3)), np.empty((4, 3)), np.empty((12, 3, 3)),
        np.empty((6, _N)),
    )  # fmt: skip


@njit(cache=True, error_model="numpy")
def set_pose(bending: Bending, pairs: Pairs, k: int, order: int, posing: Posing) -> None:
    """Pose of pair k with what its derivatives follow from, and J with order 1 or 2."""
    z, p = bending.z, posing
    for side in range(2):
        first = 6 * pairs.scales[k, side]
        rotation_of(z[first + 3 : first + 6], p.turns[side], p.slopes[side], p.bends[side], order)
    neighbor_motion(
        pairs.ways[k], pairs.lifts[k], bending.base, bending.tensor, z[len(z) - 3 :],
        bending.curvature, p.jets, p.motion, order if pairs.n_motion > 0 else 0,
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
    posing = new_posing(0)
    for k in range(len(pairs.scales)):
        set_pose(bending, pairs, k, 0, posing)
        poses[k] = posing.pose


@njit(cache=True, error_model="numpy")
def place_scales(
    bending: Bending, numbers: IntArray, places: FloatArray, lifts: FloatArray
) -> FloatArray:
    """(n, 4, 3) where scales lie, place of the anchor and turn, in the frame at the plane's origin.

    numbers : (n,) of scales; places : (n, 2) of their anchors at rest, or those of images, mm;
    lifts : (n, 2) heights of anchors, at k_0 and by kappa.
    """
    out, posing = np.empty((len(numbers), 4, 3)), new_posing(0)
    still, lift, z = np.zeros(3), np.zeros((2, 2)), bending.z
    posing.turns[0] = np.eye(3)
    for k in range(len(numbers)):
        first, p = 6 * numbers[k], posing
        lift[1] = lifts[k]
        rotation_of(z[first + 3 : first + 6], p.turns[1], p.slopes[1], p.bends[1], 0)
        neighbor_motion(
            places[k], lift, bending.base, bending.tensor, z[len(z) - 3 :], bending.curvature,
            p.jets, p.motion, 0,
        )  # fmt: skip
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

"""How positions of corners and distances between scales follow the unknowns, and forces back."""

from __future__ import annotations

import numpy as np
from numba import njit

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.pair_places import Bending, Pairs, new_posing, set_pose, unknown_of
from flexscale.embedding.rigid_motion import N_VARIABLES, OF_S
from flexscale.mechanics.prism_candidates import Candidates

_N = N_VARIABLES


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
    posing, total, turned = new_posing(1), np.empty(6), np.empty(3)
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
        set_pose(bending, pairs, k, 1, posing)
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
    posing, moved, spun = new_posing(1), np.empty(6), np.empty(3)
    for k in range(len(pairs.scales)):
        set_pose(bending, pairs, k, 1, posing)
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
    out, posing, last = np.zeros((len(found), _N)), new_posing(1), -1
    total, turned, row_starts = np.empty(6), np.empty(3), table.row_starts
    for m in range(len(found)):
        first = table.stencils[found[m], 0]
        if last < 0 or not row_starts[last] <= first < row_starts[last + 1]:
            last = np.searchsorted(row_starts, first, side="right") - 1
            set_pose(bending, pairs, last, 1, posing)
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

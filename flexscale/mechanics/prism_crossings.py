"""Whether prisms are in one another: an edge of one passes through a wall of the other.

Barrier and collision detection keep scales apart on the way from one state of a bend to another.
Between bends there is no way, only a guess: where there is no room, as in a lattice that is held, a
state may be found to which scales have passed through one another.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from flexscale.arrays import FloatArray, IntArray
from flexscale.mechanics.prism_candidates import Candidates


@njit(cache=True, error_model="numpy")
def any_crossing(y: FloatArray, table: Candidates) -> bool:
    """Whether an edge passes through a wall, among the candidates of any pair.

    y : (n_rows, 3) positions, mm.
    """
    for k in range(len(table.starts) - 1):
        first, last = table.starts[k], table.starts[k + 1]
        for s in range(first, last):
            wall = table.stencils[s]
            if not table.is_wall[s] or not _on_both_sides(y, table, k, wall):
                continue
            for other in range(first, last):
                if table.is_wall[other]:
                    continue
                for side in range(2):
                    a, b = table.stencils[other, 2 * side], table.stencils[other, 2 * side + 1]
                    if table.second[a] != table.second[wall[1]] and passes_through(
                        y[a], y[b], y[wall[1]], y[wall[2]], y[wall[3]]
                    ):
                        return True
    return False


@njit(cache=True, error_model="numpy")
def _on_both_sides(y: FloatArray, table: Candidates, k: int, wall: IntArray) -> bool:
    """Whether pair k has corners of the other scale on both sides of the plane of a wall."""
    corner = y[wall[1]]
    normal = np.cross(y[wall[2]] - corner, y[wall[3]] - corner)
    before, behind = False, False
    for r in range(table.row_starts[k], table.row_starts[k + 1]):
        if table.second[r] != table.second[wall[1]]:
            height = np.dot(y[r] - corner, normal)
            before, behind = before or height > 0.0, behind or height < 0.0
    return before and behind


@njit(cache=True, error_model="numpy")
def passes_through(
    a: FloatArray, b: FloatArray, corner: FloatArray, along: FloatArray, above: FloatArray
) -> bool:
    """Whether the way from a to b passes through the rectangle with these three corners."""
    e, f = along - corner, above - corner
    normal = np.cross(e, f)
    start, end = np.dot(a - corner, normal), np.dot(b - corner, normal)
    if start * end >= 0.0:
        return False
    met = a + start / (start - end) * (b - a) - corner
    s, t = np.dot(met, e) / np.dot(e, e), np.dot(met, f) / np.dot(f, f)
    return bool(0.0 < s < 1.0 and 0.0 < t < 1.0)

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
    known, heights = np.zeros(len(y), dtype=np.bool_), np.empty(len(y))
    for k in range(len(table.starts) - 1):
        first, last = table.starts[k], table.starts[k + 1]
        for s in range(first, last):
            wall = table.stencils[s]
            # A wall is a candidate with each corner that may meet it, and begins at one row.
            if not table.is_wall[s] or known[wall[1]]:
                continue
            known[wall[1]] = True
            if not _on_both_sides(y, table, k, wall, heights):
                continue
            for other in range(first, last):
                if table.is_wall[other]:
                    continue
                for side in range(2):
                    a, b = table.stencils[other, 2 * side], table.stencils[other, 2 * side + 1]
                    if heights[a] * heights[b] < 0.0 and passes_through(
                        y[a], y[b], y[wall[1]], y[wall[2]], y[wall[3]]
                    ):
                        return True
    return False


@njit(cache=True, error_model="numpy")
def _height(point: FloatArray, corner: FloatArray, along: FloatArray, above: FloatArray) -> float:
    """Above the plane of three corners, times twice their area; free of temporary arrays."""
    e0, e1, e2 = along[0] - corner[0], along[1] - corner[1], along[2] - corner[2]
    f0, f1, f2 = above[0] - corner[0], above[1] - corner[1], above[2] - corner[2]
    r0, r1, r2 = point[0] - corner[0], point[1] - corner[1], point[2] - corner[2]
    return r0 * (e1 * f2 - e2 * f1) + r1 * (e2 * f0 - e0 * f2) + r2 * (e0 * f1 - e1 * f0)


@njit(cache=True, error_model="numpy")
def _on_both_sides(
    y: FloatArray, table: Candidates, k: int, wall: IntArray, heights: FloatArray
) -> bool:
    """Whether pair k has corners of the other scale on both sides of the plane of a wall.

    heights : (n_rows,) filled with those of the pair's rows, 0 for those of the wall's own scale.
    """
    before, behind = False, False
    for r in range(table.row_starts[k], table.row_starts[k + 1]):
        heights[r] = 0.0
        if table.second[r] != table.second[wall[1]]:
            heights[r] = _height(y[r], y[wall[1]], y[wall[2]], y[wall[3]])
            before, behind = before or heights[r] > 0.0, behind or heights[r] < 0.0
    return before and behind


@njit(cache=True, error_model="numpy")
def passes_through(
    a: FloatArray, b: FloatArray, corner: FloatArray, along: FloatArray, above: FloatArray
) -> bool:
    """Whether the way from a to b passes through the rectangle with these three corners."""
    start, end = _height(a, corner, along, above), _height(b, corner, along, above)
    if start * end >= 0.0:
        return False
    share = start / (start - end)
    s, t, ee, ff = 0.0, 0.0, 0.0, 0.0
    for c in range(3):
        met = a[c] + share * (b[c] - a[c]) - corner[c]
        e, f = along[c] - corner[c], above[c] - corner[c]
        s, t, ee, ff = s + met * e, t + met * f, ee + e * e, ff + f * f
    return bool(0.0 < s < ee and 0.0 < t < ff)

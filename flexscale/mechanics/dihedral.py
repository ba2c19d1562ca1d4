"""The angle between two triangles that share an edge, with its derivatives.

The edge runs from p to q; a is the vertex on its left, b the one on its right. With t the unit
edge, l its length, and for each side x in {a, b} the height h of x over the edge, its foot p +
alpha l t, the unit vector m from the foot to x, and the unit normal n (n = t x m on the left, m x t
on the right), the angle theta by which b's triangle is turned up out of the plane of a's is

    theta = atan2(n_b . m_a, n_b . n_a).

A face turns by n . w / h about the edge, w = dx - (1 - alpha) dp - alpha dq, hence

    dtheta  = sum over both sides of  n . w / h
    d2theta = - sum of  2 (n . w)(m . w) / h^2 + 2 (t . w)(n . de) / (l h) + (n . de)(m . de) / l^2

with de = dq - dp. (From dn = -m (n . w) / h - t (n . de) / l and its like; on the last term the two
sides' antisymmetric parts cancel.)
"""

from __future__ import annotations

import numpy as np
from numba import njit

#: Rows of a frame (5, 3): t, then m and n of each side.
_TANGENT, _LEFT, _RIGHT = 0, 1, 3


@njit(cache=True)
def _side_frame(p, x, length, row, sign, frame):
    """Fill m and n of one side; returns its height and alpha."""
    t = frame[_TANGENT]
    along = 0.0
    for c in range(3):
        along += (x[c] - p[c]) * t[c]
    square = 0.0
    for c in range(3):
        frame[row, c] = x[c] - p[c] - along * t[c]
        square += frame[row, c] ** 2
    height = np.sqrt(square)
    if height > 0.0:
        for c in range(3):
            frame[row, c] /= height
    m, n = frame[row], frame[row + 1]
    n[0] = sign * (t[1] * m[2] - t[2] * m[1])
    n[1] = sign * (t[2] * m[0] - t[0] * m[2])
    n[2] = sign * (t[0] * m[1] - t[1] * m[0])
    return height, along / length


@njit(cache=True)
def edge_frame(p, q, a, b, frame, sizes):
    """Fill frame (5, 3) with t, m_a, n_a, m_b, n_b and sizes with l, h_a, alpha_a, h_b, alpha_b.

    Returns theta, or nan if a triangle has no area.
    """
    square = 0.0
    for c in range(3):
        frame[_TANGENT, c] = q[c] - p[c]
        square += frame[_TANGENT, c] ** 2
    sizes[0] = np.sqrt(square)
    if not sizes[0] > 0.0:
        return np.nan
    for c in range(3):
        frame[_TANGENT, c] /= sizes[0]
    sizes[1], sizes[2] = _side_frame(p, a, sizes[0], _LEFT, 1.0, frame)
    sizes[3], sizes[4] = _side_frame(p, b, sizes[0], _RIGHT, -1.0, frame)
    if not (sizes[1] > 0.0 and sizes[3] > 0.0):
        return np.nan
    sine, cosine = 0.0, 0.0
    for c in range(3):
        sine += frame[_RIGHT + 1, c] * frame[_LEFT, c]
        cosine += frame[_RIGHT + 1, c] * frame[_LEFT + 1, c]
    return np.arctan2(sine, cosine)


@njit(cache=True)
def add_angle_gradient(frame, sizes, factor, nodes, out):
    """Add factor dtheta to rows `nodes` = (p, q, a, b) of out."""
    for side in range(2):
        n = frame[_LEFT + 1 + 2 * side]
        height, alpha = sizes[1 + 2 * side], sizes[2 + 2 * side]
        for c in range(3):
            turn = factor * n[c] / height
            out[nodes[2 + side], c] += turn
            out[nodes[0], c] -= (1.0 - alpha) * turn
            out[nodes[1], c] -= alpha * turn


@njit(cache=True)
def add_angle_hessian(frame, sizes, factor, nodes, out):
    """Add factor d2theta to blocks of out (k, k, 3, 3) at `nodes` = (p, q, a, b)."""
    t, length = frame[_TANGENT], sizes[0]
    place, along = np.empty(3), (-1.0, 1.0, 0.0)
    for side in range(2):
        m, n = frame[_LEFT + 2 * side], frame[_LEFT + 1 + 2 * side]
        height, alpha = sizes[1 + 2 * side], sizes[2 + 2 * side]
        place[0], place[1], place[2] = alpha - 1.0, -alpha, 1.0
        for x in range(3):
            first = nodes[x] if x < 2 else nodes[2 + side]
            for y in range(3):
                second = nodes[y] if y < 2 else nodes[2 + side]
                bent = place[x] * place[y] / height**2 + 0.5 * along[x] * along[y] / length**2
                forward = place[x] * along[y] / (length * height)
                backward = along[x] * place[y] / (length * height)
                for r in range(3):
                    for c in range(3):
                        out[first, second, r, c] -= factor * (
                            bent * (n[r] * m[c] + m[r] * n[c])
                            + forward * t[r] * n[c]
                            + backward * n[r] * t[c]
                        )

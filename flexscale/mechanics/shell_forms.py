"""First and second form of a C1 sheet at a quadrature point, with derivatives in its five vectors.

At a quadrature point the five vectors x_u, x_v, x_uu, x_uv, x_vv give the first form a and, with
the unit normal n = x_u x x_v / J, the second form b = (n . x_uu, n . x_uv, n . x_vv). With the dual
basis a^u, a^v in the tangent plane, dn/dx_g = -a^g (x) n, so for each component of b = n . x_s

    db/dx_s         = n                       db/dx_g        = -G^g n,   G^g = a^g . x_s
    d2b/dx_s dx_g   = -a^g (x) n
    d2b/dx_g dx_h   = G^h n (x) a^g + G^g a^h (x) n - (a^g . a^h) b n (x) n

(row: component of the first vector, column: of the second).
"""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True)
def forms(y, vectors, derivatives, v, normal, dual, e, b):
    """Fill the five vectors, unit normal, dual basis, a - I and b at a point; returns J."""
    for a in range(5):
        for c in range(3):
            s = 0.0
            for i in range(12):
                s += derivatives[a, i] * y[vectors[i], c]
            v[a, c] = s
    e[0] = v[0, 0] ** 2 + v[0, 1] ** 2 + v[0, 2] ** 2 - 1.0
    e[1] = v[0, 0] * v[1, 0] + v[0, 1] * v[1, 1] + v[0, 2] * v[1, 2]
    e[2] = v[1, 0] ** 2 + v[1, 1] ** 2 + v[1, 2] ** 2 - 1.0
    normal[0] = v[0, 1] * v[1, 2] - v[0, 2] * v[1, 1]
    normal[1] = v[0, 2] * v[1, 0] - v[0, 0] * v[1, 2]
    normal[2] = v[0, 0] * v[1, 1] - v[0, 1] * v[1, 0]
    area = np.sqrt(normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2)
    if area <= 0.0:
        return area
    det = area * area
    for c in range(3):
        normal[c] /= area
        dual[0, c] = ((1.0 + e[2]) * v[0, c] - e[1] * v[1, c]) / det
        dual[1, c] = ((1.0 + e[0]) * v[1, c] - e[1] * v[0, c]) / det
    for k in range(3):
        b[k] = normal[0] * v[2 + k, 0] + normal[1] * v[2 + k, 1] + normal[2] * v[2 + k, 2]
    return area


@njit(cache=True)
def add_point_forces(n, w, p, vectors, out):
    """Add the forces of a point's p (5, 3) on the element's twelve vectors, times its weight."""
    for i in range(12):
        for c in range(3):
            s = 0.0
            for a in range(5):
                s += n[a, i] * p[a, c]
            out[vectors[i], c] += w * s


@njit(cache=True)
def vector_gradient(v, normal, dual, grad, p, christoffel):
    """Fill p (5, 3) = dpsi/d(vectors) and christoffel (3, 2), G^g for each component of b."""
    for c in range(3):
        p[0, c] = 2.0 * grad[0] * v[0, c] + grad[1] * v[1, c]
        p[1, c] = 2.0 * grad[2] * v[1, c] + grad[1] * v[0, c]
    for k in range(3):
        for g in range(2):
            gamma = 0.0
            for c in range(3):
                gamma += dual[g, c] * v[2 + k, c]
            christoffel[k, g] = gamma
            for c in range(3):
                p[g, c] -= grad[3 + k] * gamma * normal[c]
        for c in range(3):
            p[2 + k, c] = grad[3 + k] * normal[c]


@njit(cache=True)
def vector_hessian(v, normal, dual, b, grad, hess, christoffel, h):
    """Fill h (5, 5, 9): d2psi/d(vectors)2, blocks row by row."""
    # First derivatives of s with respect to the five vectors: (6, 5, 3).
    d = np.zeros((6, 5, 3))
    for c in range(3):
        d[0, 0, c] = 2.0 * v[0, c]
        d[1, 0, c] = v[1, c]
        d[1, 1, c] = v[0, c]
        d[2, 1, c] = 2.0 * v[1, c]
        for k in range(3):
            d[3 + k, 0, c] = -christoffel[k, 0] * normal[c]
            d[3 + k, 1, c] = -christoffel[k, 1] * normal[c]
            d[3 + k, 2 + k, c] = normal[c]
    hd = np.zeros((6, 5, 3))
    for s in range(6):
        for r in range(6):
            for a in range(5):
                for c in range(3):
                    hd[s, a, c] += hess[s, r] * d[r, a, c]
    h[:] = 0.0
    for a in range(5):
        for f in range(5):
            for s in range(6):
                for r in range(3):
                    if d[s, a, r] != 0.0:
                        for c in range(3):
                            h[a, f, 3 * r + c] += d[s, a, r] * hd[s, f, c]
    for r in range(3):
        h[0, 0, 4 * r] += 2.0 * grad[0]
        h[0, 1, 4 * r] += grad[1]
        h[1, 0, 4 * r] += grad[1]
        h[1, 1, 4 * r] += 2.0 * grad[2]
    for k in range(3):
        m = grad[3 + k]
        for g in range(2):
            for r in range(3):
                for c in range(3):
                    h[2 + k, g, 3 * r + c] -= m * dual[g, r] * normal[c]
                    h[g, 2 + k, 3 * c + r] -= m * dual[g, r] * normal[c]
            for f in range(2):
                metric = dual[g, 0] * dual[f, 0] + dual[g, 1] * dual[f, 1] + dual[g, 2] * dual[f, 2]
                for r in range(3):
                    for c in range(3):
                        h[g, f, 3 * r + c] += m * (
                            christoffel[k, f] * normal[r] * dual[g, c]
                            + christoffel[k, g] * dual[f, r] * normal[c]
                            - metric * b[k] * normal[r] * normal[c]
                        )


@njit(cache=True)
def add_point_rows(n, w, h, half, rows):
    """Add a point's h (5, 5, 9) to the upper block triangle of an element, rows (12, 108)."""
    for a in range(5):
        for j in range(12):
            for k in range(9):
                s = 0.0
                for f in range(5):
                    s += h[a, f, k] * n[f, j]
                half[a, 9 * j + k] = w * s
    for i in range(12):
        for a in range(5):
            factor = n[a, i]
            for k in range(9 * i, 108):
                rows[i, k] += factor * half[a, k]


@njit(cache=True)
def store_rows(rows, out):
    """Copy rows (12, 108) into the blocks (78, 3, 3) of an element."""
    pair = 0
    for i in range(12):
        for j in range(i, 12):
            for k in range(9):
                out[pair, k // 3, k % 3] = rows[i, 9 * j + k]
            pair += 1

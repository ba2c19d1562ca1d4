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

#: Entries of a 3 x 3 block that are computed; the other three are those of the transposed block.
ROWS, COLUMNS = (0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2)


@njit(cache=True)
def point_vectors(y, vectors, derivatives, local, v):
    """Fill v (q, 5, 3), the five vectors at all points of an element.

    derivatives (q, 5, 12) of its twelve vectors, which are gathered in local (12, 3).
    """
    for i in range(12):
        for c in range(3):
            local[i, c] = y[vectors[i], c]
    n = 5 * len(v)
    np.dot(derivatives.reshape(n, 12), local, v.reshape(n, 3))


@njit(cache=True)
def forms(v, normal, dual, e, b):
    """Fill unit normal, dual basis, a - I and b at a point from its vectors v (5, 3); returns J."""
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
def add_element_forces(derivatives, p, vectors, local, out):
    """Add the forces of all points' weighted p (q, 5, 3) on the element's twelve vectors.

    derivatives (q, 5, 12); local (12, 3) is overwritten.
    """
    n = 5 * len(p)
    np.dot(derivatives.reshape(n, 12).T, p.reshape(n, 3), local)
    for i in range(12):
        for c in range(3):
            out[vectors[i], c] += local[i, c]


@njit(cache=True)
def christoffel_symbols(v, dual, christoffel):
    """Fill christoffel (3, 2), G^g for each component of b."""
    for k in range(3):
        for g in range(2):
            christoffel[k, g] = (
                dual[g, 0] * v[2 + k, 0] + dual[g, 1] * v[2 + k, 1] + dual[g, 2] * v[2 + k, 2]
            )


@njit(cache=True)
def vector_gradient(v, normal, christoffel, grad, w, p):
    """Fill p (5, 3) = w dpsi/d(vectors)."""
    turned = np.empty(2)
    for g in range(2):
        turned[g] = w * (
            grad[3] * christoffel[0, g] + grad[4] * christoffel[1, g] + grad[5] * christoffel[2, g]
        )
    for c in range(3):
        p[0, c] = w * (2.0 * grad[0] * v[0, c] + grad[1] * v[1, c]) - turned[0] * normal[c]
        p[1, c] = w * (2.0 * grad[2] * v[1, c] + grad[1] * v[0, c]) - turned[1] * normal[c]
        for k in range(3):
            p[2 + k, c] = w * grad[3 + k] * normal[c]


@njit(cache=True)
def _outer(x, y, factor, out):
    """Add factor x (x) y to out (3, 3)."""
    for r in range(3):
        for c in range(3):
            out[r, c] += factor * x[r] * y[c]


@njit(cache=True)
def _tangent_blocks(v, normal, dual, b, grad, hess, christoffel, h, work):
    """Fill the parts of h among x_u, x_v, and between them and the second derivatives."""
    pull, block = work[:6], work[6:]
    for f in range(2):
        # Rows: hess applied to ds/dx_f, of the six components of s.
        own, other = v[f], v[1 - f]
        for s in range(6):
            turned = 0.0
            for k in range(3):
                turned += hess[s, 3 + k] * christoffel[k, f]
            for c in range(3):
                pull[s, c] = (
                    2.0 * hess[s, 2 * f] * own[c] + hess[s, 1] * other[c] - turned * normal[c]
                )
        for k in range(3):
            m = grad[3 + k]
            for i in range(6):
                r, c = ROWS[i], COLUMNS[i]
                h[f, 2 + k, i] = pull[3 + k, r] * normal[c] - m * normal[r] * dual[f, c]
                h[2 + k, f, i] = normal[r] * pull[3 + k, c] - m * dual[f, r] * normal[c]
        for g in range(f + 1):
            block[:] = 0.0
            _outer(v[g], pull[2 * g], 2.0, block)
            _outer(v[1 - g], pull[1], 1.0, block)
            bent = 0.0
            metric = dual[g, 0] * dual[f, 0] + dual[g, 1] * dual[f, 1] + dual[g, 2] * dual[f, 2]
            for k in range(3):
                m = grad[3 + k]
                _outer(normal, pull[3 + k], -christoffel[k, g], block)
                _outer(normal, dual[g], m * christoffel[k, f], block)
                _outer(dual[f], normal, m * christoffel[k, g], block)
                bent += m * b[k]
            _outer(normal, normal, -metric * bent, block)
            for r in range(3):
                block[r, r] += grad[1] if f != g else 2.0 * grad[2 * g]
            for i in range(6):
                h[g, f, i] = block[ROWS[i], COLUMNS[i]]
                h[f, g, i] = block[COLUMNS[i], ROWS[i]]


@njit(cache=True)
def vector_hessian(v, normal, dual, b, grad, hess, christoffel, h, work):
    """Fill h (5, 5, 6): d2psi/d(vectors)2, entries `ROWS`, `COLUMNS` of every 3 x 3 block.

    The other three are those of the transposed pair. `work` is (9, 3).
    """
    _tangent_blocks(v, normal, dual, b, grad, hess, christoffel, h, work)
    for i in range(6):
        square = normal[ROWS[i]] * normal[COLUMNS[i]]
        for k in range(3):
            for m in range(3):
                h[2 + k, 2 + m, i] = hess[3 + k, 3 + m] * square


@njit(cache=True)
def fill_point(n, w, h, half):
    """Fill half (5, 6, 12) with w h (5, 5, 6) times a point's derivatives n (5, 12)."""
    for a in range(5):
        for i in range(6):
            h0, h1, h2 = w * h[a, 0, i], w * h[a, 1, i], w * h[a, 2, i]
            h3, h4 = w * h[a, 3, i], w * h[a, 4, i]
            for j in range(12):
                half[a, i, j] = (
                    h0 * n[0, j] + h1 * n[1, j] + h2 * n[2, j] + h3 * n[3, j] + h4 * n[4, j]
                )


@njit(cache=True)
def store_blocks(derivatives, half, out):
    """Blocks (78, 3, 3) of an element from all its points: derivatives (n, 12), half (n, 72)."""
    products = np.dot(derivatives.T, half)
    pair = 0
    for i in range(12):
        for j in range(i, 12):
            for k in range(6):
                out[pair, ROWS[k], COLUMNS[k]] = products[i, 12 * k + j]
                out[pair, COLUMNS[k], ROWS[k]] = products[j, 12 * k + i]
            pair += 1

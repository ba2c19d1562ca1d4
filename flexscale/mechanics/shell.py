"""Geometrically exact Kirchhoff-Love sheet on C1 (Hsieh-Clough-Tocher) triangles: the substrate.

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

from flexscale.mechanics.energy import FloatArray, IntArray
from flexscale.mechanics.hct import N_DOFS, hct_derivatives
from flexscale.mechanics.shell_law import bending_energy, membrane_energy, shell_law
from flexscale.mechanics.substrate_options import BENDING_MEASURES

_N_VECTORS = 5
_NO_HESSIAN = np.empty((0, 0))


@njit(cache=True)
def _forms(y, vectors, derivatives, v, normal, dual, e, b):
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
def _energies(y, vectors, derivatives, weights, law, out):
    mu, lam, thickness, stiffness, nu, measure = law
    v, normal, dual = np.empty((5, 3)), np.empty(3), np.empty((2, 3))
    e, b, a = np.empty(3), np.empty(3), np.empty(3)
    out[:] = 0.0
    for t in range(len(vectors)):
        for q in range(weights.shape[1]):
            area = _forms(y, vectors[t], derivatives[t, q], v, normal, dual, e, b)
            if not area > 0.0:
                out[:] = np.inf
                return
            a[0], a[1], a[2] = 1.0 + e[0], e[1], 1.0 + e[2]
            out[0] += weights[t, q] * thickness * membrane_energy(e[0], e[1], e[2], mu, lam)
            out[1] += weights[t, q] * stiffness * bending_energy(a, b, area, nu, measure)


@njit(cache=True)
def _vector_gradient(v, normal, dual, grad, p, christoffel):
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
def _gradient(y, vectors, derivatives, weights, law, out):
    mu, lam, thickness, stiffness, nu, measure = law
    v, normal, dual = np.empty((5, 3)), np.empty(3), np.empty((2, 3))
    e, b, grad, no_hessian = np.empty(3), np.empty(3), np.empty(6), np.empty((0, 0))
    p, christoffel = np.empty((5, 3)), np.empty((3, 2))
    for t in range(len(vectors)):
        for q in range(weights.shape[1]):
            _forms(y, vectors[t], derivatives[t, q], v, normal, dual, e, b)
            shell_law(e, b, mu, lam, thickness, stiffness, nu, measure, grad, no_hessian)
            _vector_gradient(v, normal, dual, grad, p, christoffel)
            for i in range(12):
                for c in range(3):
                    s = 0.0
                    for a in range(5):
                        s += derivatives[t, q, a, i] * p[a, c]
                    out[vectors[t, i], c] += weights[t, q] * s


@njit(cache=True)
def _vector_hessian(v, normal, dual, b, grad, hess, christoffel, h):
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
def _hessian(y, vectors, derivatives, weights, law, out):
    mu, lam, thickness, stiffness, nu, measure = law
    v, normal, dual = np.empty((5, 3)), np.empty(3), np.empty((2, 3))
    e, b, grad, hess = np.empty(3), np.empty(3), np.empty(6), np.empty((6, 6))
    p, christoffel, h = np.empty((5, 3)), np.empty((3, 2)), np.empty((5, 5, 9))
    half = np.empty((5, 108))
    rows = np.empty((12, 108))
    for t in range(len(vectors)):
        rows[:] = 0.0
        for q in range(weights.shape[1]):
            n = derivatives[t, q]
            w = weights[t, q]
            _forms(y, vectors[t], n, v, normal, dual, e, b)
            shell_law(e, b, mu, lam, thickness, stiffness, nu, measure, grad, hess)
            _vector_gradient(v, normal, dual, grad, p, christoffel)
            _vector_hessian(v, normal, dual, b, grad, hess, christoffel, h)
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
        pair = 0
        for i in range(12):
            for j in range(i, 12):
                for k in range(9):
                    out[t, pair, k // 3, k % 3] = rows[i, 9 * j + k]
                pair += 1


class HctShell:
    """Membrane and bending energy of a sheet that is flat at rest.

    Parameters
    ----------
    corners : (n, 3, 2) rest coordinates of the triangles, mm.
    edge_normals : (n, 3, 2) unit directions of the mid-edge derivatives.
    vectors : (n, 12) rows of `y`: (x, x_u, x_v) at the vertices, x_n at edges 0-1, 1-2, 2-0.
    shear_modulus, lame_lambda : MPa.
    poisson_ratio : 1.
    thickness : mm.
    bending_stiffness : N mm.
    bending_measure : "turn", "form" or "curvature", see `shell_law`.
    """

    part_names: tuple[str, ...] = ("membrane", "bending")

    def __init__(
        self,
        corners: FloatArray,
        edge_normals: FloatArray,
        vectors: IntArray,
        *,
        shear_modulus: float,
        lame_lambda: float,
        poisson_ratio: float,
        thickness: float,
        bending_stiffness: float,
        bending_measure: str = "turn",
    ) -> None:
        derivatives, self.weights = hct_derivatives(corners, edge_normals)
        self.derivatives = np.ascontiguousarray(derivatives)
        self.vectors = np.ascontiguousarray(vectors, dtype=np.int64)
        measure = BENDING_MEASURES.index(bending_measure)
        self.law = (
            shear_modulus, lame_lambda, thickness, bending_stiffness, poisson_ratio, measure
        )  # fmt: skip

    def _arguments(self, y: FloatArray) -> tuple:
        return (y, self.vectors, self.derivatives, self.weights, self.law)

    def energy_parts(self, y: FloatArray) -> FloatArray:
        """(2,) membrane and bending energy, N mm; infinite where the sheet is degenerate."""
        out = np.zeros(2)
        _energies(*self._arguments(y), out)
        return out

    def add_gradient(self, y: FloatArray, gradient: FloatArray) -> None:
        """Add dE/dy to `gradient (n_y, 3)`."""
        _gradient(*self._arguments(y), gradient)

    def hessian_blocks(self, y: FloatArray) -> FloatArray:
        """(n, 78, 3, 3) blocks of d2E/dy2."""
        out = np.empty((len(self.vectors), N_DOFS * (N_DOFS + 1) // 2, 3, 3))
        _hessian(*self._arguments(y), out)
        return out

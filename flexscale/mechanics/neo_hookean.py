"""Compressible Neo-Hookean tetrahedra, linear or quadratic: the scales.

Psi(F) = mu/2 (I1 - 3 - 2 ln J) + lambda/2 ln^2 J per rest volume. With grad N_a the rest gradients
of the shape functions and h_a = F^-T grad N_a,

    P          = mu (F - F^-T) + lambda ln J F^-T
    K_ab / V   = mu (grad N_a . grad N_b) I + (mu - lambda ln J) h_b (x) h_a + lambda h_a (x) h_b

which follows from d(F^-T) = -F^-T dF^T F^-T.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from flexscale.arrays import FloatArray, IntArray
from flexscale.simplices import TET_EDGES


@njit(cache=True)
def _deformation_gradient(y, tet, gradients, f):
    for r in range(3):
        for c in range(3):
            s = 0.0
            for a in range(len(tet)):
                s += y[tet[a], r] * gradients[a, c]
            f[r, c] = s


@njit(cache=True)
def _inverse_transpose(f, g):
    """g = F^-T; returns det F."""
    for r in range(3):
        r1, r2 = (r + 1) % 3, (r + 2) % 3
        for c in range(3):
            c1, c2 = (c + 1) % 3, (c + 2) % 3
            g[r, c] = f[r1, c1] * f[r2, c2] - f[r1, c2] * f[r2, c1]
    det = f[0, 0] * g[0, 0] + f[0, 1] * g[0, 1] + f[0, 2] * g[0, 2]
    for r in range(3):
        for c in range(3):
            g[r, c] /= det
    return det


@njit(cache=True)
def _energies(y, tets, gradients, weights, mu, lam):
    total = 0.0
    f = np.empty((3, 3))
    g = np.empty((3, 3))
    for e in range(len(tets)):
        for q in range(weights.shape[1]):
            _deformation_gradient(y, tets[e], gradients[e, q], f)
            if _inverse_transpose(f, g) <= 0.0:
                return np.inf
            total += weights[e, q] * _energy_density(f, mu, lam)
    return total


@njit(cache=True)
def _energy_density(f, mu, lam):
    # Invariants of the strain C - I, not of C: the energy of a strain of 1e-6 is 1e-12 of mu.
    c00 = f[0, 0] ** 2 + f[1, 0] ** 2 + f[2, 0] ** 2 - 1.0
    c11 = f[0, 1] ** 2 + f[1, 1] ** 2 + f[2, 1] ** 2 - 1.0
    c22 = f[0, 2] ** 2 + f[1, 2] ** 2 + f[2, 2] ** 2 - 1.0
    c01 = f[0, 0] * f[0, 1] + f[1, 0] * f[1, 1] + f[2, 0] * f[2, 1]
    c02 = f[0, 0] * f[0, 2] + f[1, 0] * f[1, 2] + f[2, 0] * f[2, 2]
    c12 = f[0, 1] * f[0, 2] + f[1, 1] * f[1, 2] + f[2, 1] * f[2, 2]
    first = c00 + c11 + c22
    second = c00 * c11 + c11 * c22 + c22 * c00 - c01 * c01 - c02 * c02 - c12 * c12
    third = (
        c00 * (c11 * c22 - c12 * c12)
        - c01 * (c01 * c22 - c12 * c02)
        + c02 * (c01 * c12 - c11 * c02)
    )
    log_j = 0.5 * np.log1p(first + second + third)
    return 0.5 * mu * (first - 2.0 * log_j) + 0.5 * lam * log_j * log_j


@njit(cache=True)
def _gradient(y, tets, gradients, weights, mu, lam, out):
    f = np.empty((3, 3))
    g = np.empty((3, 3))
    p = np.empty((3, 3))
    for e in range(len(tets)):
        for q in range(weights.shape[1]):
            n = gradients[e, q]
            _deformation_gradient(y, tets[e], n, f)
            log_j = np.log(_inverse_transpose(f, g))
            for r in range(3):
                for c in range(3):
                    p[r, c] = weights[e, q] * (mu * (f[r, c] - g[r, c]) + lam * log_j * g[r, c])
            for a in range(len(n)):
                for r in range(3):
                    out[tets[e, a], r] += p[r, 0] * n[a, 0] + p[r, 1] * n[a, 1] + p[r, 2] * n[a, 2]


@njit(cache=True)
def _hessian(y, tets, gradients, weights, mu, lam, out):
    f = np.empty((3, 3))
    g = np.empty((3, 3))
    h = np.empty((tets.shape[1], 3))
    out[:] = 0.0
    for e in range(len(tets)):
        for q in range(weights.shape[1]):
            n = gradients[e, q]
            w = weights[e, q]
            _deformation_gradient(y, tets[e], n, f)
            log_j = np.log(_inverse_transpose(f, g))
            for a in range(len(n)):
                for r in range(3):
                    h[a, r] = g[r, 0] * n[a, 0] + g[r, 1] * n[a, 1] + g[r, 2] * n[a, 2]
            geometric = w * (mu - lam * log_j)
            volumetric = w * lam
            pair = 0
            for a in range(len(n)):
                for b in range(a, len(n)):
                    dot = n[a, 0] * n[b, 0] + n[a, 1] * n[b, 1] + n[a, 2] * n[b, 2]
                    for r in range(3):
                        for c in range(3):
                            out[e, pair, r, c] += (
                                geometric * h[b, r] * h[a, c] + volumetric * h[a, r] * h[b, c]
                            )
                        out[e, pair, r, r] += w * mu * dot
                    pair += 1


# Degree-2 rule on a tet: exact for the linear strains of a quadratic tet.
_INNER = 0.5854101966249685
_POINTS = np.full((4, 4), (1.0 - _INNER) / 3.0) + (_INNER - (1.0 - _INNER) / 3.0) * np.eye(4)


def _shape_gradients(corners: FloatArray, order: int) -> tuple[FloatArray, FloatArray]:
    """Rest gradients (n, n_q, k, 3) and weights (n, n_q) at quadrature points of tets (n, 4, 3)."""
    frames = np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2)
    volumes = np.linalg.det(frames) / 6.0
    inner = np.linalg.inv(frames)
    linear = np.concatenate([-inner.sum(axis=1, keepdims=True), inner], axis=1)
    if order == 1:
        return np.ascontiguousarray(linear[:, None]), volumes[:, None].copy()
    start, end = np.transpose(TET_EDGES)
    gradients = np.empty((len(corners), 4, 10, 3))
    for q, point in enumerate(_POINTS):
        gradients[:, q, :4] = (4.0 * point - 1.0)[:, None] * linear
        gradients[:, q, 4:] = 4.0 * (
            point[start, None] * linear[:, end] + point[end, None] * linear[:, start]
        )
    return gradients, np.repeat(volumes[:, None] / 4.0, 4, axis=1)


class NeoHookeanTets:
    """Elastic energy of the scales, on straight-sided tets.

    Parameters
    ----------
    rest_positions : (n_vertices, 3) mm.
    tets : (n_tets, k) rows of `rest_positions`: k = 4 corners, positively oriented, and for
        quadratic tets (k = 10) the middles of `TET_EDGES` behind them.
    vectors : (n_tets, k) rows of the world vectors `y` that hold these vertices' positions.
    shear_modulus, lame_lambda : MPa.
    """

    part_names: tuple[str, ...] = ("scales",)

    def __init__(
        self,
        rest_positions: FloatArray,
        tets: IntArray,
        vectors: IntArray,
        shear_modulus: float,
        lame_lambda: float,
    ) -> None:
        order = 2 if tets.shape[1] == 10 else 1
        self.gradients, self.weights = _shape_gradients(rest_positions[tets[:, :4]], order)
        self._set(vectors, shear_modulus, lame_lambda)

    def _set(self, vectors: IntArray, shear_modulus: float, lame_lambda: float) -> None:
        self.vectors = np.ascontiguousarray(vectors, dtype=np.int64)
        self.shear_modulus = float(shear_modulus)
        self.lame_lambda = float(lame_lambda)

    def _arguments(self, y: FloatArray) -> tuple:
        return (y, self.vectors, self.gradients, self.weights, self.shear_modulus, self.lame_lambda)

    def energy_parts(self, y: FloatArray) -> FloatArray:
        """(1,) N mm; infinite where a tetrahedron is inverted."""
        return np.array([_energies(*self._arguments(y))])

    def add_gradient(self, y: FloatArray, gradient: FloatArray) -> None:
        """Add dE/dy [N] to `gradient (n_y, 3)`."""
        _gradient(*self._arguments(y), gradient)

    def hessian_blocks(self, y: FloatArray) -> FloatArray:
        """(n_tets, k (k + 1) / 2, 3, 3) N/mm."""
        k = self.vectors.shape[1]
        out = np.empty((len(self.vectors), k * (k + 1) // 2, 3, 3))
        _hessian(*self._arguments(y), out)
        return out

"""Compressible Neo-Hookean linear tetrahedra: the scales.

Psi(F) = mu/2 (I1 - 3 - 2 ln J) + lambda/2 ln^2 J per rest volume. With grad N_a the rest gradients
of the shape functions and h_a = F^-T grad N_a,

    P          = mu (F - F^-T) + lambda ln J F^-T
    K_ab / V   = mu (grad N_a . grad N_b) I + (mu - lambda ln J) h_b (x) h_a + lambda h_a (x) h_b

which follows from d(F^-T) = -F^-T dF^T F^-T.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from flexscale.mechanics.energy import FloatArray, IntArray


@njit(cache=True)
def _deformation_gradient(y, tet, gradients, f):
    for r in range(3):
        for c in range(3):
            s = 0.0
            for a in range(4):
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
def _energies(y, tets, gradients, volumes, mu, lam):
    total = 0.0
    f = np.empty((3, 3))
    g = np.empty((3, 3))
    for e in range(len(tets)):
        _deformation_gradient(y, tets[e], gradients[e], f)
        if _inverse_transpose(f, g) <= 0.0:
            return np.inf
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
        psi = 0.5 * mu * (first - 2.0 * log_j) + 0.5 * lam * log_j * log_j
        total += volumes[e] * psi
    return total


@njit(cache=True)
def _gradient(y, tets, gradients, volumes, mu, lam, out):
    f = np.empty((3, 3))
    g = np.empty((3, 3))
    p = np.empty((3, 3))
    for e in range(len(tets)):
        _deformation_gradient(y, tets[e], gradients[e], f)
        log_j = np.log(_inverse_transpose(f, g))
        for r in range(3):
            for c in range(3):
                p[r, c] = volumes[e] * (mu * (f[r, c] - g[r, c]) + lam * log_j * g[r, c])
        for a in range(4):
            for r in range(3):
                s = 0.0
                for c in range(3):
                    s += p[r, c] * gradients[e, a, c]
                out[tets[e, a], r] += s


@njit(cache=True)
def _hessian(y, tets, gradients, volumes, mu, lam, out):
    f = np.empty((3, 3))
    g = np.empty((3, 3))
    h = np.empty((4, 3))
    for e in range(len(tets)):
        _deformation_gradient(y, tets[e], gradients[e], f)
        log_j = np.log(_inverse_transpose(f, g))
        for a in range(4):
            for r in range(3):
                h[a, r] = (
                    g[r, 0] * gradients[e, a, 0]
                    + g[r, 1] * gradients[e, a, 1]
                    + g[r, 2] * gradients[e, a, 2]
                )
        geometric = volumes[e] * (mu - lam * log_j)
        volumetric = volumes[e] * lam
        pair = 0
        for a in range(4):
            for b in range(a, 4):
                dot = (
                    gradients[e, a, 0] * gradients[e, b, 0]
                    + gradients[e, a, 1] * gradients[e, b, 1]
                    + gradients[e, a, 2] * gradients[e, b, 2]
                )
                for r in range(3):
                    for c in range(3):
                        out[e, pair, r, c] = (
                            geometric * h[b, r] * h[a, c] + volumetric * h[a, r] * h[b, c]
                        )
                    out[e, pair, r, r] += volumes[e] * mu * dot
                pair += 1


class NeoHookeanTets:
    """Elastic energy of the scales.

    Parameters
    ----------
    rest_positions : (n_vertices, 3) mm.
    tets : (n_tets, 4) rows of `rest_positions`, positively oriented.
    vectors : (n_tets, 4) rows of the world vectors `y` that hold these vertices' positions.
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
        corners = rest_positions[tets]
        frames = np.swapaxes(corners[:, 1:] - corners[:, :1], 1, 2)
        inner = np.linalg.inv(frames) if len(tets) else np.zeros((0, 3, 3))
        self.vectors = np.ascontiguousarray(vectors, dtype=np.int64)
        self.volumes = np.linalg.det(frames) / 6.0 if len(tets) else np.zeros(0)
        self.gradients = np.concatenate([-inner.sum(axis=1, keepdims=True), inner], axis=1)
        self.shear_modulus = float(shear_modulus)
        self.lame_lambda = float(lame_lambda)

    def _arguments(self, y: FloatArray) -> tuple:
        return (y, self.vectors, self.gradients, self.volumes, self.shear_modulus, self.lame_lambda)

    def energy_parts(self, y: FloatArray) -> FloatArray:
        """(1,) N mm; infinite where a tetrahedron is inverted."""
        return np.array([_energies(*self._arguments(y))])

    def add_gradient(self, y: FloatArray, gradient: FloatArray) -> None:
        """Add dE/dy [N] to `gradient (n_y, 3)`."""
        _gradient(*self._arguments(y), gradient)

    def hessian_blocks(self, y: FloatArray) -> FloatArray:
        """(n_tets, 10, 3, 3) N/mm."""
        out = np.empty((len(self.vectors), 10, 3, 3))
        _hessian(*self._arguments(y), out)
        return out

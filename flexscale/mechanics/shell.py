"""Geometrically exact Kirchhoff-Love sheet on C1 (Hsieh-Clough-Tocher) triangles: the substrate.

Kinematics: `shell_forms`; energy per area: `layered_law` or, with a bending measure, `shell_law`.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from flexscale.arrays import FloatArray, IntArray
from flexscale.mechanics.hct import N_DOFS, hct_derivatives
from flexscale.mechanics.layered_law import layered_energy, layered_law
from flexscale.mechanics.shell_forms import (
    add_element_forces,
    christoffel_symbols,
    fill_point,
    forms,
    point_vectors,
    store_blocks,
    vector_gradient,
    vector_hessian,
)
from flexscale.mechanics.shell_law import bending_energy, membrane_energy, shell_law
from flexscale.mechanics.substrate_options import BENDING_MEASURES, DEFAULT_MEASURE

LAYERS = BENDING_MEASURES.index("layers")


@njit(cache=True)
def _energies(y, vectors, derivatives, weights, law, out):
    mu, lam, thickness, stiffness, nu, measure = law
    v, local = np.empty((weights.shape[1], 5, 3)), np.empty((12, 3))
    normal, dual = np.empty(3), np.empty((2, 3))
    e, b, a = np.empty(3), np.empty(3), np.empty(3)
    out[:] = 0.0
    for t in range(len(vectors)):
        point_vectors(y, vectors[t], derivatives[t], local, v)
        for q in range(weights.shape[1]):
            area = forms(v[q], normal, dual, e, b)
            if not area > 0.0:
                out[:] = np.inf
                return
            if measure == LAYERS:
                stretching, bending = layered_energy(e, b, mu, lam, thickness)
                out[0] += weights[t, q] * stretching
                out[1] += weights[t, q] * bending
                continue
            a[0], a[1], a[2] = 1.0 + e[0], e[1], 1.0 + e[2]
            out[0] += weights[t, q] * thickness * membrane_energy(e[0], e[1], e[2], mu, lam)
            out[1] += weights[t, q] * stiffness * bending_energy(a, b, area, nu)


@njit(cache=True)
def _gradient(y, vectors, derivatives, weights, law, out):
    mu, lam, thickness, stiffness, nu, measure = law
    n_points = weights.shape[1]
    v, p, local = np.empty((n_points, 5, 3)), np.empty((n_points, 5, 3)), np.empty((12, 3))
    normal, dual, christoffel = np.empty(3), np.empty((2, 3)), np.empty((3, 2))
    e, b, grad, no_hessian = np.empty(3), np.empty(3), np.empty(6), np.empty((0, 0))
    law_work = np.empty((3, 6))
    for t in range(len(vectors)):
        point_vectors(y, vectors[t], derivatives[t], local, v)
        for q in range(n_points):
            forms(v[q], normal, dual, e, b)
            if measure == LAYERS:
                layered_law(e, b, mu, lam, thickness, grad, no_hessian, law_work)
            else:
                shell_law(e, b, mu, lam, thickness, stiffness, nu, grad, no_hessian)
            christoffel_symbols(v[q], dual, christoffel)
            vector_gradient(v[q], normal, christoffel, grad, weights[t, q], p[q])
        add_element_forces(derivatives[t], p, vectors[t], local, out)


@njit(cache=True)
def _hessian(y, vectors, derivatives, weights, law, out):
    mu, lam, thickness, stiffness, nu, measure = law
    n_points = weights.shape[1]
    v, local = np.empty((n_points, 5, 3)), np.empty((12, 3))
    normal, dual, christoffel = np.empty(3), np.empty((2, 3)), np.empty((3, 2))
    e, b, grad, hess = np.empty(3), np.empty(3), np.empty(6), np.empty((6, 6))
    half, h = np.empty((n_points, 5, 6, 12)), np.empty((5, 5, 6))
    work, law_work = np.empty((9, 3)), np.empty((3, 6))
    for t in range(len(vectors)):
        point_vectors(y, vectors[t], derivatives[t], local, v)
        for q in range(n_points):
            forms(v[q], normal, dual, e, b)
            if measure == LAYERS:
                layered_law(e, b, mu, lam, thickness, grad, hess, law_work)
            else:
                shell_law(e, b, mu, lam, thickness, stiffness, nu, grad, hess)
            christoffel_symbols(v[q], dual, christoffel)
            vector_hessian(v[q], normal, dual, b, grad, hess, christoffel, h, work)
            fill_point(derivatives[t, q], weights[t, q], h, half[q])
        points = derivatives[t].reshape(5 * n_points, 12)
        store_blocks(points, half.reshape(5 * n_points, 72), out[t])


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
    bending_measure : "layers", see `layered_law`, or "turn", see `shell_law`.
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
        bending_measure: str = DEFAULT_MEASURE,
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

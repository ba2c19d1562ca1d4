"""Bending of a triangulated sheet by per-triangle shape operators with edge normals.

Stencil: a triangle, the three vertices across its edges, and one angle xi per edge (Grinspun,
Gingold, Reisman and Zorin, "Computing discrete shape operators on general meshes", 2006). The
normal of an edge is the average of its two faces' normals, turned about the edge by xi. From a
face's normal to its edge's it is the turn

    phi_i = theta_i / 2 + s_i xi_i,

theta_i the dihedral angle, s_i = +1 and -1 on the two sides of the edge. Where one side of an edge
is held by a scale and the edge's normal with it, phi_i = theta_i. The quadratic height that leaves
the triangle's plane at mid-edges with slopes phi_i has the constant second derivative

    S = sum phi_i l_i / A  nu_i (x) nu_i

(l_i, nu_i, A rest lengths, outward normals and area; so S is the turn per rest length), and the
energy D/2 A [(1 - nu) tr S^2 + nu (tr S)^2] = 1/2 c^T K c with

    K_ij = D l_i l_j / A [(1 - nu) (nu_i . nu_j)^2 + nu]

with c_i = 2 tan(phi_i / 2) for phi_i: the tangent does not saturate, so a triangle cannot fold for
nothing. With c' = 1 + c^2/4 and c'' = c c'/2,

    dE  = sum g_i dphi_i,   g_i = (K c)_i c'_i
    d2E = sum (K_ij c'_i c'_j + delta_ij (K c)_i c''_i) dphi_i (x) dphi_j + sum g_i d2phi_i.

Without the angles zigzags of the faces' normals cost nothing, and no refinement makes up for that.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from flexscale.arrays import FloatArray, IntArray
from flexscale.mechanics.constant_strain import triangle_gradients
from flexscale.mechanics.dihedral import add_angle_gradient, add_angle_hessian, edge_frame


@njit(cache=True)
def _turns(y, rows, shares, signs, frames, sizes, c):
    """Fill frames and sizes of the three edges, and c; False if the triangle is degenerate."""
    for i in range(3):
        c[i] = 0.0
        if shares[i] == 0.0:
            continue
        p, q = y[rows[i]], y[rows[(i + 1) % 3]]
        a, b = y[rows[(i + 2) % 3]], y[rows[3 + i]]
        turn = shares[i] * edge_frame(p, q, a, b, frames[i], sizes[i])
        turn += signs[i] * y[rows[6 + i], 0]
        if not abs(turn) < np.pi:
            return False
        c[i] = 2.0 * np.tan(0.5 * turn)
    return True


@njit(cache=True)
def _energy(y, vectors, stiffness, shares, signs):
    frames, sizes, c = np.empty((3, 5, 3)), np.empty((3, 5)), np.empty(3)
    total = 0.0
    for t in range(len(vectors)):
        if not _turns(y, vectors[t], shares[t], signs[t], frames, sizes, c):
            return np.inf
        for i in range(3):
            for j in range(3):
                total += 0.5 * stiffness[t, i, j] * c[i] * c[j]
    return total


@njit(cache=True)
def _couples(stiffness, c, moment, rate):
    """Fill K c and c'."""
    for i in range(3):
        moment[i] = 0.0
        rate[i] = 1.0 + 0.25 * c[i] * c[i]
        for j in range(3):
            moment[i] += stiffness[i, j] * c[j]


@njit(cache=True)
def local_nodes(i):
    """Local numbers of p, q, a, b of edge i."""
    return (i, (i + 1) % 3, (i + 2) % 3, 3 + i)


@njit(cache=True)
def _gradient(y, vectors, stiffness, shares, signs, out):
    frames, sizes, c = np.empty((3, 5, 3)), np.empty((3, 5)), np.empty(3)
    moment, rate = np.empty(3), np.empty(3)
    local = np.empty((6, 3))
    for t in range(len(vectors)):
        _turns(y, vectors[t], shares[t], signs[t], frames, sizes, c)
        _couples(stiffness[t], c, moment, rate)
        local[:] = 0.0
        for i in range(3):
            if shares[t, i] == 0.0:
                continue
            g = moment[i] * rate[i]
            add_angle_gradient(frames[i], sizes[i], g * shares[t, i], local_nodes(i), local)
            out[vectors[t, 6 + i], 0] += g * signs[t, i]
        for k in range(6):
            for r in range(3):
                out[vectors[t, k], r] += local[k, r]


@njit(cache=True)
def _hessian(y, vectors, stiffness, shares, signs, out):
    n = vectors.shape[1]
    frames, sizes, c = np.empty((3, 5, 3)), np.empty((3, 5)), np.empty(3)
    moment, rate, middle = np.empty(3), np.empty(3), np.empty((3, 3))
    slopes, halves = np.empty((3, n, 3)), np.empty((3, n, 3))
    full = np.empty((n, n, 3, 3))
    for t in range(len(vectors)):
        _turns(y, vectors[t], shares[t], signs[t], frames, sizes, c)
        _couples(stiffness[t], c, moment, rate)
        full[:] = 0.0
        slopes[:] = 0.0
        for i in range(3):
            for j in range(3):
                middle[i, j] = stiffness[t, i, j] * rate[i] * rate[j]
            middle[i, i] += 0.5 * moment[i] * c[i] * rate[i]
            if shares[t, i] == 0.0:
                continue
            g = moment[i] * rate[i] * shares[t, i]
            add_angle_gradient(frames[i], sizes[i], shares[t, i], local_nodes(i), slopes[i])
            add_angle_hessian(frames[i], sizes[i], g, local_nodes(i), full)
            slopes[i, 6 + i, 0] = signs[t, i]
        for i in range(3):
            for k in range(n):
                for r in range(3):
                    s = 0.0
                    for j in range(3):
                        s += middle[i, j] * slopes[j, k, r]
                    halves[i, k, r] = s
        pair = 0
        for x in range(n):
            for z in range(x, n):
                for r in range(3):
                    for k in range(3):
                        s = full[x, z, r, k]
                        for i in range(3):
                            s += slopes[i, x, r] * halves[i, z, k]
                        out[t, pair, r, k] = s
                pair += 1


@dataclass(frozen=True)
class EdgeStencils:
    """The triangles that bend, and where they find their world vectors.

    Attributes
    ----------
    corners : (n, 3, 2) rest coordinates, counterclockwise, mm.
    vectors : (n, 9) rows of y: the corners, the vertices across the edges 0-1, 1-2, 2-0, and rows
        whose first component is the edge's xi [rad].
    shares : (n, 3) share of the dihedral angle in the turn of each edge; 0 where nothing turns.
    signs : (n, 3) s_i.
    """

    corners: FloatArray
    vectors: IntArray
    shares: FloatArray
    signs: FloatArray


class EdgeAngleBending:
    """Bending energy of a sheet that is flat at rest.

    Parameters
    ----------
    stencils : triangles with their neighborhoods.
    bending_stiffness : D, N mm.
    poisson_ratio : 1.
    """

    part_names: tuple[str, ...] = ("bending",)

    def __init__(
        self, stencils: EdgeStencils, *, bending_stiffness: float, poisson_ratio: float
    ) -> None:
        gradients, areas = triangle_gradients(stencils.corners)
        # nu_i l_i = -2 A grad N_k, k the vertex across edge i.
        outward = -2.0 * areas[:, None, None] * np.roll(gradients, -2, axis=1)
        lengths = np.linalg.norm(outward, axis=2)
        products = lengths[:, :, None] * lengths[:, None, :]
        cosines = np.einsum("nid,njd->nij", outward, outward) / products
        isotropic = (1.0 - poisson_ratio) * cosines**2 + poisson_ratio
        self.stiffness = bending_stiffness * products / areas[:, None, None] * isotropic
        self.vectors = np.ascontiguousarray(stencils.vectors, dtype=np.int64)
        self.shares = np.ascontiguousarray(stencils.shares, dtype=float)
        self.signs = np.ascontiguousarray(stencils.signs, dtype=float)

    def _arguments(self, y: FloatArray) -> tuple:
        return (y, self.vectors, self.stiffness, self.shares, self.signs)

    def energy_parts(self, y: FloatArray) -> FloatArray:
        """(1,) N mm; infinite where a triangle has no area or a turn reaches pi."""
        return np.array([_energy(*self._arguments(y))])

    def add_gradient(self, y: FloatArray, gradient: FloatArray) -> None:
        """Add dE/dy [N, or N mm for edge angles] to `gradient (n_y, 3)`."""
        _gradient(*self._arguments(y), gradient)

    def hessian_blocks(self, y: FloatArray) -> FloatArray:
        """(n, 45 or 21, 3, 3) blocks of d2E/dy2."""
        n, k = self.vectors.shape
        out = np.empty((n, k * (k + 1) // 2, 3, 3))
        _hessian(*self._arguments(y), out)
        return out

"""The paper's macro element with any sheet law: linear triangles and per-triangle shape operators.

On a triangle the first form a is that of constant strain and the second form is the shape operator
of `edge_angles`: from the turns phi_i of the edges' normals against the face's,

    b = sum c_i B_i,   c_i = 2 tan(phi_i / 2),   B_i = l_i / A nu_i (x) nu_i,

and the energy is A psi(a - I, b), hence

    dE  = A (psi_e . de + sum g_i dphi_i),   g_i = (psi_b . B_i) c'_i
    d2E = A [(de, db) psi'' (de, db) + psi_e . d2e + sum (psi_b . B_i) c''_i dphi_i^2 + g_i d2phi_i]

with db = sum B_i c'_i dphi_i, c' = 1 + c^2/4 and c'' = c c'/2. On a free edge phi = xi, so nothing
holds its normal: its couple vanishes at equilibrium. The sheet is flat at rest; b is the turn per
rest length.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numba import njit

from flexscale.mechanics.constant_strain import triangle_gradients
from flexscale.mechanics.dihedral import add_angle_gradient, add_angle_hessian, edge_frame
from flexscale.mechanics.edge_angles import EdgeStencils
from flexscale.mechanics.energy import FloatArray
from flexscale.mechanics.sheet_law import SheetLaw
from flexscale.mechanics.sheet_shell import CHUNK

_PAIRS = ((0, 0), (0, 1), (1, 1))


@njit(cache=True)
def _local_nodes(i):
    """Local numbers of p, q, a, b of edge i."""
    return (i, (i + 1) % 3, (i + 2) % 3, 3 + i)


@njit(cache=True)
def _turns(y, rows, shares, signs, frames, sizes, c):
    """Fill frames and sizes of the three edges, and c; False if the triangle is degenerate."""
    for i in range(3):
        turn = 0.0
        if shares[i] != 0.0:
            p, q = y[rows[i]], y[rows[(i + 1) % 3]]
            a, b = y[rows[(i + 2) % 3]], y[rows[3 + i]]
            turn = shares[i] * edge_frame(p, q, a, b, frames[i], sizes[i])
        if len(rows) == 9:
            turn += signs[i] * y[rows[6 + i], 0]
        if not abs(turn) < np.pi:
            return False
        c[i] = 2.0 * np.tan(0.5 * turn)
    return True


@njit(cache=True)
def _stretch(y, rows, gradients, f, out):
    """Fill F (3, 2) and e = F^T F - I; returns det a."""
    for r in range(3):
        for d in range(2):
            f[r, d] = 0.0
            for a in range(3):
                f[r, d] += y[rows[a], r] * gradients[a, d]
    out[0] = f[0, 0] ** 2 + f[1, 0] ** 2 + f[2, 0] ** 2 - 1.0
    out[1] = f[0, 0] * f[0, 1] + f[1, 0] * f[1, 1] + f[2, 0] * f[2, 1]
    out[2] = f[0, 1] ** 2 + f[1, 1] ** 2 + f[2, 1] ** 2 - 1.0
    return (1.0 + out[0]) * (1.0 + out[2]) - out[1] ** 2


@njit(cache=True)
def _states(y, vectors, gradients, shapes, shares, signs, out):
    frames, sizes, c, f = np.empty((3, 5, 3)), np.empty((3, 5)), np.empty(3), np.empty((3, 2))
    for t in range(len(vectors)):
        if not _stretch(y, vectors[t], gradients[t], f, out[t]) > 0.0:
            return False
        if not _turns(y, vectors[t], shares[t], signs[t], frames, sizes, c):
            return False
        for k in range(3):
            out[t, 3 + k] = 0.0
            for i in range(3):
                out[t, 3 + k] += c[i] * shapes[t, i, k]
    return True


@njit(cache=True)
def _strain_rates(f, gradients, d):
    """Fill d (3, 3, 3): de_k / dx_a of the three corners."""
    for a in range(3):
        for r in range(3):
            d[0, a, r] = 2.0 * gradients[a, 0] * f[r, 0]
            d[1, a, r] = gradients[a, 0] * f[r, 1] + gradients[a, 1] * f[r, 0]
            d[2, a, r] = 2.0 * gradients[a, 1] * f[r, 1]


@njit(cache=True)
def _gradient(y, vectors, gradients, shapes, shares, signs, areas, grads, out):
    frames, sizes, c, f = np.empty((3, 5, 3)), np.empty((3, 5)), np.empty(3), np.empty((3, 2))
    e, d, local = np.empty(3), np.empty((3, 3, 3)), np.empty((6, 3))
    for t in range(len(vectors)):
        _stretch(y, vectors[t], gradients[t], f, e)
        _turns(y, vectors[t], shares[t], signs[t], frames, sizes, c)
        _strain_rates(f, gradients[t], d)
        local[:] = 0.0
        for k in range(3):
            for a in range(3):
                for r in range(3):
                    local[a, r] += areas[t] * grads[t, k] * d[k, a, r]
        for i in range(3):
            g = 0.0
            for k in range(3):
                g += areas[t] * grads[t, 3 + k] * shapes[t, i, k]
            g *= 1.0 + 0.25 * c[i] * c[i]
            if shares[t, i] != 0.0:
                add_angle_gradient(frames[i], sizes[i], g * shares[t, i], _local_nodes(i), local)
            if vectors.shape[1] == 9:
                out[vectors[t, 6 + i], 0] += g * signs[t, i]
        for k in range(6):
            for r in range(3):
                out[vectors[t, k], r] += local[k, r]


@njit(cache=True)
def _hessian(y, vectors, gradients, shapes, shares, signs, areas, grads, hessians, out):
    n = vectors.shape[1]
    frames, sizes, c, f = np.empty((3, 5, 3)), np.empty((3, 5)), np.empty(3), np.empty((3, 2))
    e, d = np.empty(3), np.empty((3, 3, 3))
    rates, halves = np.empty((6, n, 3)), np.empty((6, n, 3))
    slope, full = np.empty((n, 3)), np.empty((n, n, 3, 3))
    for t in range(len(vectors)):
        _stretch(y, vectors[t], gradients[t], f, e)
        _turns(y, vectors[t], shares[t], signs[t], frames, sizes, c)
        _strain_rates(f, gradients[t], d)
        full[:] = 0.0
        rates[:] = 0.0
        rates[:3, :3] = d
        for a in range(3):
            for b in range(3):
                u, v = gradients[t, a], gradients[t, b]
                s = 2.0 * grads[t, 0] * u[0] * v[0] + 2.0 * grads[t, 2] * u[1] * v[1]
                s += grads[t, 1] * (u[0] * v[1] + u[1] * v[0])
                for r in range(3):
                    full[a, b, r, r] += areas[t] * s
        for i in range(3):
            g = 0.0
            for k in range(3):
                g += areas[t] * grads[t, 3 + k] * shapes[t, i, k]
            rate = 1.0 + 0.25 * c[i] * c[i]
            slope[:] = 0.0
            if shares[t, i] != 0.0:
                nodes = _local_nodes(i)
                add_angle_gradient(frames[i], sizes[i], shares[t, i], nodes, slope)
                add_angle_hessian(frames[i], sizes[i], g * rate * shares[t, i], nodes, full)
            if n == 9:
                slope[6 + i, 0] = signs[t, i]
            _add_square(slope, 0.5 * g * c[i] * rate, full)
            for k in range(3):
                for x in range(n):
                    for r in range(3):
                        rates[3 + k, x, r] += shapes[t, i, k] * rate * slope[x, r]
        for s in range(6):
            for x in range(n):
                for r in range(3):
                    total = 0.0
                    for q in range(6):
                        total += hessians[t, s, q] * rates[q, x, r]
                    halves[s, x, r] = areas[t] * total
        pair = 0
        for x in range(n):
            for z in range(x, n):
                for r in range(3):
                    for k in range(3):
                        total = full[x, z, r, k]
                        for s in range(6):
                            total += rates[s, x, r] * halves[s, z, k]
                        out[t, pair, r, k] = total
                pair += 1


@njit(cache=True)
def _add_square(slope, factor, full):
    for x in range(len(slope)):
        for z in range(len(slope)):
            for r in range(3):
                for k in range(3):
                    full[x, z, r, k] += factor * slope[x, r] * slope[z, k]


class SheetTriangles:
    """Energy of a flat sheet with a sheet law on linear triangles.

    Parameters
    ----------
    stencils : triangles, see `EdgeStencils`; a free edge has share 0 and sign 1.
    law : energy per rest area.
    material_direction : rad, from the x axis of the rest coordinates to the material's first axis.

    Attributes
    ----------
    points : (n, 1, 2) centroids, mm.
    weights : (n, 1) rest areas, mm2.
    """

    part_names: tuple[str, ...] = ("sheet",)

    def __init__(
        self, stencils: EdgeStencils, law: SheetLaw, *, material_direction: float = 0.0
    ) -> None:
        self.law = law
        c, s = np.cos(material_direction), np.sin(material_direction)
        corners = stencils.corners @ np.array([[c, -s], [s, c]])  # in the material's axes
        self.gradients, areas = triangle_gradients(corners)
        # nu_i l_i = -2 A grad N_k, k the vertex across edge i.
        outward = -2.0 * areas[:, None, None] * np.roll(self.gradients, -2, axis=1)
        lengths = np.linalg.norm(outward, axis=2)
        products = np.stack([outward[..., i] * outward[..., j] for i, j in _PAIRS], axis=-1)
        self.shapes = np.ascontiguousarray(products / (lengths * areas[:, None])[..., None])
        self.vectors = np.ascontiguousarray(stencils.vectors, dtype=np.int64)
        self.shares = np.ascontiguousarray(stencils.shares, dtype=float)
        self.signs = np.ascontiguousarray(stencils.signs, dtype=float)
        self.points = stencils.corners.mean(axis=1)[:, None]
        self._areas, self.weights = areas, areas[:, None]

    def _arguments(self, y: FloatArray) -> tuple:
        return (y, self.vectors, self.gradients, self.shapes, self.shares, self.signs)

    def _flat_states(self, y: FloatArray) -> FloatArray:
        states = np.empty((len(self.vectors), 6))
        if not _states(*self._arguments(y), states):
            states[:] = np.nan
        return states

    def set_edge_angles(self, y: FloatArray, normals: FloatArray) -> None:
        """Set the edge angles in y so that edges have given normals, (n, 3, 3); none without.

        The turn of a side is from its face's normal to the edge's, about the edge and positive
        where the sheet rises outward; xi is the mean of s phi over an edge's sides, since theta/2
        is the same on both.
        """
        if self.vectors.shape[1] != 9:
            return
        corners = y[self.vectors[:, :3]]
        spans = np.roll(corners, -1, axis=1) - corners
        faces = np.cross(spans[:, 0], spans[:, 1])
        faces /= np.linalg.norm(faces, axis=1, keepdims=True)
        outward = np.cross(spans, faces[:, None])
        outward /= np.linalg.norm(outward, axis=2, keepdims=True)
        rise = -np.sum(normals * outward, axis=2)
        turns = np.arctan2(rise, np.einsum("nic,nc->ni", normals, faces))
        rows, own = self.vectors[:, 6:], self.signs != 0.0
        sums, counts = np.zeros(len(y)), np.zeros(len(y))
        np.add.at(sums, rows[own], (self.signs * turns)[own])
        np.add.at(counts, rows[own], 1.0)
        turning = counts > 0.0
        y[turning, 0] = sums[turning] / counts[turning]

    def states(self, y: FloatArray) -> FloatArray:
        """(n, 1, 6) strain e and shape operator b [mm-1] in the material's axes; nan throughout
        where a triangle is degenerate or a turn reaches pi."""
        return self._flat_states(y)[:, None]

    def area_shares(self, n_rows: int) -> FloatArray:
        """(n_rows,) weights of rows in the integral of a field over the rest area, mm2."""
        out = np.zeros(n_rows)
        np.add.at(out, self.vectors[:, :3], self.weights / 3.0)
        return out

    def energy_parts(self, y: FloatArray) -> FloatArray:
        """(1,) N mm; infinite where a triangle is degenerate or a turn reaches pi."""
        states = self._flat_states(y)
        if np.isnan(states[0, 0]):
            return np.array([np.inf])
        return np.array([self._areas @ self.law.energies(states)])

    def add_gradient(self, y: FloatArray, gradient: FloatArray) -> None:
        """Add dE/dy [N, or N mm for edge angles] to `gradient (n_y, 3)`."""
        grads = self.law.gradients(self._flat_states(y))
        _gradient(*self._arguments(y), self._areas, grads, gradient)

    def hessian_chunks(self, y: FloatArray) -> Iterator[tuple[slice, FloatArray]]:
        """Blocks of d2E/dy2 of some elements at a time, (m, 45 or 21, 3, 3), in memory that is
        reused."""
        states, k = self._flat_states(y), self.vectors.shape[1]
        n, size = len(states), min(CHUNK, len(states))
        blocks = np.empty((size, k * (k + 1) // 2, 3, 3))
        for start in range(0, n, size):
            part = slice(start, min(start + size, n))
            grads, hessians = self.law.derivatives(states[part])
            arguments = (array[part] for array in self._arguments(y)[1:])
            _hessian(y, *arguments, self._areas[part], grads, hessians, blocks)
            yield part, blocks[: len(grads)]

    def hessian_blocks(self, y: FloatArray) -> FloatArray:
        """(n, 45 or 21, 3, 3) blocks of d2E/dy2."""
        return np.concatenate([blocks.copy() for _, blocks in self.hessian_chunks(y)])

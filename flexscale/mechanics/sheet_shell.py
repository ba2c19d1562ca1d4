"""C1 sheet with any sheet law, flat or curved at rest.

Kinematics as in `shell_forms`. The maps from an element's twelve vectors to the derivatives at a
point are turned once into the rest state's orthonormal frame there: with the rest form a0 = L L^T,
the frame F = L^-T R (R turns to the axes of the material) has F^T a0 F = I, and derivatives become

    x_s = F^T x_u,      x_ss = F^T x_uu F,      rest area = sqrt(det a0) du dv.

A law then sees e = a - I and b - b0 in that frame, whatever the parameters (u, v) of the rest
surface are; of a flat sheet F = R and b0 = 0.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numba import njit

from flexscale.arrays import FloatArray, IntArray
from flexscale.mechanics.hct import N_DOFS, QUADRATURE_POINTS, hct_derivatives, hct_ordinates
from flexscale.mechanics.sheet_law import SheetLaw
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

CHUNK = 512  # elements whose Hessians are in memory at a time


@njit(cache=True)
def _states(y, vectors, derivatives, rest_b, out):
    """Fill out (n, q, 6) with (e, b - b0); False where the sheet is degenerate."""
    v, local = np.empty((out.shape[1], 5, 3)), np.empty((12, 3))
    normal, dual, e, b = np.empty(3), np.empty((2, 3)), np.empty(3), np.empty(3)
    for t in range(out.shape[0]):
        point_vectors(y, vectors[t], derivatives[t], local, v)
        for q in range(out.shape[1]):
            if not forms(v[q], normal, dual, e, b) > 0.0:
                return False
            for i in range(3):
                out[t, q, i] = e[i]
                out[t, q, 3 + i] = b[i] - rest_b[t, q, i]
    return True


@njit(cache=True)
def _gradient(y, vectors, derivatives, weights, grads, out):
    n_points = weights.shape[1]
    v, p, local = np.empty((n_points, 5, 3)), np.empty((n_points, 5, 3)), np.empty((12, 3))
    normal, dual, christoffel = np.empty(3), np.empty((2, 3)), np.empty((3, 2))
    e, b = np.empty(3), np.empty(3)
    for t in range(len(vectors)):
        point_vectors(y, vectors[t], derivatives[t], local, v)
        for q in range(n_points):
            forms(v[q], normal, dual, e, b)
            christoffel_symbols(v[q], dual, christoffel)
            vector_gradient(v[q], normal, christoffel, grads[t, q], weights[t, q], p[q])
        add_element_forces(derivatives[t], p, vectors[t], local, out)


@njit(cache=True)
def _hessian(y, vectors, derivatives, weights, grads, hessians, out):
    n_points = weights.shape[1]
    v, local = np.empty((n_points, 5, 3)), np.empty((12, 3))
    normal, dual, christoffel = np.empty(3), np.empty((2, 3)), np.empty((3, 2))
    e, b, h = np.empty(3), np.empty(3), np.empty((5, 5, 6))
    half, work = np.empty((n_points, 5, 6, 12)), np.empty((9, 3))
    for t in range(len(vectors)):
        point_vectors(y, vectors[t], derivatives[t], local, v)
        for q in range(n_points):
            forms(v[q], normal, dual, e, b)
            christoffel_symbols(v[q], dual, christoffel)
            vector_hessian(v[q], normal, dual, b, grads[t, q], hessians[t, q], christoffel, h, work)
            fill_point(derivatives[t, q], weights[t, q], h, half[q])
        points = derivatives[t].reshape(5 * n_points, 12)
        store_blocks(points, half.reshape(5 * n_points, 72), out[t])


class SheetShell:
    """Energy of a sheet with a sheet law on C1 triangles.

    Parameters
    ----------
    corners : (n, 3, 2) parameters (u, v) of the triangles' corners.
    edge_normals : (n, 3, 2) unit directions of the mid-edge derivatives.
    vectors : (n, 12) rows of `y`: (x, x_1, x_2) at the vertices, x_n at edges 0-1, 1-2, 2-0.
    law : energy per rest area.
    rest : (n_y, 3) rows at rest.
    vertex_frames : (n, 3, 2, 2) directions 1, 2 of the derivatives at each corner, as rows; u and v
        without.
    material_direction : rad, from the direction of u to the material's first axis.

    Attributes
    ----------
    points : (n, q, 2) parameters of the quadrature points.
    weights : (n, q) rest areas, mm2.
    """

    part_names: tuple[str, ...] = ("sheet",)

    def __init__(
        self,
        corners: FloatArray,
        edge_normals: FloatArray,
        vectors: IntArray,
        law: SheetLaw,
        rest: FloatArray,
        *,
        vertex_frames: FloatArray | None = None,
        material_direction: float = 0.0,
    ) -> None:
        self.law = law
        self.vectors = np.ascontiguousarray(vectors, dtype=np.int64)
        n, n_points = len(corners), 3 * len(QUADRATURE_POINTS)
        self.derivatives = np.empty((n, n_points, 5, N_DOFS))
        self.weights, self._shares = np.empty((n, n_points)), np.empty((n, N_DOFS))
        self._rest_b = np.zeros((n, n_points, 3))
        for start in range(0, n, CHUNK):
            part = slice(start, start + CHUNK)
            frames = None if vertex_frames is None else vertex_frames[part]
            maps, areas = hct_derivatives(corners[part], edge_normals[part])
            maps = _in_vertex_frames(maps, frames)
            states = _states_of(rest, self.vectors[part], maps, self._rest_b[part])
            rest_frames, density = _rest_frames(states, material_direction)
            self.derivatives[part] = _turned(maps, rest_frames)
            self.weights[part] = areas * density
            self._shares[part] = _integrals(corners[part], edge_normals[part], frames)
        self._rest_b = np.ascontiguousarray(self.states(rest)[..., 3:])
        self.points = _quadrature_points(corners)

    def states(self, y: FloatArray) -> FloatArray:
        """(n, q, 6) strain e and curvature b - b0 [mm-1] in the material's axes; nan throughout
        where the sheet is degenerate."""
        return _states_of(y, self.vectors, self.derivatives, self._rest_b)

    def area_shares(self, n_rows: int) -> FloatArray:
        """(n_rows,) weights of rows in the integral of a field over the parameters, mm2 if the
        sheet is flat at rest."""
        out = np.zeros(n_rows)
        np.add.at(out, self.vectors, self._shares)
        return out

    def energy_parts(self, y: FloatArray) -> FloatArray:
        """(1,) N mm; infinite where the sheet is degenerate."""
        states = self.states(y)
        if np.isnan(states[0, 0, 0]):
            return np.array([np.inf])
        return np.array([self.weights.ravel() @ self.law.energies(states.reshape(-1, 6))])

    def add_gradient(self, y: FloatArray, gradient: FloatArray) -> None:
        """Add dE/dy to `gradient (n_y, 3)`."""
        states = self.states(y)
        grads = self.law.gradients(states.reshape(-1, 6)).reshape(states.shape)
        _gradient(y, self.vectors, self.derivatives, self.weights, grads, gradient)

    def hessian_chunks(self, y: FloatArray) -> Iterator[tuple[slice, FloatArray]]:
        """Blocks of d2E/dy2 of some elements at a time, (m, 78, 3, 3), in memory that is reused."""
        states = self.states(y)
        n, size = len(states), min(CHUNK, len(states))
        blocks = np.empty((size, N_DOFS * (N_DOFS + 1) // 2, 3, 3))
        for start in range(0, n, size):
            part = slice(start, min(start + size, n))
            found = states[part]
            grads, hessians = self.law.derivatives(found.reshape(-1, 6))
            _hessian(
                y, self.vectors[part], self.derivatives[part], self.weights[part],
                grads.reshape(found.shape), hessians.reshape(*found.shape, 6), blocks,
            )  # fmt: skip
            yield part, blocks[: len(found)]

    def hessian_blocks(self, y: FloatArray) -> FloatArray:
        """(n, 78, 3, 3) blocks of d2E/dy2."""
        return np.concatenate([blocks.copy() for _, blocks in self.hessian_chunks(y)])


def _states_of(
    y: FloatArray, vectors: IntArray, derivatives: FloatArray, rest_b: FloatArray
) -> FloatArray:
    """(n, q, 6), nan throughout where the sheet is degenerate."""
    states = np.empty((*derivatives.shape[:2], 6))
    if not _states(y, vectors, derivatives, rest_b, states):
        states[:] = np.nan
    return states


def _in_vertex_frames(maps: FloatArray, frames: FloatArray | None) -> FloatArray:
    """Maps (n, ..., 12) of derivatives along the frames' directions, from those along u and v."""
    if frames is None:
        return maps
    inverse = np.linalg.inv(frames)
    out = maps.copy()
    for k in range(3):
        columns = slice(3 * k + 1, 3 * k + 3)
        out[..., columns] = np.einsum("n...d,nde->n...e", maps[..., columns], inverse[:, k])
    return out


def _integrals(
    corners: FloatArray, edge_normals: FloatArray, frames: FloatArray | None
) -> FloatArray:
    """(n, 12) weights of the twelve vectors in the integral over a triangle: of a cubic it is the
    area times the mean of its ten ordinates, and the three sub-triangles are equal in area."""
    area = 0.5 * np.linalg.det(corners[:, 1:] - corners[:, :1])
    sums = hct_ordinates(corners, edge_normals).sum(axis=(1, 2, 3, 4))
    return _in_vertex_frames(area[:, None] / 30.0 * sums, frames)


def _rest_frames(states: FloatArray, direction: float) -> tuple[FloatArray, FloatArray]:
    """Frames F (n, q, 2, 2), columns f_1 and f_2, and sqrt(det a0) (n, q)."""
    a11, a12, a22 = 1.0 + states[..., 0], states[..., 1], 1.0 + states[..., 2]
    density = np.sqrt(a11 * a22 - a12**2)
    frames = np.zeros((*density.shape, 2, 2))
    frames[..., 0, 0] = 1.0 / np.sqrt(a11)
    frames[..., 0, 1] = -a12 / (np.sqrt(a11) * density)
    frames[..., 1, 1] = np.sqrt(a11) / density
    c, s = np.cos(direction), np.sin(direction)
    return frames @ np.array([[c, -s], [s, c]]), density


def _turned(derivatives: FloatArray, frames: FloatArray) -> FloatArray:
    """Maps to (f_1, f_2, f_11, f_12, f_22) in the frames, from those in (u, v)."""
    second = derivatives[:, :, [[2, 3], [3, 4]]]
    out = np.empty_like(derivatives)
    out[:, :, :2] = np.einsum("nqud,nqus->nqsd", derivatives[:, :, :2], frames, optimize=True)
    turned = np.einsum("nquvd,nqus,nqvt->nqstd", second, frames, frames, optimize=True)
    out[:, :, 2], out[:, :, 3], out[:, :, 4] = (
        turned[:, :, i, j] for i, j in ((0, 0), (0, 1), (1, 1))
    )
    return out


def _quadrature_points(corners: FloatArray) -> FloatArray:
    centroid = corners.mean(axis=1)
    thirds = [
        np.stack([corners[:, k], corners[:, (k + 1) % 3], centroid], axis=1) for k in range(3)
    ]
    return np.concatenate([QUADRATURE_POINTS @ third for third in thirds], axis=1)

"""The paper's macro element with any sheet law: linear triangles and per-triangle shape operators.

Derivation: `sheet_triangle_kernels`. The sheet is flat at rest, and b is the turn per rest length.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.mechanics.constant_strain import triangle_gradients
from flexscale.mechanics.edge_angles import EdgeStencils
from flexscale.mechanics.sheet_law import SheetLaw
from flexscale.mechanics.sheet_shell import CHUNK
from flexscale.mechanics.sheet_triangle_kernels import (
    triangle_gradient,
    triangle_hessian,
    triangle_states,
)

_PAIRS = ((0, 0), (0, 1), (1, 1))


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
        if not triangle_states(*self._arguments(y), states):
            states[:] = np.nan
        return states

    def set_edge_angles(self, y: FloatArray, normals: FloatArray) -> None:
        """Set the edge angles in y so that edges have given normals, (n, 3, 3).

        The turn of a side is from its face's normal to the edge's, about the edge and positive
        where the sheet rises outward; xi is the mean of s phi over an edge's sides, since theta/2
        is the same on both.
        """
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
        triangle_gradient(*self._arguments(y), self._areas, grads, gradient)

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
            triangle_hessian(y, *arguments, self._areas[part], grads, hessians, blocks)
            yield part, blocks[: len(grads)]

    def hessian_blocks(self, y: FloatArray) -> FloatArray:
        """(n, 45 or 21, 3, 3) blocks of d2E/dy2."""
        return np.concatenate([blocks.copy() for _, blocks in self.hessian_chunks(y)])

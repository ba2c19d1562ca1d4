"""How points on the sheet under a scale follow the scale's base.

A sheet tied to an elastic base along a line loads that line with forces and couples, and under
these an elastic body sinks in the deeper the finer its mesh, without limit. A real bond spreads
them over about the sheet's thickness. So a point p follows the affine motion X0 + G (q - p) that
fits the base best over the part of it within a radius b of p, in least squares with weight
(1 - r^2/b^2)^2, r = |q - p|. For b -> 0 this is the base's position and gradient at p.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexscale.arrays import FloatArray, IntArray
from flexscale.errors import MeshError
from flexscale.mesh.patches import fit_affine, quadratic_values
from flexscale.mesh.periodic_mesh import PeriodicMesh
from flexscale.simplices import TRIANGLE_EDGES

TOLERANCE = 1e-7  # in barycentric coordinates: a point this far outside still is on the triangle

_Row = tuple[IntArray, FloatArray, FloatArray]


@dataclass(frozen=True)
class Bonds:
    """Weights of scale vertices at points of the scales' bases, row by row (CSR).

    A quantity u on scale vertices has at point i the value sum_k values[k] u[scale_vertices[k]]
    and the in-plane gradient sum_k gradients[k] u[scale_vertices[k]], k from indptr[i] to
    indptr[i + 1].

    Attributes
    ----------
    indptr : (n_points + 1,)
    scale_vertices : (nnz,) vertices at z = 0.
    values : (nnz,) they add up to 1 at each point.
    gradients : (nnz, 2) mm⁻¹, they add up to 0 at each point.
    """

    indptr: IntArray
    scale_vertices: IntArray
    values: FloatArray
    gradients: FloatArray


def build_bonds(
    mesh: PeriodicMesh, points: FloatArray, scales: NDArray[np.integer], radius: ArrayLike = 0.0
) -> Bonds:
    """Bond points to the bases of the scales above them.

    Both rules are as symmetric as the triangulation of the base, and exact for affine motions.

    Parameters
    ----------
    points : (n, 2) rest positions at the scales' home places (lattice offset 0), mm.
    scales : (n,) scale above each point.
    radius : () or (n,) mm, of the part of the base that a point follows; 0 for the base's position
        and gradient at the point itself, the mean over the base triangles that meet there.

    Raises
    ------
    MeshError : a point does not lie under its scale.
    """
    points = np.asarray(points, dtype=float)
    bases = {int(scale): _Base(mesh, int(scale)) for scale in np.unique(scales)}
    rows: list[_Row] = []
    for point, scale, reach in zip(
        points, scales, np.broadcast_to(radius, len(points)), strict=True
    ):
        row = bases[int(scale)].row_at(point)
        if row is None:
            raise MeshError(
                f"The point ({point[0]:.6g}, {point[1]:.6g}) mm does not lie under scale {scale}."
            )
        rows.append(bases[int(scale)].row_around(point, float(reach)) if reach > 0.0 else row)
    indptr = np.concatenate([[0], np.cumsum([len(row[0]) for row in rows], dtype=np.int64)])
    if not rows:
        return Bonds(indptr, np.zeros(0, np.int64), np.zeros(0), np.zeros((0, 2)))
    vertices, values, gradients = (np.concatenate(parts) for parts in zip(*rows, strict=True))
    return Bonds(indptr, vertices, values, gradients)


class _Base:
    """The base of one scale: rows of weights at, and around, its points."""

    def __init__(self, mesh: PeriodicMesh, scale: int) -> None:
        self.triangles = mesh.base_triangles[mesh.base_scale == scale]
        self.corners = mesh.scale_positions[self.triangles[:, :3], :2]
        self.slopes = _barycentric_gradients(self.corners)
        self.quadratic = self.triangles.shape[1] == 6

    def row_at(self, point: FloatArray) -> _Row | None:
        """Position and gradient at a point, the mean over the triangles there; None outside."""
        shares = np.einsum("tkd,td->tk", self.slopes, point - self.corners[:, 0])
        shares[:, 0] += 1.0
        inside = shares.min(axis=1, initial=np.inf) > -TOLERANCE
        if not inside.any():
            return None
        values, gradients = shares[inside], self.slopes[inside]
        if self.quadratic:
            gradients = _quadratic_gradients(values, gradients)
            values = quadratic_values(values)
        forms = np.concatenate([values[..., None], gradients], axis=2) / np.count_nonzero(inside)
        return _merge_row(self.triangles[inside], forms)

    def row_around(self, point: FloatArray, radius: float) -> _Row:
        """The affine motion (X0, G) that fits the base best within `radius` of a point."""
        middles = self.corners.mean(axis=1)
        extents = np.linalg.norm(self.corners - middles[:, None], axis=2).max(axis=1)
        near = np.linalg.norm(middles - point, axis=1) < radius + extents
        arms = self.corners[near] - point
        forms = fit_affine(arms, np.zeros(len(arms), dtype=np.int64), radius, self.quadratic)
        return _merge_row(self.triangles[near], forms)


def _barycentric_gradients(corners: FloatArray) -> FloatArray:
    """Gradients (n, 3, 2) of the barycentric coordinates of triangles (n, 3, 2)."""
    opposite = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    double = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    return np.stack([-opposite[..., 1], opposite[..., 0]], axis=-1) / double[:, None, None]


def _quadratic_gradients(shares: FloatArray, slopes: FloatArray) -> FloatArray:
    """Their gradients (n, 6, 2); `slopes` (n, 3, 2) are those of the barycentric coordinates."""
    start, end = np.transpose(TRIANGLE_EDGES)
    middle = shares[:, start, None] * slopes[:, end] + shares[:, end, None] * slopes[:, start]
    return np.concatenate([(4.0 * shares - 1.0)[..., None] * slopes, 4.0 * middle], axis=1)


def _merge_row(triangles: IntArray, forms: FloatArray) -> _Row:
    """Sum of the triangles' (n, k, 3) weights for value and gradient, one entry per vertex."""
    vertices, slot = np.unique(triangles, return_inverse=True)
    merged = np.zeros((len(vertices), 3))
    np.add.at(merged, slot.ravel(), forms.reshape(-1, 3))
    return vertices, merged[:, 0], merged[:, 1:]

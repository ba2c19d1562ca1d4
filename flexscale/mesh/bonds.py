"""How points on the sheet under a scale follow the scale's base."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexscale.errors import MeshError
from flexscale.mesh.periodic_mesh import FloatArray, IntArray, PeriodicMesh

TOLERANCE = 1e-7  # in barycentric coordinates: a point this far outside still is on the triangle


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
    gradients : (nnz, 2) mm⁻¹, they add up to 0. Where triangles meet, their mean.
    """

    indptr: IntArray
    scale_vertices: IntArray
    values: FloatArray
    gradients: FloatArray


def build_bonds(mesh: PeriodicMesh, points: FloatArray, scales: NDArray[np.integer]) -> Bonds:
    """Bond points to the bases of the scales above them.

    Equal weights for all base triangles that contain a point keep the bond as symmetric as the
    triangulation.

    Parameters
    ----------
    points : (n, 2) rest positions at the scales' home places (lattice offset 0), mm.
    scales : (n,) scale above each point.

    Raises
    ------
    MeshError : a point does not lie under its scale.
    """
    corners = mesh.scale_positions[mesh.base_triangles, :2]
    gradients = _shape_gradients(corners)
    rows: list[tuple[IntArray, FloatArray, FloatArray]] = []
    for point, scale in zip(np.asarray(points, dtype=float), scales, strict=True):
        own = np.flatnonzero(mesh.base_scale == scale)
        arms = point - corners[own, 0]
        shares = np.einsum("tkd,td->tk", gradients[own], arms)
        shares[:, 0] += 1.0
        inside = shares.min(axis=1, initial=np.inf) > -TOLERANCE
        if not inside.any():
            raise MeshError(
                f"The point ({point[0]:.6g}, {point[1]:.6g}) mm does not lie under scale {scale}."
            )
        rows.append(
            _merge_row(mesh.base_triangles[own[inside]], shares[inside], gradients[own[inside]])
        )
    indptr = np.concatenate([[0], np.cumsum([len(row[0]) for row in rows], dtype=np.int64)])
    if not rows:
        return Bonds(indptr, np.zeros(0, np.int64), np.zeros(0), np.zeros((0, 2)))
    vertices, values, slopes = (np.concatenate(parts) for parts in zip(*rows, strict=True))
    return Bonds(indptr, vertices, values, slopes)


def _shape_gradients(corners: FloatArray) -> FloatArray:
    """Gradients (n, 3, 2) of the barycentric coordinates of triangles (n, 3, 2)."""
    opposite = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    double = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    return np.stack([-opposite[..., 1], opposite[..., 0]], axis=-1) / double[:, None, None]


def _merge_row(
    triangles: IntArray, shares: FloatArray, gradients: FloatArray
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Mean over triangles, one entry per vertex."""
    vertices, slot = np.unique(triangles, return_inverse=True)
    slot = slot.ravel()
    n = len(vertices)
    slopes = gradients.reshape(-1, 2)
    return (
        vertices,
        np.bincount(slot, shares.ravel(), n) / len(triangles),
        np.stack([np.bincount(slot, slopes[:, k], n) for k in (0, 1)], axis=1) / len(triangles),
    )

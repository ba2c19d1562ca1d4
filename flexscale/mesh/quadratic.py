"""Quadratic scales: nodes in the middle of every edge, so that tets bend without locking."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexscale.arrays import IntArray
from flexscale.mesh.periodic_mesh import PeriodicMesh
from flexscale.simplices import TET_EDGES, TRIANGLE_EDGES


def elevate_scales(mesh: PeriodicMesh) -> PeriodicMesh:
    """Linear tets and base triangles made quadratic; each surface triangle becomes four."""
    pairs = np.sort(mesh.tets[:, TET_EDGES].reshape(-1, 2), axis=1)
    keys = np.unique(pairs[:, 0] * mesh.n_scale_vertices + pairs[:, 1])
    first, second = keys // mesh.n_scale_vertices, keys % mesh.n_scale_vertices
    middles = 0.5 * (mesh.scale_positions[first] + mesh.scale_positions[second])

    def middle(corners: IntArray, edges: tuple[tuple[int, int], ...]) -> IntArray:
        ends = np.sort(corners[:, edges], axis=-1)
        found = np.searchsorted(keys, ends[..., 0] * mesh.n_scale_vertices + ends[..., 1])
        return mesh.n_scale_vertices + found

    a, b, c = mesh.surface_triangles.T
    ab, bc, ca = middle(mesh.surface_triangles, TRIANGLE_EDGES).T
    quarters = np.array([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]])
    return replace(
        mesh,
        scale_positions=np.concatenate([mesh.scale_positions, middles]),
        tets=np.concatenate([mesh.tets, middle(mesh.tets, TET_EDGES)], axis=1),
        base_triangles=np.concatenate(
            [mesh.base_triangles, middle(mesh.base_triangles, TRIANGLE_EDGES)], axis=1
        ),
        surface_triangles=quarters.transpose(2, 0, 1).reshape(-1, 3),
        surface_scale=np.repeat(mesh.surface_scale, 4),
    )

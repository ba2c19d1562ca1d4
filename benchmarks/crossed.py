"""A cell's mesh with its gaps' quadrilaterals cut along both diagonals, not one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexscale.mesh.periodic_mesh import FREE, GAP_EDGE, PeriodicMesh
from flexscale.mesh.topology import build_edges


def cross_gaps(mesh: PeriodicMesh) -> PeriodicMesh:
    """Put a vertex on every gap edge that is the longest of both its triangles.

    Between the rows of a strip these are the diagonals: each quadrilateral there becomes four
    triangles that meet in its middle.
    """
    spans = mesh.positions[mesh.edges[:, 1]] + mesh.edge_shift @ mesh.lattice
    spans -= mesh.positions[mesh.edges[:, 0]]
    lengths = np.linalg.norm(spans, axis=1)
    # Longest by more than rounding, so that equal sides of a triangle are never both cut.
    longest = lengths[mesh.triangle_edges] > lengths[mesh.triangle_edges].max(1)[:, None] - 1e-9
    unique = longest & (longest.sum(axis=1) == 1)[:, None]
    votes = np.bincount(mesh.triangle_edges[unique], minlength=mesh.n_edges)
    cut = np.flatnonzero((votes == 2) & (mesh.edge_scale == GAP_EDGE))
    middle = np.full(mesh.n_edges, -1)
    middle[cut] = mesh.n_vertices + np.arange(len(cut))

    whole = ~np.isin(mesh.triangle_edges, cut).any(axis=1)
    corners, offsets = [mesh.triangles[whole]], [mesh.triangle_offsets[whole]]
    scales = [mesh.triangle_scale[whole]]
    for i in range(3):
        halved = np.isin(mesh.triangle_edges[:, i], cut)
        new = middle[mesh.triangle_edges[halved, i]]
        new_offset = mesh.triangle_edge_offsets[halved, i]
        for replaced in (i, (i + 1) % 3):
            half, half_offset = mesh.triangles[halved], mesh.triangle_offsets[halved]
            half[:, replaced], half_offset[:, replaced] = new, new_offset
            corners.append(half)
            offsets.append(half_offset)
            scales.append(mesh.triangle_scale[halved])
    triangles, triangle_offsets = np.concatenate(corners), np.concatenate(offsets)
    topology = build_edges(triangles, triangle_offsets)
    old_keys = _keys(mesh.edges, mesh.edge_shift)
    known = dict(zip(old_keys, mesh.edge_scale.tolist(), strict=True))
    keys = _keys(topology.edges, topology.edge_shift)
    n = len(cut)
    return replace(
        mesh,
        positions=np.concatenate(
            [mesh.positions, mesh.positions[mesh.edges[cut, 0]] + 0.5 * spans[cut]]
        ),
        triangles=triangles,
        triangle_offsets=triangle_offsets,
        triangle_scale=np.concatenate(scales),
        vertex_scale=np.append(mesh.vertex_scale, np.full(n, -1)),
        vertex_kind=np.append(mesh.vertex_kind, np.full(n, FREE, dtype=np.int8)),
        outline_tangent=np.concatenate([mesh.outline_tangent, np.zeros((n, 2))]),
        edges=topology.edges,
        edge_shift=topology.edge_shift,
        triangle_edges=topology.triangle_edges,
        triangle_edge_offsets=topology.triangle_edge_offsets,
        edge_scale=np.array([known.get(key, GAP_EDGE) for key in keys]),
    )


def _keys(edges: np.ndarray, shifts: np.ndarray) -> list[tuple[int, ...]]:
    return list(map(tuple, np.column_stack([edges, shifts]).tolist()))

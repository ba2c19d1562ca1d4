"""A plain sheet without scales, as a torus, for comparison with plate theory."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from flexscale.mesh.periodic_mesh import FREE, GAP_EDGE, PeriodicMesh
from flexscale.mesh.topology import build_edges
from flexscale.units import require_positive


def build_bare_mesh(lattice: ArrayLike, size: float) -> PeriodicMesh:
    """Parallelograms of about `size`, each crossed into four triangles.

    Parameters
    ----------
    lattice : (2, 2) rows t1, t2, right-handed, mm.
    size : mm, longest side of a parallelogram.
    """
    rows = np.array(lattice, dtype=float)
    size = require_positive(size, "element size", "mm")
    n1, n2 = (max(1, int(np.ceil(np.linalg.norm(row) / size - 1e-9))) for row in rows)
    i, j = np.mgrid[:n1, :n2].reshape(2, -1)
    n_cells = n1 * n2
    fractions = np.concatenate([np.stack([i, j], 1), np.stack([i, j], 1) + 0.5]) / (n1, n2)
    around = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
    ci, cj = i[:, None] + around[:, 0], j[:, None] + around[:, 1]
    corner = (ci % n1) * n2 + cj % n2
    offset = np.stack([ci // n1, cj // n2], axis=-1)
    middle = n_cells + np.arange(n_cells)
    triangles, offsets = [], []
    for k in range(4):
        m = (k + 1) % 4
        triangles.append(np.stack([corner[:, k], corner[:, m], middle], axis=1))
        offsets.append(np.stack([offset[:, k], offset[:, m], np.zeros_like(offset[:, k])], axis=1))
    cells, cell_offsets = np.concatenate(triangles), np.concatenate(offsets)
    topology = build_edges(cells, cell_offsets)
    none = np.zeros((0, 3), dtype=np.int64)
    nothing = np.zeros(0, dtype=np.int64)
    n_vertices = 2 * n_cells
    return PeriodicMesh(
        lattice=rows,
        positions=fractions @ rows,
        triangles=cells,
        triangle_offsets=cell_offsets,
        triangle_scale=np.full(len(cells), -1),
        vertex_scale=np.full(n_vertices, -1),
        vertex_kind=np.full(n_vertices, FREE, dtype=np.int8),
        outline_tangent=np.zeros((n_vertices, 2)),
        edges=topology.edges,
        edge_shift=topology.edge_shift,
        triangle_edges=topology.triangle_edges,
        triangle_edge_offsets=topology.triangle_edge_offsets,
        edge_scale=np.full(len(topology.edges), GAP_EDGE),
        scale_positions=np.zeros((0, 3)),
        tets=np.zeros((0, 4), dtype=np.int64),
        tet_scale=nothing,
        base_triangles=none,
        base_scale=nothing,
        surface_triangles=none,
        surface_scale=nothing,
        n_scales=0,
        scale_height=0.0,
    )

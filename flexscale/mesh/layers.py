"""Layers of wedges below a torus mesh: the substrate as a solid.

Every triangle of the sheet becomes a column of wedges with 18 nodes. The nodes are the vertices and
the middles of the edges of the torus mesh, repeated on levels: the upper face, the middle and the
lower face of every layer.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexscale.arrays import FloatArray, IntArray
from flexscale.mesh.periodic_mesh import COVERED, PeriodicMesh


@dataclass(frozen=True)
class Layers:
    """Nodes and wedges of a solid substrate; node k of the plane is k + n_plane l on level l.

    Attributes
    ----------
    plane : (n_plane, 2) rest places of the nodes of one level: vertices, then middles of edges, mm.
    plane_scale : (n_plane,) scale that carries the node on the upper face, -1 for none.
    plane_inner : (n_plane,) whether it lies strictly under that scale.
    heights : (n_levels,) of the levels, downward from the upper face, mm.
    triangles : (n_triangles, 6) nodes of the plane; offsets (n_triangles, 6, 2) their lattice
        offsets.
    corners : (n_triangles, 3, 2) rest places, mm.
    """

    plane: FloatArray
    plane_scale: IntArray
    plane_inner: np.ndarray
    heights: FloatArray
    triangles: IntArray
    offsets: IntArray
    corners: FloatArray

    @property
    def n_plane(self) -> int:
        """Nodes of one level."""
        return len(self.plane)

    @property
    def n_layers(self) -> int:
        """Wedges in each column."""
        return len(self.heights) // 2

    @property
    def n_unknowns(self) -> int:
        """Three of every node that is not bonded to a scale."""
        n_bonded = int(np.count_nonzero(self.plane_scale >= 0))
        return 3 * (self.n_plane * len(self.heights) - n_bonded)


def layer_levels(thickness: float, n_layers: int, growth: float) -> FloatArray:
    """Heights (2 n_layers + 1,) of the levels below the upper face, from 0 to -thickness, mm."""
    sizes = growth ** np.arange(n_layers)
    faces = np.concatenate([[0.0], np.cumsum(sizes)]) / sizes.sum()
    faces[-1] = 1.0
    levels = np.empty(2 * n_layers + 1)
    levels[::2] = faces
    levels[1::2] = 0.5 * (faces[1:] + faces[:-1])
    return -thickness * levels


def build_layers(mesh: PeriodicMesh, heights: FloatArray) -> Layers:
    """Nodes and wedges below a torus mesh, on levels of given heights (n_levels,), mm."""
    n = mesh.n_vertices
    spans = mesh.positions[mesh.edges[:, 1]] + mesh.edge_shift @ mesh.lattice
    middles = 0.5 * (mesh.positions[mesh.edges[:, 0]] + spans)
    # An edge between two covered vertices may span the gap: triangles tell what covers it.
    edge_scale = np.full(mesh.n_edges, -1)
    covered = mesh.triangle_scale >= 0
    edge_scale[mesh.triangle_edges[covered].ravel()] = np.repeat(mesh.triangle_scale[covered], 3)
    inner_edges = mesh.edge_scale < 0
    return Layers(
        plane=np.concatenate([mesh.positions, middles]),
        plane_scale=np.concatenate([mesh.vertex_scale, edge_scale]),
        plane_inner=np.concatenate([mesh.vertex_kind == COVERED, inner_edges & (edge_scale >= 0)]),
        heights=heights,
        triangles=np.concatenate([mesh.triangles, n + mesh.triangle_edges], axis=1),
        offsets=np.concatenate([mesh.triangle_offsets, mesh.triangle_edge_offsets], axis=1),
        corners=mesh.corner_positions(),
    )

"""The periodic cell whose substrate is a solid: wedges from the scales' bases downward.

Unknowns of the sheet, behind those of the scales: w of every node that is not bonded to a scale. w3
is counted from the sheet's middle surface at rest, t/2 below the bases, so that a curvature means
the same as for a shell. Nodes on the upper face under a scale are points of the scale's base.

The mean normal displacement is that of the scales' bases where these are bodies (their anchors lie
on the middle surface), and of the sheet's two faces where they are tets [Eq. 8].
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.cell import CellEmbedding
from flexscale.embedding.curvature_map import POSITION
from flexscale.embedding.rows import FREE_ROW, Rows
from flexscale.embedding.scale_nodes import PointNodes, ScaleNodes, TetNodes
from flexscale.mesh.bonds import build_bonds
from flexscale.mesh.layers import Layers
from flexscale.mesh.periodic_mesh import PeriodicMesh


@dataclass(frozen=True)
class WedgeRows:
    """Where the substrate's wedges find their nodes.

    Attributes
    ----------
    corners : (n, 3, 2) rest coordinates of their triangles, mm.
    upper, lower : (n,) rest heights of their faces, mm.
    vectors : (n, 18) rows of y in the order of `NeoHookeanWedges`.
    """

    corners: FloatArray
    upper: FloatArray
    lower: FloatArray
    vectors: IntArray


class SolidCell(CellEmbedding):
    """Unknowns of a cell whose sheet is made of wedges.

    Parameters
    ----------
    mesh : torus mesh of the upper face, and of the scales on it.
    layers : nodes and wedges below it.
    contact_edge, tets : see `CellEmbedding`.

    Attributes
    ----------
    layers : as given.
    node_unknown : (n_levels, n_plane) first unknown of each node, -1 where it is bonded.
    wedges : rows and geometry of the wedges.
    """

    wedges: WedgeRows

    def __init__(
        self,
        mesh: PeriodicMesh,
        layers: Layers,
        contact_edge: float | None = 0.0,
        tets: bool = True,
    ) -> None:
        self.layers = layers
        self._middle = 0.5 * layers.heights[-1]
        raised = mesh.scale_positions - [0.0, 0.0, self._middle]
        super().__init__(replace(mesh, scale_positions=raised), 0.0, contact_edge, tets)
        self.shift_mode[self.node_unknown[self.node_unknown >= 0] + 2] = 1.0

    def _bond(self, contact_edge: float | None, tets: bool) -> ScaleNodes:
        """Bond every node of the upper face under a scale to the point of the base above it."""
        mesh, layers = self.mesh, self.layers
        carried = np.flatnonzero(layers.plane_scale >= 0)  # vertices, then middles of edges
        points, scales = layers.plane[carried], layers.plane_scale[carried]
        self.bonds, self.bonded = build_bonds(mesh, points, scales), points
        self.plane_bond = np.full(layers.n_plane, -1, dtype=np.int64)
        self.plane_bond[carried] = np.arange(len(carried))
        self.vertex_bond = self.plane_bond[: mesh.n_vertices]
        self.edge_bond = self.plane_bond[mesh.n_vertices :]
        if tets or not mesh.n_scales:
            return TetNodes(mesh, self.bonds)
        every, none = np.full(len(points), True), np.full(len(points), False)
        return PointNodes(mesh, self.bonds, scales, every, none, contact_edge)

    def _number_sheet(self, start: int) -> int:
        layers = self.layers
        shape = (len(layers.heights), layers.n_plane)
        free = np.full(shape, True)
        free[0] = layers.plane_scale < 0
        self.node_unknown = np.full(shape, -1, dtype=np.int64)
        self.node_unknown[free] = start + 3 * np.arange(np.count_nonzero(free))
        self.vertex_node = self.node_unknown[0, : self.mesh.n_vertices]
        return start + 3 * int(np.count_nonzero(free))

    def _set_sheet_rest(self, rest: FloatArray) -> None:
        for unknown, height in zip(self.node_unknown, self.layers.heights, strict=True):
            free = unknown >= 0
            for c in range(2):
                rest[unknown[free] + c] = self.layers.plane[free, c]
            rest[unknown[free] + 2] = height - self._middle

    def _add_sheet(self, rows: Rows) -> None:
        layers = self.layers
        images = np.concatenate([layers.triangles[..., None], layers.offsets], axis=2)
        found, place = np.unique(images.reshape(-1, 3), axis=0, return_inverse=True)
        row_of = np.array([self._column_rows(rows, *image) for image in found.tolist()])
        columns = row_of[place.reshape(layers.triangles.shape)]  # (n_triangles, 6, n_levels)
        vectors = [
            np.concatenate([columns[:, :, 2 * k + j] for j in range(3)], axis=1)
            for k in range(layers.n_layers)
        ]
        n, faces = len(layers.triangles), layers.heights[::2]
        self.wedges = WedgeRows(
            corners=np.tile(layers.corners, (layers.n_layers, 1, 1)),
            upper=np.repeat(faces[:-1], n),
            lower=np.repeat(faces[1:], n),
            vectors=np.concatenate(vectors),
        )

    def _column_rows(self, rows: Rows, node: int, m: int, n: int) -> list[int]:
        """Rows (n_levels,) of a node of the plane and of those below it, in a lattice image."""
        shift = np.array([m, n]) @ self.mesh.lattice
        found = []
        for level, unknown in enumerate(self.node_unknown[:, node].tolist()):
            if unknown >= 0:
                image = rows.image(POSITION, unknown, shift, np.zeros(2))
                found.append(rows.add(("node", level, node, m, n), [image], FREE_ROW))
                continue
            terms, values = self.nodes.position(rows, int(self.plane_bond[node]), shift)
            weights = np.stack([values, np.zeros_like(values), np.zeros_like(values)], axis=1)
            found.append(rows.add(("node", level, node, m, n), terms, weights))
        return found

    def _build_mean_offset(self, tets: bool) -> FloatArray:
        weights = np.zeros(self.n_unknowns)
        if not tets:
            return weights
        half = 0.5 * self.vertex_shares()
        vertices = np.arange(self.mesh.n_vertices)
        weights[self.node_unknown[-1, vertices] + 2] += half
        free = self.vertex_node >= 0
        weights[self.vertex_node[free] + 2] += half[free]
        for vertex in vertices[~free]:
            bond = self.vertex_bond[vertex]
            part = slice(self.bonds.indptr[bond], self.bonds.indptr[bond + 1])
            weights[3 * self.bonds.scale_vertices[part] + 2] += (
                self.bonds.values[part] * half[vertex]
            )
        return weights

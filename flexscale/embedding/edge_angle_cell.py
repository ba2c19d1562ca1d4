"""The periodic cell with the paper's sheet: linear triangles in the gaps, bent by edge normals.

The sheet's unknowns, behind those of the scales:

- w of every free substrate vertex (3);
- the angle xi of every gap edge; it takes three places in z, of which two are held at 0.

Across an outline edge a gap triangle meets the triangle under the scale. A vertex of that triangle
follows the scale's base as it does elsewhere if it lies on the outline; one strictly under the
scale follows the affine motion that is fitted to the base around the middle of the edge, so that
both sides of the bond feel the base over the same radius. The normal of an outline edge is the one
of the triangle under the scale, which is bonded and does not bend.

PAPER: shape operators on all triangles, under scales also. WE: only where the sheet can bend. WHY:
what is bonded to a scale turns with it; a bending energy there would soften every hinge by the size
of its elements.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.cell import CellEmbedding
from flexscale.embedding.curvature_map import NUMBERS
from flexscale.embedding.rows import FREE_ROW, Rows
from flexscale.mechanics.edge_angles import EdgeStencils
from flexscale.mesh.periodic_mesh import COVERED, FREE, GAP_EDGE, PeriodicMesh


class EdgeAngleCell(CellEmbedding):
    """Unknowns of a cell whose sheet is made of linear triangles.

    Parameters
    ----------
    mesh, bond_radius, contact_edge, tets : see `CellEmbedding`.

    Attributes
    ----------
    n_gap : number of triangles in the gaps; they come first among the stencils.
    stencils : triangles that bend.
    """

    n_gap: int
    stencils: EdgeStencils
    _edges_have_position = True

    def __init__(
        self,
        mesh: PeriodicMesh,
        bond_radius: float = 0.0,
        contact_edge: float | None = 0.0,
        tets: bool = True,
    ) -> None:
        self._mate, self._sign = _mates(mesh)
        super().__init__(mesh, bond_radius, contact_edge, tets)

    def _number_sheet(self, start: int) -> int:
        mesh = self.mesh
        free = np.flatnonzero(mesh.vertex_kind == FREE)
        self.vertex_node = np.full(mesh.n_vertices, -1, dtype=np.int64)
        self.vertex_node[free] = start + 3 * np.arange(len(free))
        start += 3 * len(free)
        self.edge_node = np.full(mesh.n_edges, -1, dtype=np.int64)
        gap = np.flatnonzero(mesh.edge_scale == GAP_EDGE)
        self.edge_node[gap] = start + 3 * np.arange(len(gap))
        return start + 3 * len(gap)

    def _set_sheet_rest(self, rest: FloatArray) -> None:
        """Edge angles vanish at rest."""

    def _held_unknowns(self) -> IntArray:
        nodes = self.edge_node[self.edge_node >= 0]
        return np.concatenate([nodes + 1, nodes + 2])

    def _add_sheet(self, rows: Rows) -> None:
        mesh = self.mesh
        bending = np.flatnonzero(mesh.triangle_scale < 0)
        self.n_gap = len(bending)
        vectors = np.empty((len(bending), 9), dtype=np.int64)
        shares, signs = np.zeros((2, len(bending), 3))
        for e, triangle in enumerate(bending.tolist()):
            found = list(self._corner_rows(rows, triangle))
            for i in range(3):
                edge = int(mesh.triangle_edges[triangle, i])
                shares[e, i] = 1.0 if mesh.edge_scale[edge] >= 0 else 0.5
                row = self._across_row(rows, triangle, i)
                # Of three triangles around a vertex, each meets one vertex across two edges.
                found.append(rows.copy(row) if row in found else row)
            for i in range(3):
                edge = int(mesh.triangle_edges[triangle, i])
                signs[e, i] = self._sign[triangle, i] if self.edge_node[edge] >= 0 else 0.0
                found.append(self._angle_row(rows, edge) if signs[e, i] else found[i])
            vectors[e] = found
        corners = mesh.corner_positions()[bending]
        self.stencils = EdgeStencils(corners, vectors, shares, signs)

    def _corner_rows(self, rows: Rows, triangle: int) -> Iterator[int]:
        """Rows of a triangle's corners."""
        mesh = self.mesh
        for corner in range(3):
            vertex = int(mesh.triangles[triangle, corner])
            yield self._position_row(rows, vertex, mesh.triangle_offsets[triangle, corner])

    def _across_row(self, rows: Rows, triangle: int, i: int) -> int:
        """Row with the position of the vertex across edge i of a triangle."""
        mesh = self.mesh
        other, j = divmod(int(self._mate[triangle, i]), 3)
        offset = mesh.triangle_edge_offsets[triangle, i]
        return self._seen_row(rows, other, j, (j + 2) % 3, offset)

    def _seen_row(
        self, rows: Rows, triangle: int, j: int, corner: int, edge_offset: IntArray
    ) -> int:
        """Row of a triangle's corner, the triangle placed with its edge j at a lattice offset."""
        mesh = self.mesh
        vertex = int(mesh.triangles[triangle, corner])
        offset = mesh.triangle_offsets[triangle, corner] - mesh.triangle_edge_offsets[triangle, j]
        if mesh.vertex_kind[vertex] != COVERED:
            return self._position_row(rows, vertex, edge_offset + offset)
        edge = int(mesh.triangle_edges[triangle, j])
        key = ("under", edge, *edge_offset.tolist())
        if key in rows.row_of:
            return rows.row_of[key]
        shift = edge_offset @ mesh.lattice
        arm = mesh.positions[vertex] + offset @ mesh.lattice - self.edge_middle[edge]
        bond = int(self.edge_bond[edge])
        terms, values = self.nodes.position(rows, bond, shift)
        slope_terms, slopes = self.nodes.gradient(rows, bond, shift)
        if terms == slope_terms:
            weights = values + slopes @ arm
        else:
            terms, weights = [*terms, *slope_terms], np.concatenate([values, slopes @ arm])
        zero = np.zeros_like(weights)
        return rows.add(key, terms, np.stack([weights, zero, zero], axis=1))

    def _angle_row(self, rows: Rows, edge: int) -> int:
        """Row whose first component is xi of an edge, the same in all lattice images."""
        key = ("angle", edge)
        if key in rows.row_of:
            return rows.row_of[key]
        image = rows.image(NUMBERS, int(self.edge_node[edge]), np.zeros(2), np.zeros(2))
        return rows.add(key, [image], FREE_ROW)


def _mates(mesh: PeriodicMesh) -> tuple[IntArray, FloatArray]:
    """Of every side of a triangle (n_triangles, 3): 3 t + i of the other side of its edge, and +1
    on one of the two sides, -1 on the other."""
    order = np.argsort(mesh.triangle_edges.ravel(), kind="stable").reshape(-1, 2)
    mate, sign = np.empty(order.size, dtype=np.int64), np.empty(order.size)
    mate[order], mate[order[:, ::-1]] = order[:, ::-1], order
    sign[order] = [1.0, -1.0]
    return mate.reshape(-1, 3), sign.reshape(-1, 3)

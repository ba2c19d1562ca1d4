"""The periodic cell with the C1 sheet: Hsieh-Clough-Tocher triangles in the gaps.

The sheet's unknowns, behind those of the scales:

- of every free substrate vertex w, then the parameter gradients g_u, g_v in the cylinder's frame (9
numbers);
- of every free gap edge the gradient g_n across it (3);
- of every smooth outline vertex and outline edge p, q, the in-plane part of the derivative across
the outline (2).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.cell import CellEmbedding
from flexscale.embedding.curvature_map import GRADIENT
from flexscale.embedding.rows import FREE_ROW, Rows
from flexscale.mesh.periodic_mesh import FREE, GAP_EDGE, OUTLINE, OUTLINE_CORNER


@dataclass(frozen=True)
class ShellRows:
    """Where the substrate's elements find their world vectors.

    Attributes
    ----------
    corners : (n, 3, 2) rest coordinates of the gap triangles.
    edge_normals : (n, 3, 2) directions of the mid-edge derivatives.
    vectors : (n, 12) rows of y in the order of `hct`.
    """

    corners: FloatArray
    edge_normals: FloatArray
    vectors: IntArray


class C1Cell(CellEmbedding):
    """Unknowns of a cell whose sheet is made of C1 triangles.

    Attributes
    ----------
    shell : rows and geometry of the gap triangles.
    """

    shell: ShellRows

    def _number_sheet(self, start: int) -> int:
        mesh = self.mesh
        free = np.flatnonzero(mesh.vertex_kind == FREE)
        smooth = np.flatnonzero(mesh.vertex_kind == OUTLINE)
        gap = np.flatnonzero(mesh.edge_scale == GAP_EDGE)
        outline = np.flatnonzero(mesh.edge_scale >= 0)
        self.vertex_node = np.full(mesh.n_vertices, -1, dtype=np.int64)
        self.vertex_node[free] = start + 9 * np.arange(len(free))
        start += 9 * len(free)
        self.edge_node = np.full(mesh.n_edges, -1, dtype=np.int64)
        self.edge_node[gap] = start + 3 * np.arange(len(gap))
        start += 3 * len(gap)
        self.vertex_slide = np.full(mesh.n_vertices, -1, dtype=np.int64)
        self.vertex_slide[smooth] = start + 2 * np.arange(len(smooth))
        start += 2 * len(smooth)
        self.edge_slide = np.full(mesh.n_edges, -1, dtype=np.int64)
        self.edge_slide[outline] = start + 2 * np.arange(len(outline))
        self.edge_tangent = self.edge_span / np.linalg.norm(self.edge_span, axis=1, keepdims=True)
        self.edge_normal = _left_normal(self.edge_tangent)
        return start + 2 * len(outline)

    def _set_sheet_rest(self, rest: FloatArray) -> None:
        free = self.mesh.vertex_kind == FREE
        gap = self.mesh.edge_scale == GAP_EDGE
        for c in range(2):
            rest[self.vertex_node[free] + 3 + 4 * c] = 1.0
            rest[self.edge_node[gap] + c] = self.edge_normal[gap, c]
        rest[self.vertex_slide[self.vertex_slide >= 0]] = 1.0
        rest[self.edge_slide[self.edge_slide >= 0]] = 1.0

    def _add_sheet(self, rows: Rows) -> None:
        mesh = self.mesh
        gap = np.flatnonzero(mesh.triangle_scale < 0)
        vectors = np.empty((len(gap), 12), dtype=np.int64)
        for e, triangle in enumerate(gap):
            for corner in range(3):
                offset = mesh.triangle_offsets[triangle, corner]
                first = self._vertex_rows(rows, int(mesh.triangles[triangle, corner]), offset)
                vectors[e, 3 * corner : 3 * corner + 3] = first + np.arange(3)
                offset = mesh.triangle_edge_offsets[triangle, corner]
                edge = int(mesh.triangle_edges[triangle, corner])
                vectors[e, 9 + corner] = self._edge_row(rows, edge, offset)
        corners = mesh.corner_positions()[gap]
        normals = self.edge_normal[mesh.triangle_edges[gap]]
        self.shell = ShellRows(corners, normals, vectors)

    def _vertex_rows(self, rows: Rows, vertex: int, offset: IntArray) -> int:
        """First of the three rows (x, x_u, x_v) of a vertex image."""
        key = ("vertex", vertex, *offset.tolist())
        if key in rows.row_of:
            return rows.row_of[key]
        mesh = self.mesh
        shift, anchor = offset @ mesh.lattice, mesh.positions[vertex]
        first = self._position_row(rows, vertex, offset)
        if mesh.vertex_kind[vertex] == FREE:
            node = int(self.vertex_node[vertex])
            for k in (1, 2):
                rows.add((*key, k), [rows.image(GRADIENT, node + 3 * k, shift, anchor)], FREE_ROW)
            return first
        terms, slopes = self.nodes.gradient(rows, int(self.vertex_bond[vertex]), shift)
        zero = np.zeros(len(terms))
        for k in (0, 1):
            if mesh.vertex_kind[vertex] == OUTLINE_CORNER:
                weights, slide = np.stack([slopes[:, k], zero, zero], axis=1), -1
            else:
                tangent = mesh.outline_tangent[vertex]
                normal = _left_normal(tangent)
                along, across = slopes @ tangent, slopes @ normal
                weights = np.stack(
                    [tangent[k] * along, normal[k] * across, normal[k] * along], axis=1
                )
                slide = int(self.vertex_slide[vertex])
            rows.add((*key, k + 1), terms, weights, slide)
        return first

    def _edge_row(self, rows: Rows, edge: int, offset: IntArray) -> int:
        """Row x_n of an edge image."""
        key = ("edge", edge, *offset.tolist())
        if key in rows.row_of:
            return rows.row_of[key]
        shift = offset @ self.mesh.lattice
        if self.mesh.edge_scale[edge] == GAP_EDGE:
            image = rows.image(GRADIENT, int(self.edge_node[edge]), shift, self.edge_middle[edge])
            return rows.add(key, [image], FREE_ROW)
        terms, slopes = self.nodes.gradient(rows, int(self.edge_bond[edge]), shift)
        along, across = slopes @ self.edge_tangent[edge], slopes @ self.edge_normal[edge]
        weights = np.stack([np.zeros_like(along), across, along], axis=1)
        return rows.add(key, terms, weights, int(self.edge_slide[edge]))


def _left_normal(tangent: FloatArray) -> FloatArray:
    return np.stack([-tangent[..., 1], tangent[..., 0]], axis=-1)

"""The mesh of one translational cell, as a torus: sheet triangles and scale tets."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexscale.arrays import FloatArray, IntArray
from flexscale.errors import MeshError

Int8Array = NDArray[np.int8]

FREE, OUTLINE, OUTLINE_CORNER, COVERED = 0, 1, 2, 3  # values of `vertex_kind`
GAP_EDGE, COVERED_EDGE = -1, -2  # values of `edge_scale` besides scale numbers


@dataclass(frozen=True)
class PeriodicMesh:
    """Substrate and scales of one lattice cell at rest; lengths in mm.

    Attributes
    ----------
    lattice : (2, 2) rows t1, t2.
    positions : (n_vertices, 2) substrate vertices, one representative each.
    triangles : (n_triangles, 3) vertices, counterclockwise.
    triangle_offsets : (n_triangles, 3, 2) lattice offsets (m, n): a corner lies at
        positions[v] + m t1 + n t2.
    triangle_scale : (n_triangles,) scale that covers the triangle, -1 in the gap.
    vertex_scale : (n_vertices,) scale that carries the vertex (inside or on its outline; the
        representative lies at the scale's home position), -1 free.
    vertex_kind : (n_vertices,) 0 free, 1 on an outline where it is smooth, 2 on an outline at a
        kink, 3 strictly under a scale.
    outline_tangent : (n_vertices, 2) unit tangent of the outline at kind 1, else 0.
    edges : (n_edges, 2) vertices a, b.
    edge_shift : (n_edges, 2) lattice offset of b relative to a.
    triangle_edges : (n_triangles, 3) edge i joins corners i and i + 1 (mod 3).
    triangle_edge_offsets : (n_triangles, 3, 2) lattice offset of the edge's vertex a there.
    edge_scale : (n_edges,) scale on whose outline the edge lies, -1 in the gap, -2 strictly
        under a scale.
    scale_positions : (n_scale_vertices, 3) every scale whole, at offset 0, 0 <= z <= scale_height.
    tets : (n_tets, 4) scale vertices, positively oriented; (n_tets, 10) if quadratic, corners first
        and then the edges' middles in the order of `simplices.TET_EDGES`.
    tet_scale : (n_tets,) scale of a tet.
    base_triangles : (n_base, 3) scale vertices at z = 0, counterclockwise seen from +z; (n_base, 6)
        if quadratic.
    base_scale : (n_base,) scale of a base triangle.
    surface_triangles : (n_surface, 3) scale vertices, normals outward.
    surface_scale : (n_surface,) scale of a surface triangle.
    n_scales : number of scales.
    scale_height : mm.
    """

    lattice: FloatArray
    positions: FloatArray
    triangles: IntArray
    triangle_offsets: IntArray
    triangle_scale: IntArray
    vertex_scale: IntArray
    vertex_kind: Int8Array
    outline_tangent: FloatArray
    edges: IntArray
    edge_shift: IntArray
    triangle_edges: IntArray
    triangle_edge_offsets: IntArray
    edge_scale: IntArray
    scale_positions: FloatArray
    tets: IntArray
    tet_scale: IntArray
    base_triangles: IntArray
    base_scale: IntArray
    surface_triangles: IntArray
    surface_scale: IntArray
    n_scales: int
    scale_height: float

    @property
    def n_vertices(self) -> int:
        """Number of substrate vertices on the torus."""
        return len(self.positions)

    @property
    def n_triangles(self) -> int:
        """Number of substrate triangles, covered ones included."""
        return len(self.triangles)

    @property
    def n_edges(self) -> int:
        """Number of substrate edges on the torus."""
        return len(self.edges)

    @property
    def n_scale_vertices(self) -> int:
        """Number of vertices of all scales."""
        return len(self.scale_positions)

    @property
    def cell_area(self) -> float:
        """Area of the lattice cell, mm²."""
        return float(np.linalg.det(self.lattice))

    @property
    def euler_characteristic(self) -> int:
        """Vertices - edges + triangles of the substrate; 0 on a torus."""
        return self.n_vertices - self.n_edges + self.n_triangles

    def corner_positions(self) -> FloatArray:
        """Rest positions (n_triangles, 3, 2) of the triangles' corners, mm."""
        return self.positions[self.triangles] + self.triangle_offsets @ self.lattice

    def triangle_areas(self) -> FloatArray:
        """Signed areas (n_triangles,), mm²."""
        corners = self.corner_positions()
        u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        return 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])

    def tet_volumes(self) -> FloatArray:
        """Signed volumes (n_tets,), mm³."""
        corners = self.scale_positions[self.tets[:, :4]]
        arms = corners[:, 1:] - corners[:, :1]
        return np.linalg.det(arms) / 6.0

    def base_areas(self) -> FloatArray:
        """Signed areas (n_base,) of the base triangles, mm²."""
        corners = self.scale_positions[self.base_triangles[:, :3], :2]
        u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        return 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])

    def validate(self) -> None:
        """Check what everything after the mesh relies on.

        Raises
        ------
        MeshError : the sheet is not a torus, an element is turned over, or areas do not add up.
        """
        incidence = np.bincount(self.triangle_edges.ravel(), minlength=self.n_edges)
        covered = self.triangle_scale >= 0
        areas, base = self.triangle_areas(), self.base_areas()
        close = 1e-9 * self.cell_area
        volume = base.sum() * self.scale_height
        checks = (
            (self.euler_characteristic == 0, "the substrate's Euler characteristic is not 0"),
            ((incidence == 2).all(), "a substrate edge does not have exactly two triangles"),
            ((areas > 0.0).all(), "a substrate triangle is degenerate or turned over"),
            (abs(areas.sum() - self.cell_area) < close, "the substrate does not cover the cell"),
            ((base > 0.0).all(), "a base triangle is degenerate or turned over"),
            (abs(areas[covered].sum() - base.sum()) < close, "scale bases and sheet do not match"),
            ((self.tet_volumes() > 0.0).all(), "a tet is degenerate or turned over"),
            (
                abs(self.tet_volumes().sum() - volume) <= 1e-9 * volume,
                "the tets do not fill the scales",
            ),
        )
        broken = [message for holds, message in checks if not holds]
        if broken:
            raise MeshError(
                f"The periodic mesh is not usable: {'; '.join(broken)}. Try other mesh options "
                "(a smaller `corner` or `along`), or another gap."
            )

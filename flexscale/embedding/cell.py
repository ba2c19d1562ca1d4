"""The periodic cell: unknowns on a torus mesh, and the world vectors its elements need.

Unknowns z, in this order:

- three curvilinear coordinates w of every scale vertex;
- of every free substrate vertex w, then the parameter gradients g_u, g_v in the cylinder's frame (9
numbers);
- of every free gap edge the gradient g_n across it (3);
- of every smooth outline vertex and outline edge p, q, the in-plane part of the derivative across
the outline (2);
- S = (Sxx, Syy, Sxy), the homogeneous in-plane strain: lattice vectors become (I + S) L [Eq. 6].

Periodicity (3)-(6) holds by construction: a corner (v, (m, n)) of an element is the image of vertex
v.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from flexscale.embedding.contact_surface import find_surface, spread_contact, surface_rest
from flexscale.embedding.curvature_map import GRADIENT, POSITION, ImageVectors
from flexscale.embedding.world_map import WorldMap
from flexscale.mechanics.contact import ContactSurface
from flexscale.mechanics.energy import FloatArray, IntArray
from flexscale.mesh.bonds import build_bonds
from flexscale.mesh.periodic_mesh import (
    COVERED,
    FREE,
    GAP_EDGE,
    OUTLINE,
    OUTLINE_CORNER,
    PeriodicMesh,
)


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


class _Rows:
    """Collects rows of the world map, one per distinct key."""

    def __init__(self) -> None:
        self.row_of: dict[tuple, int] = {}
        self.image_of: dict[tuple, int] = {}
        self.images: list[tuple[int, int, FloatArray, FloatArray]] = []
        self.counts: list[int] = []
        self.terms: list[int] = []
        self.weights: list[tuple[float, float, float]] = []
        self.slide: list[int] = []

    def image(self, kind: int, node: int, shift: FloatArray, anchor: FloatArray) -> int:
        key = (node, *np.round(shift, 9).tolist())
        if key not in self.image_of:
            self.image_of[key] = len(self.images)
            self.images.append((kind, node, shift, anchor))
        return self.image_of[key]

    def add(self, key: tuple, terms: list[int], weights: np.ndarray, slide: int = -1) -> int:
        self.row_of[key] = len(self.counts)
        self.counts.append(len(terms))
        self.terms.extend(terms)
        self.weights.extend(map(tuple, weights))
        self.slide.append(slide)
        return self.row_of[key]

    def world_map(self, n_unknowns: int) -> WorldMap:
        kinds, nodes, shifts, anchors = zip(*self.images, strict=True)
        images = ImageVectors(
            np.array(kinds, dtype=np.int64),
            np.array(nodes, dtype=np.int64),
            np.array(shifts, dtype=float),
            np.array(anchors, dtype=float),
        )
        indptr = np.concatenate([[0], np.cumsum(self.counts)]).astype(np.int64)
        return WorldMap(
            images,
            indptr,
            np.array(self.terms, dtype=np.int64),
            np.array(self.weights, dtype=float),
            np.array(self.slide, dtype=np.int64),
            n_unknowns,
        )


_FREE_ROW = np.array([[1.0, 0.0, 0.0]])


class CellEmbedding:
    """Unknowns of a periodic cell and the map from them to world vectors.

    Attributes
    ----------
    mesh : the torus mesh.
    bond_radius : mm, around an outline point, over which the sheet follows a scale's base.
    world_map : z -> y.
    n_unknowns : length of z, S included.
    rest : (n_unknowns,) z of the flat, stress-free state.
    active : (n_unknowns - 2,) all unknowns but two that pin the in-plane translation.
    shift_unknown : index of one w3, used to hold the shift of w3 while factorizing.
    mean_offset : (n_unknowns,) c / A: c z / A is the mean normal displacement of the substrate [Eq.
        8], mm.
    shift_mode : (n_unknowns,) the uniform unit shift of w3.
    tet_vectors : (n_tets, 4) rows of y with the scales' vertices.
    shell : rows and geometry of the gap triangles.
    contact_surface : rows and triangles of the scales' surfaces; None without scales.
    """

    def __init__(
        self, mesh: PeriodicMesh, bond_radius: float = 0.0, contact_edge: float = 0.0
    ) -> None:
        self.mesh = mesh
        self.bond_radius = bond_radius
        self._number_unknowns()
        self._bond()
        rows = _Rows()
        self.tet_vectors = self._add_scales(rows)
        self.shell = self._add_shell(rows)
        self.contact_surface = self._add_contact(rows, contact_edge) if mesh.n_scales else None
        self.world_map = rows.world_map(self.n_unknowns)
        pinned = 0 if mesh.n_scales else int(self.vertex_node[0])
        self.active = np.setdiff1d(np.arange(self.n_unknowns), [pinned, pinned + 1])
        self.shift_unknown = pinned + 2
        self.mean_offset = self._build_mean_offset()
        self.shift_mode = np.zeros(self.n_unknowns)
        self.shift_mode[2 : 3 * mesh.n_scale_vertices : 3] = 1.0
        self.shift_mode[self.vertex_node[self.vertex_node >= 0] + 2] = 1.0

    def _number_unknowns(self) -> None:
        mesh = self.mesh
        free = np.flatnonzero(mesh.vertex_kind == FREE)
        smooth = np.flatnonzero(mesh.vertex_kind == OUTLINE)
        gap = np.flatnonzero(mesh.edge_scale == GAP_EDGE)
        outline = np.flatnonzero(mesh.edge_scale >= 0)
        start = 3 * mesh.n_scale_vertices
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
        start += 2 * len(outline)
        self.n_unknowns = start + 3
        ends = mesh.positions[mesh.edges[:, 1]] + mesh.edge_shift @ mesh.lattice
        span = ends - mesh.positions[mesh.edges[:, 0]]
        self.edge_tangent = span / np.linalg.norm(span, axis=1, keepdims=True)
        self.edge_normal = _left_normal(self.edge_tangent)
        self.edge_middle = mesh.positions[mesh.edges[:, 0]] + 0.5 * span

        rest = np.zeros(self.n_unknowns)
        rest[: 3 * mesh.n_scale_vertices] = mesh.scale_positions.ravel()
        for c in range(2):
            rest[self.vertex_node[free] + c] = mesh.positions[free, c]
            rest[self.vertex_node[free] + 3 + 4 * c] = 1.0
            rest[self.edge_node[gap] + c] = self.edge_normal[gap, c]
        rest[self.vertex_slide[smooth]] = 1.0
        rest[self.edge_slide[outline]] = 1.0
        self.rest = rest

    def _bond(self) -> None:
        """Bond every carried vertex and outline edge to the scale's base.

        Only the outline hands loads to the scale, so only there does the bond spread.
        """
        mesh = self.mesh
        carried = np.flatnonzero(mesh.vertex_scale >= 0)
        outline = np.flatnonzero(mesh.edge_scale >= 0)
        points = np.concatenate([mesh.positions[carried], self.edge_middle[outline]])
        scales = np.concatenate([mesh.vertex_scale[carried], mesh.edge_scale[outline]])
        loaded = np.concatenate([mesh.vertex_kind[carried] != COVERED, np.full(len(outline), True)])
        self._bonds = build_bonds(mesh, points, scales, np.where(loaded, self.bond_radius, 0.0))
        self._vertex_bond = np.full(mesh.n_vertices, -1, dtype=np.int64)
        self._vertex_bond[carried] = np.arange(len(carried))
        self._edge_bond = np.full(mesh.n_edges, -1, dtype=np.int64)
        self._edge_bond[outline] = len(carried) + np.arange(len(outline))

    def _bond_row(self, bond: int) -> tuple[IntArray, FloatArray, FloatArray]:
        part = slice(self._bonds.indptr[bond], self._bonds.indptr[bond + 1])
        return (
            self._bonds.scale_vertices[part],
            self._bonds.values[part],
            self._bonds.gradients[part],
        )

    def _add_scales(self, rows: _Rows) -> IntArray:
        home = np.zeros(2)
        for vertex in range(self.mesh.n_scale_vertices):
            image = rows.image(POSITION, 3 * vertex, home, home)
            rows.add(("scale", vertex), [image], _FREE_ROW)
        return self.mesh.tets.copy()

    def _add_contact(self, rows: _Rows, edge: float) -> ContactSurface:
        surface = find_surface(self.mesh)
        spread = spread_contact(self.mesh, edge)[surface.vertices]
        used: dict[tuple[int, ...], int] = {}
        columns = np.empty(spread.nnz, dtype=np.int64)
        for k, offset in enumerate(surface.offsets.tolist()):
            for entry in range(spread.indptr[k], spread.indptr[k + 1]):
                key = (int(spread.indices[entry]), *offset)
                columns[entry] = used.setdefault(key, len(used))
        places = np.array([self._scale_row(rows, *key) for key in used])
        shape = (len(surface.vertices), len(used))
        weights = sp.csr_array((spread.data, columns, spread.indptr), shape=shape)
        rest = surface_rest(self.mesh, surface)
        homes = zip(surface.vertices.tolist(), surface.offsets.tolist(), strict=True)
        own = np.array([used.setdefault((v, *offset), len(used)) for v, offset in homes])
        return ContactSurface(
            places,
            weights,
            surface.vertices,
            places[own],
            rest,
            surface.triangles,
            surface.bodies,
            surface.n_home,
        )

    def _scale_row(self, rows: _Rows, vertex: int, m: int, n: int) -> int:
        """Row with the position of a scale vertex at the lattice offset (m, n)."""
        if m == n == 0:
            return rows.row_of["scale", vertex]
        shift = np.array([m, n]) @ self.mesh.lattice
        image = rows.image(POSITION, 3 * vertex, shift, np.zeros(2))
        return rows.add(("scale", vertex, m, n), [image], _FREE_ROW)

    def _add_shell(self, rows: _Rows) -> ShellRows:
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
        return ShellRows(corners, self.edge_normal[mesh.triangle_edges[gap]], vectors)

    def _vertex_rows(self, rows: _Rows, vertex: int, offset: IntArray) -> int:
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
                rows.add((*key, k), [rows.image(GRADIENT, node + 3 * k, shift, anchor)], _FREE_ROW)
            return first
        carriers, _, slopes = self._bond_row(self._vertex_bond[vertex])
        terms = [rows.image(POSITION, 3 * int(v), shift, np.zeros(2)) for v in carriers]
        zero = np.zeros(len(carriers))
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

    def _edge_row(self, rows: _Rows, edge: int, offset: IntArray) -> int:
        """Row x_n of an edge image."""
        key = ("edge", edge, *offset.tolist())
        if key in rows.row_of:
            return rows.row_of[key]
        shift = offset @ self.mesh.lattice
        if self.mesh.edge_scale[edge] == GAP_EDGE:
            image = rows.image(GRADIENT, int(self.edge_node[edge]), shift, self.edge_middle[edge])
            return rows.add(key, [image], _FREE_ROW)
        carriers, _, slopes = self._bond_row(self._edge_bond[edge])
        terms = [rows.image(POSITION, 3 * int(v), shift, np.zeros(2)) for v in carriers]
        along, across = slopes @ self.edge_tangent[edge], slopes @ self.edge_normal[edge]
        weights = np.stack([np.zeros_like(along), across, along], axis=1)
        return rows.add(key, terms, weights, int(self.edge_slide[edge]))

    def display_map(self) -> tuple[WorldMap, IntArray]:
        """Positions of all scale vertices and of all substrate corners, also under the scales.

        Returns
        -------
        world_map : rows are the scale vertices, then the distinct images (v, (m, n)) of substrate
            vertices.
        triangles : (n_triangles, 3) rows of the substrate triangles' corners.
        """
        mesh, rows = self.mesh, _Rows()
        self._add_scales(rows)
        triangles = np.empty_like(mesh.triangles)
        for triangle in range(mesh.n_triangles):
            for corner in range(3):
                vertex = int(mesh.triangles[triangle, corner])
                offset = mesh.triangle_offsets[triangle, corner]
                triangles[triangle, corner] = self._position_row(rows, vertex, offset)
        return rows.world_map(self.n_unknowns), triangles

    def _position_row(self, rows: _Rows, vertex: int, offset: IntArray) -> int:
        """Row x of a vertex image."""
        key = ("vertex", vertex, *offset.tolist())
        if key in rows.row_of:
            return rows.row_of[key]
        shift, anchor = offset @ self.mesh.lattice, self.mesh.positions[vertex]
        if self.mesh.vertex_kind[vertex] == FREE:
            image = rows.image(POSITION, int(self.vertex_node[vertex]), shift, anchor)
            return rows.add(key, [image], _FREE_ROW)
        carriers, values, _ = self._bond_row(self._vertex_bond[vertex])
        terms = [rows.image(POSITION, 3 * int(v), shift, np.zeros(2)) for v in carriers]
        zero = np.zeros_like(values)
        return rows.add(key, terms, np.stack([values, zero, zero], axis=1))

    def _build_mean_offset(self) -> FloatArray:
        """Mass-weighted mean of w3 over the whole midsurface, also under the scales [Eq. 8]."""
        mesh = self.mesh
        areas = mesh.triangle_areas()
        share = np.bincount(
            mesh.triangles.ravel(), np.repeat(areas / 3.0, 3), minlength=mesh.n_vertices
        )
        weights = np.zeros(self.n_unknowns)
        free = mesh.vertex_kind == FREE
        weights[self.vertex_node[free] + 2] = share[free]
        for vertex in np.flatnonzero(mesh.vertex_scale >= 0):
            carriers, values, _ = self._bond_row(self._vertex_bond[vertex])
            weights[3 * carriers + 2] += values * share[vertex]
        return weights / areas.sum()


def _left_normal(tangent: FloatArray) -> FloatArray:
    return np.stack([-tangent[..., 1], tangent[..., 0]], axis=-1)

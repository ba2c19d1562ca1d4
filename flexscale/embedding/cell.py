"""The periodic cell: unknowns on a torus mesh, and the world vectors its elements need.

Unknowns z, in this order:

- three curvilinear coordinates w of every scale vertex;
- those of the sheet, w of every free substrate vertex among them: see the kinds of cells, `c1_cell`
and `edge_angle_cell`;
- S = (Sxx, Syy, Sxy), the homogeneous in-plane strain: lattice vectors become (I + S) L [Eq. 6].

Periodicity (3)-(6) holds by construction: a corner (v, (m, n)) of an element is the image of vertex
v.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
import scipy.sparse as sp

from flexscale.embedding.contact_surface import find_surface, spread_contact, surface_rest
from flexscale.embedding.curvature_map import POSITION
from flexscale.embedding.rows import FREE_ROW, Rows
from flexscale.embedding.world_map import WorldMap
from flexscale.mechanics.contact import ContactSurface
from flexscale.mechanics.energy import FloatArray, IntArray
from flexscale.mesh.bonds import build_bonds
from flexscale.mesh.periodic_mesh import COVERED, FREE, PeriodicMesh


class CellEmbedding(ABC):
    """Unknowns of a periodic cell and the map from them to world vectors.

    Parameters
    ----------
    mesh : the torus mesh.
    bond_radius : mm, around an outline point, over which the sheet follows a scale's base.
    contact_edge : mm, see `ContactOptions.edge`.

    Attributes
    ----------
    world_map : z -> y.
    n_unknowns : length of z, S included.
    vertex_node : (n_vertices,) first of the three w of a free substrate vertex, -1 for others.
    rest : (n_unknowns,) z of the flat, stress-free state.
    active : indices of all unknowns but two that pin the in-plane translation, and places in z that
        are held.
    shift_unknown : index of one w3, used to hold the shift of w3 while factorizing.
    mean_offset : (n_unknowns,) c / A: c z / A is the mean normal displacement of the substrate [Eq.
        8], mm.
    shift_mode : (n_unknowns,) the uniform unit shift of w3.
    tet_vectors : (n_tets, 4) rows of y with the scales' vertices.
    contact_surface : rows and triangles of the scales' surfaces; None without scales.
    """

    vertex_node: IntArray

    def __init__(
        self, mesh: PeriodicMesh, bond_radius: float = 0.0, contact_edge: float = 0.0
    ) -> None:
        self.mesh = mesh
        self.bond_radius = bond_radius
        ends = mesh.positions[mesh.edges[:, 1]] + mesh.edge_shift @ mesh.lattice
        self.edge_span = ends - mesh.positions[mesh.edges[:, 0]]
        self.edge_middle = mesh.positions[mesh.edges[:, 0]] + 0.5 * self.edge_span
        self.n_unknowns = self._number_sheet(3 * mesh.n_scale_vertices) + 3
        self.rest = self._build_rest()
        self._bond()
        rows = Rows()
        self.tet_vectors = self._add_scales(rows)
        self._add_sheet(rows)
        self.contact_surface = self._add_contact(rows, contact_edge) if mesh.n_scales else None
        self.world_map = rows.world_map(self.n_unknowns)
        pinned = 0 if mesh.n_scales else int(self.vertex_node[0])
        held = [pinned, pinned + 1, *self._held_unknowns()]
        self.active = np.setdiff1d(np.arange(self.n_unknowns), held)
        self.shift_unknown = pinned + 2
        self.mean_offset = self._build_mean_offset()
        self.shift_mode = np.zeros(self.n_unknowns)
        self.shift_mode[2 : 3 * mesh.n_scale_vertices : 3] = 1.0
        self.shift_mode[self.vertex_node[self.vertex_node >= 0] + 2] = 1.0

    @abstractmethod
    def _number_sheet(self, start: int) -> int:
        """Give the sheet its unknowns from `start` on, and set `vertex_node`; returns the end."""

    @abstractmethod
    def _set_sheet_rest(self, rest: FloatArray) -> None:
        """Values at rest of the sheet's unknowns, w of its free vertices excepted."""

    @abstractmethod
    def _add_sheet(self, rows: Rows) -> None:
        """Add the rows that the sheet's elements need."""

    def _held_unknowns(self) -> IntArray:
        """Places in z of the sheet that are no unknowns and keep their value at rest."""
        return np.zeros(0, dtype=np.int64)

    def _build_rest(self) -> FloatArray:
        mesh = self.mesh
        free = mesh.vertex_kind == FREE
        rest = np.zeros(self.n_unknowns)
        rest[: 3 * mesh.n_scale_vertices] = mesh.scale_positions.ravel()
        for c in range(2):
            rest[self.vertex_node[free] + c] = mesh.positions[free, c]
        self._set_sheet_rest(rest)
        return rest

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

    def _add_scales(self, rows: Rows) -> IntArray:
        home = np.zeros(2)
        for vertex in range(self.mesh.n_scale_vertices):
            image = rows.image(POSITION, 3 * vertex, home, home)
            rows.add(("scale", vertex), [image], FREE_ROW)
        return self.mesh.tets.copy()

    def _add_contact(self, rows: Rows, edge: float) -> ContactSurface:
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

    def _scale_row(self, rows: Rows, vertex: int, m: int, n: int) -> int:
        """Row with the position of a scale vertex at the lattice offset (m, n)."""
        if m == n == 0:
            return rows.row_of["scale", vertex]
        shift = np.array([m, n]) @ self.mesh.lattice
        image = rows.image(POSITION, 3 * vertex, shift, np.zeros(2))
        return rows.add(("scale", vertex, m, n), [image], FREE_ROW)

    def display_map(self) -> tuple[WorldMap, IntArray]:
        """Positions of all scale vertices and of all substrate corners, also under the scales.

        Returns
        -------
        world_map : rows are the scale vertices, then the distinct images (v, (m, n)) of substrate
            vertices.
        triangles : (n_triangles, 3) rows of the substrate triangles' corners.
        """
        mesh, rows = self.mesh, Rows()
        self._add_scales(rows)
        triangles = np.empty_like(mesh.triangles)
        for triangle in range(mesh.n_triangles):
            for corner in range(3):
                vertex = int(mesh.triangles[triangle, corner])
                offset = mesh.triangle_offsets[triangle, corner]
                triangles[triangle, corner] = self._position_row(rows, vertex, offset)
        return rows.world_map(self.n_unknowns), triangles

    def _position_row(self, rows: Rows, vertex: int, offset: IntArray) -> int:
        """Row x of a vertex image."""
        key = ("vertex", vertex, *offset.tolist())
        if key in rows.row_of:
            return rows.row_of[key]
        shift, anchor = offset @ self.mesh.lattice, self.mesh.positions[vertex]
        if self.mesh.vertex_kind[vertex] == FREE:
            image = rows.image(POSITION, int(self.vertex_node[vertex]), shift, anchor)
            return rows.add(key, [image], FREE_ROW)
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

"""The periodic cell: unknowns on a torus mesh, and the world vectors its elements need.

Unknowns z, in this order:

- three of every node of the scales: the curvilinear coordinates w of their vertices, or world
coordinates of points and vectors that modes will drive (see `scale_nodes`);
- those of the sheet, w of every free substrate vertex among them: see the kinds of cells, `c1_cell`
, `edge_angle_cell` and `solid_cell`;
- S = (Sxx, Syy, Sxy), the homogeneous in-plane strain: lattice vectors become (I + S) L [Eq. 6].

Periodicity (3)-(6) holds by construction: a corner (v, (m, n)) of an element is the image of vertex
v.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
import scipy.sparse as sp

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.contact_surface import find_surface, near_scales, surface_rest
from flexscale.embedding.curvature_map import POSITION
from flexscale.embedding.rows import FREE_ROW, Rows
from flexscale.embedding.scale_nodes import PointNodes, ScaleNodes, TetNodes
from flexscale.mechanics.contact import ContactSurface
from flexscale.mesh.bonds import build_bonds
from flexscale.mesh.periodic_mesh import COVERED, FREE, PeriodicMesh


class CellEmbedding(ABC):
    """Unknowns of a periodic cell and the map from them to world vectors.

    Parameters
    ----------
    mesh : the torus mesh.
    bond_radius : mm, around an outline point, over which the sheet follows a scale's base.
    contact_edge : mm, see `ContactOptions.edge`; None without contact.
    tets : whether the scales' vertices are unknowns, or points and vectors of them.

    Attributes
    ----------
    world_map : z -> y.
    n_unknowns : length of z, S included.
    n_nodes : nodes of scales, three numbers each; they come first.
    nodes : what the scales hand to sheet and contact.
    bonds : of the sheet to the scales, at `bonded (n_bonds, 2)`.
    vertex_bond, edge_bond : (n_vertices,), (n_edges,) bond of each, -1 for none.
    vertex_node : (n_vertices,) first of the three w of a free substrate vertex, -1 for others.
    rest : (n_unknowns,) z of the flat, stress-free state.
    active : indices of all unknowns but two that pin the in-plane translation, and places in z that
        are held.
    shift_unknown : index of one w3, used to hold the shift of w3 while factorizing.
    mean_offset : (n_unknowns,) c / A: c z / A is the mean normal displacement of the substrate [Eq.
        8], mm; of the free sheet alone where scales are no tets.
    shift_mode : (n_unknowns,) the uniform unit shift of w3.
    tet_vectors : (n_tets, 4) rows of y with the scales' vertices; none where scales are no tets.
    contact_surface : rows and triangles of the scales' surfaces; None without.
    """

    vertex_node: IntArray

    def __init__(
        self,
        mesh: PeriodicMesh,
        bond_radius: float = 0.0,
        contact_edge: float | None = 0.0,
        tets: bool = True,
    ) -> None:
        self.mesh = mesh
        self.bond_radius = bond_radius
        ends = mesh.positions[mesh.edges[:, 1]] + mesh.edge_shift @ mesh.lattice
        self.edge_span = ends - mesh.positions[mesh.edges[:, 0]]
        self.edge_middle = mesh.positions[mesh.edges[:, 0]] + 0.5 * self.edge_span
        self.nodes = self._bond(contact_edge, tets)
        self.n_nodes = len(self.nodes.rest)
        self.n_unknowns = self._number_sheet(3 * self.n_nodes) + 3
        self.rest = self._build_rest()
        rows = Rows()
        self.tet_vectors = self._add_scales(rows) if tets else np.zeros((0, 4), dtype=np.int64)
        self._add_sheet(rows)
        self.contact_surface = None
        if contact_edge is not None and mesh.n_scales > 0:
            self.contact_surface = self._add_contact(rows, contact_edge)
        self.world_map = rows.world_map(self.n_unknowns)
        pinned = 0 if mesh.n_scales else int(self.vertex_node[0])
        held = [pinned, pinned + 1, *self._held_unknowns()]
        self.active = np.setdiff1d(np.arange(self.n_unknowns), held)
        self.shift_unknown = pinned + 2
        self.mean_offset = self._build_mean_offset(tets)
        self.shift_mode = np.zeros(self.n_unknowns)
        self.shift_mode[2 : 3 * self.n_nodes : 3] = 1.0
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
        rest[: 3 * self.n_nodes] = self.nodes.rest.ravel()
        for c in range(2):
            rest[self.vertex_node[free] + c] = mesh.positions[free, c]
        self._set_sheet_rest(rest)
        return rest

    #: Kinds of bonds of which the sheet wants the position too, and not the gradients alone.
    _edges_have_position = False

    def _bond(self, contact_edge: float | None, tets: bool) -> ScaleNodes:
        """Bond every carried vertex and outline edge to the scale's base.

        Only the outline hands loads to the scale, so only there does the bond spread.
        """
        mesh = self.mesh
        carried = np.flatnonzero(mesh.vertex_scale >= 0)
        outline = np.flatnonzero(mesh.edge_scale >= 0)
        points = np.concatenate([mesh.positions[carried], self.edge_middle[outline]])
        scales = np.concatenate([mesh.vertex_scale[carried], mesh.edge_scale[outline]])
        loaded = np.concatenate([mesh.vertex_kind[carried] != COVERED, np.full(len(outline), True)])
        bonds = build_bonds(mesh, points, scales, np.where(loaded, self.bond_radius, 0.0))
        self.bonds, self.bonded = bonds, points
        self.vertex_bond = np.full(mesh.n_vertices, -1, dtype=np.int64)
        self.vertex_bond[carried] = np.arange(len(carried))
        self.edge_bond = np.full(mesh.n_edges, -1, dtype=np.int64)
        self.edge_bond[outline] = len(carried) + np.arange(len(outline))
        if tets or not mesh.n_scales:
            return TetNodes(mesh, bonds)
        has_value = np.arange(len(points)) < len(carried)
        if self._edges_have_position:
            has_value[:] = True
        return PointNodes(mesh, bonds, scales, loaded & has_value, loaded, contact_edge)

    def _add_scales(self, rows: Rows) -> IntArray:
        home = np.zeros(2)
        for vertex in range(self.mesh.n_scale_vertices):
            image = self.nodes.image(rows, vertex, home)
            rows.add(("scale", vertex), [image], FREE_ROW)
        return self.mesh.tets.copy()

    def _add_contact(self, rows: Rows, edge: float) -> ContactSurface:
        touching = self.nodes.touching_surface(edge)
        surface = find_surface(self.mesh, touching.positions, touching.triangles, touching.scale)
        spread = touching.weights[surface.vertices]
        used: dict[tuple[int, ...], int] = {}
        columns = np.empty(spread.nnz, dtype=np.int64)
        for k, offset in enumerate(surface.offsets.tolist()):
            for entry in range(spread.indptr[k], spread.indptr[k + 1]):
                key = (int(spread.indices[entry]), *offset)
                columns[entry] = used.setdefault(key, len(used))
        shape = (len(surface.vertices), len(used))
        rest = surface_rest(self.mesh, touching.positions, surface)
        return ContactSurface(
            np.array([self._scale_row(rows, *key) for key in used]),
            sp.csr_array((spread.data, columns, spread.indptr), shape=shape),
            touching.vertices[surface.vertices],
            rest,
            surface.triangles,
            surface.bodies,
            surface.n_home,
            near_scales(self.mesh, rest, surface),
        )

    def _scale_row(self, rows: Rows, node: int, m: int, n: int) -> int:
        """Row with the position of a scale's node at the lattice offset (m, n)."""
        key = ("scale", node) if m == n == 0 else ("scale", node, m, n)
        if key in rows.row_of:
            return rows.row_of[key]
        image = self.nodes.image(rows, node, np.array([m, n]) @ self.mesh.lattice)
        return rows.add(key, [image], FREE_ROW)

    def _position_row(self, rows: Rows, vertex: int, offset: IntArray) -> int:
        """Row x of a vertex image."""
        key = ("vertex", vertex, *offset.tolist())
        if key in rows.row_of:
            return rows.row_of[key]
        shift, anchor = offset @ self.mesh.lattice, self.mesh.positions[vertex]
        if self.mesh.vertex_kind[vertex] == FREE:
            image = rows.image(POSITION, int(self.vertex_node[vertex]), shift, anchor)
            return rows.add(key, [image], FREE_ROW)
        terms, values = self.nodes.position(rows, int(self.vertex_bond[vertex]), shift)
        zero = np.zeros_like(values)
        return rows.add(key, terms, np.stack([values, zero, zero], axis=1))

    def vertex_shares(self) -> FloatArray:
        """(n_vertices,) share of the midsurface that belongs to each substrate vertex."""
        areas = self.mesh.triangle_areas()
        corners = np.repeat(areas / (3.0 * areas.sum()), 3)
        n = self.mesh.n_vertices
        return np.bincount(self.mesh.triangles.ravel(), corners, minlength=n).astype(float)

    def _build_mean_offset(self, tets: bool) -> FloatArray:
        """Mass-weighted mean of w3 over the midsurface, with tets also under the scales [Eq. 8]."""
        share = self.vertex_shares()
        weights = np.zeros(self.n_unknowns)
        free = self.mesh.vertex_kind == FREE
        weights[self.vertex_node[free] + 2] = share[free]
        for vertex in np.flatnonzero(self.mesh.vertex_scale >= 0) if tets else ():
            bond = self.vertex_bond[vertex]
            part = slice(self.bonds.indptr[bond], self.bonds.indptr[bond + 1])
            weights[3 * self.bonds.scale_vertices[part] + 2] += (
                self.bonds.values[part] * share[vertex]
            )
        return weights

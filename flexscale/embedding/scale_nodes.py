"""What a scale hands to the rest of the cell: positions and gradients of its base where the sheet
is bonded to it, and the surface that touches other scales.

Two kinds of scales: made of tets, whose vertices are unknowns (`TetNodes`), and described by few
modes, of which only the points and vectors that something else sees are kept (`PointNodes`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import scipy.sparse as sp

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.contact_surface import spread_contact
from flexscale.embedding.curvature_map import BODY_POINT, BODY_VECTOR, POSITION
from flexscale.embedding.rows import Rows
from flexscale.mesh.bonds import Bonds
from flexscale.mesh.periodic_mesh import PeriodicMesh


@dataclass(frozen=True)
class TouchingSurface:
    """Surface of all scales as contact sees it.

    Attributes
    ----------
    positions : (n, 3) at rest, mm.
    triangles : (n_triangles, 3), outward.
    scale : (n_triangles,) scale of each.
    weights : (n, n_nodes) of the nodes in each vertex; affine motions are reproduced.
    vertices : (n,) scale vertex that a vertex is, -1 for none.
    """

    positions: FloatArray
    triangles: IntArray
    scale: IntArray
    weights: sp.csr_array
    vertices: IntArray


class ScaleNodes(Protocol):
    """Unknown vectors of the scales, three numbers each, at the beginning of z."""

    rest: FloatArray  # (n_nodes, 3)

    def position(self, rows: Rows, bond: int, shift: FloatArray) -> tuple[list[int], FloatArray]:
        """Images and weights (n,) that give a bonded point's position in a lattice image."""

    def gradient(self, rows: Rows, bond: int, shift: FloatArray) -> tuple[list[int], FloatArray]:
        """Images and weights (n, 2) that give a bonded point's in-plane gradients."""

    def image(self, rows: Rows, node: int, shift: FloatArray) -> int:
        """Image of a node's position."""

    def touching_surface(self, edge: float) -> TouchingSurface:
        """What contact sees, spread over the contact edge [mm]."""


class TetNodes:
    """Nodes are the vertices of the tets."""

    def __init__(self, mesh: PeriodicMesh, bonds: Bonds) -> None:
        self.mesh, self.bonds = mesh, bonds
        self.rest = mesh.scale_positions

    def _terms(self, rows: Rows, bond: int, shift: FloatArray) -> tuple[list[int], slice]:
        part = slice(self.bonds.indptr[bond], self.bonds.indptr[bond + 1])
        carriers = self.bonds.scale_vertices[part]
        return [self.image(rows, int(v), shift) for v in carriers], part

    def position(self, rows: Rows, bond: int, shift: FloatArray) -> tuple[list[int], FloatArray]:
        terms, part = self._terms(rows, bond, shift)
        return terms, self.bonds.values[part]

    def gradient(self, rows: Rows, bond: int, shift: FloatArray) -> tuple[list[int], FloatArray]:
        terms, part = self._terms(rows, bond, shift)
        return terms, self.bonds.gradients[part]

    def image(self, rows: Rows, node: int, shift: FloatArray) -> int:
        return rows.image(POSITION, 3 * node, shift, np.zeros(2))

    def touching_surface(self, edge: float) -> TouchingSurface:
        mesh = self.mesh
        return TouchingSurface(
            mesh.scale_positions,
            mesh.surface_triangles,
            mesh.surface_scale,
            spread_contact(mesh, edge),
            np.arange(mesh.n_scale_vertices),
        )


class PointNodes:
    """Nodes are home points and vectors of scales, in the world.

    Parameters
    ----------
    bonds : weights of scale vertices at bonded points.
    scales : (n_bonds,) scale of each.
    valued : (n_bonds,) whether its position is asked for.
    turned : (n_bonds,) whether its gradients are.
    contact_edge : mm; None without contact.

    Attributes
    ----------
    weights : (n_nodes, n_scale_vertices) of the scale's vertices in each node.
    kinds : (n_nodes,) BODY_POINT or BODY_VECTOR.
    scale : (n_nodes,) ascending.
    value_of : (n_bonds,) node with a bond's position, -1 without.
    gradient_of : (n_bonds, 2) nodes with its in-plane gradients, -1 without.
    """

    def __init__(
        self,
        mesh: PeriodicMesh,
        bonds: Bonds,
        scales: IntArray,
        valued: np.ndarray,
        turned: np.ndarray,
        contact_edge: float | None,
    ) -> None:
        self.mesh = mesh
        n = mesh.n_scale_vertices
        tables = [
            sp.csr_array((data, bonds.scale_vertices, bonds.indptr), shape=(len(scales), n))
            for data in (bonds.values, bonds.gradients[:, 0], bonds.gradients[:, 1])
        ]
        valued, held = np.flatnonzero(valued), np.flatnonzero(turned)
        self._wall = _build_wall(mesh)
        wall = self._wall.bottom_and_top if contact_edge is not None else np.zeros(0, np.int64)
        spread = spread_contact(mesh, contact_edge or 0.0, wall)[wall]
        weights = sp.csr_array(
            sp.vstack([tables[0][valued], tables[1][held], tables[2][held], spread])
        )
        owner = np.empty(n, dtype=np.int64)
        owner[mesh.tets.ravel()] = np.repeat(mesh.tet_scale, mesh.tets.shape[1])
        scale = np.concatenate([scales[valued], scales[held], scales[held], owner[wall]])
        kinds = np.full(len(scale), BODY_POINT)
        kinds[len(valued) : len(valued) + 2 * len(held)] = BODY_VECTOR
        order = np.argsort(scale, kind="stable")
        self.weights, self.scale, self.kinds = weights[order], scale[order], kinds[order]
        self.rest = self.weights @ mesh.scale_positions
        place = np.argsort(order)
        self.value_of = np.full(len(scales), -1)
        self.value_of[valued] = place[: len(valued)]
        self.gradient_of = np.full((len(scales), 2), -1)
        self.gradient_of[held, 0] = place[len(valued) : len(valued) + len(held)]
        self.gradient_of[held, 1] = place[len(valued) + len(held) :][: len(held)]
        self._wall_nodes = place[len(valued) + 2 * len(held) :]

    def position(self, rows: Rows, bond: int, shift: FloatArray) -> tuple[list[int], FloatArray]:
        return [self.image(rows, int(self.value_of[bond]), shift)], np.ones(1)

    def gradient(self, rows: Rows, bond: int, shift: FloatArray) -> tuple[list[int], FloatArray]:
        return [self.image(rows, int(node), shift) for node in self.gradient_of[bond]], np.eye(2)

    def image(self, rows: Rows, node: int, shift: FloatArray) -> int:
        return rows.image(int(self.kinds[node]), 3 * node, shift, np.zeros(2))

    def wall_normals(self) -> tuple[IntArray, FloatArray, FloatArray]:
        """Nodes (n,) on walls, outward normals (n, 3) and half lengths (n,) [mm] of the facets
        they belong to."""
        if not len(self._wall_nodes):
            return np.zeros(0, np.int64), np.zeros((0, 3)), np.zeros(0)
        wall = self._wall
        facets = wall.corners[len(wall.bottom_and_top) :]
        along = wall.positions[facets[:, 1]] - wall.positions[facets[:, 0]]
        length = np.linalg.norm(along, axis=1)
        outward = np.stack([along[:, 1], -along[:, 0], np.zeros(len(along))], axis=1)
        outward /= length[:, None]
        nodes = self._wall_nodes[facets.ravel()]
        return nodes, np.repeat(outward, 4, axis=0), np.repeat(0.5 * length, 4)

    def touching_surface(self, edge: float) -> TouchingSurface:
        """The walls, between points at their feet and tops; the middles of facets follow these."""
        wall, n_nodes = self._wall, len(self.kinds)
        nodes = self._wall_nodes[wall.corners]
        rows = np.repeat(np.arange(len(nodes)), wall.shares.shape[1])
        weights = sp.csr_array(
            (wall.shares.ravel(), (rows, nodes.ravel())), shape=(len(nodes), n_nodes)
        )
        weights.sum_duplicates()
        weights.eliminate_zeros()
        positions = np.einsum("nk,nkc->nc", wall.shares, wall.positions[wall.corners])
        return TouchingSurface(positions, wall.triangles, wall.scale, weights, wall.vertices)


@dataclass(frozen=True)
class _Wall:
    """Walls of the scales as facets around their middles.

    bottom_and_top : (n_points,) scale vertices; positions : (n_points, 3). A vertex of the wall is
    the mean of its corners (n, 4), with shares (n, 4); vertices (n,) as in `TouchingSurface`.
    """

    bottom_and_top: IntArray
    positions: FloatArray
    corners: IntArray
    shares: FloatArray
    vertices: IntArray
    triangles: IntArray
    scale: IntArray


def _build_wall(mesh: PeriodicMesh) -> _Wall:
    base = mesh.base_triangles[:, :3]
    sides = np.stack([base, np.roll(base, -1, axis=1)], axis=2).reshape(-1, 2)
    owner = np.repeat(mesh.base_scale, 3)
    n = mesh.n_scale_vertices
    outer = ~np.isin(sides[:, 0] * n + sides[:, 1], sides[:, 1] * n + sides[:, 0])
    sides, owner = sides[outer], owner[outer]
    foot = np.unique(sides)
    foot_scale = np.empty(n, dtype=np.int64)
    foot_scale[sides[:, 0]] = owner
    points = mesh.scale_positions
    top = np.flatnonzero(np.isclose(points[:, 2], points[:, 2].max(), rtol=0.0, atol=1e-9))
    tet_scale = np.empty(n, dtype=np.int64)
    tet_scale[mesh.tets.ravel()] = np.repeat(mesh.tet_scale, mesh.tets.shape[1])
    keys = {(int(tet_scale[v]), *np.round(points[v, :2], 7)): int(v) for v in top}
    above = np.array([keys[int(foot_scale[v]), *np.round(points[v, :2], 7)] for v in foot])
    n_foot, n_facets = len(foot), len(sides)
    a, b = np.searchsorted(foot, sides[:, 0]), np.searchsorted(foot, sides[:, 1])
    facets = np.stack([a, b, n_foot + b, n_foot + a], axis=1)
    middle = 2 * n_foot + np.arange(n_facets)
    triangles = np.concatenate(
        [np.stack([facets[:, k], facets[:, (k + 1) % 4], middle], axis=1) for k in range(4)]
    )
    own = np.arange(2 * n_foot)
    corners = np.concatenate([np.repeat(own[:, None], 4, axis=1), facets])
    shares = np.concatenate(
        [np.tile([1.0, 0.0, 0.0, 0.0], (2 * n_foot, 1)), np.full((n_facets, 4), 0.25)]
    )
    bottom_and_top = np.concatenate([foot, above])
    vertices = np.concatenate([bottom_and_top, np.full(n_facets, -1)])
    return _Wall(
        bottom_and_top, points[bottom_and_top], corners, shares, vertices, triangles,
        np.tile(owner, 4),
    )  # fmt: skip

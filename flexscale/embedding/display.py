"""Where everything of a cell is at a state: for pictures and other programs."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.bends import Bend
from flexscale.embedding.body_cell import BodyCell
from flexscale.embedding.cell import CellEmbedding
from flexscale.embedding.curvature_map import BODY_POINT, POSITION, ImageVectors, place_images
from flexscale.mechanics.contact import ScaleContact
from flexscale.mesh.periodic_mesh import FREE


class Display:
    """Positions of all scale vertices, then of the substrate's corners, also under the scales.

    Attributes
    ----------
    mesh : of scales and substrate.
    triangles : (n_triangles, 3) points with the substrate triangles' corners.
    rest : (n_points, 3) mm.
    """

    def __init__(
        self, embedding: CellEmbedding | BodyCell, contact: ScaleContact | None = None
    ) -> None:
        self.embedding, self.contact = embedding, contact
        mesh = self.mesh = embedding.mesh
        inner = embedding.inner if isinstance(embedding, BodyCell) else embedding
        keys = np.concatenate([mesh.triangles[..., None], mesh.triangle_offsets], axis=2).reshape(
            -1, 3
        )
        images, number = np.unique(keys, axis=0, return_inverse=True)
        self.triangles: IntArray = mesh.n_scale_vertices + number.reshape(-1, 3)
        self._vertices = images[:, 0]
        self._shifts = images[:, 1:] @ mesh.lattice
        bonds = inner.bonds
        self._bonds = sp.csr_array(
            (bonds.values, bonds.scale_vertices, bonds.indptr),
            shape=(len(bonds.indptr) - 1, mesh.n_scale_vertices),
        )
        self._vertex_bond, self._vertex_node = inner.vertex_bond, inner.vertex_node
        self._inner = inner
        self.rest = self.place(embedding.rest, Bend(0.0, 0.0))

    def place(self, z: FloatArray, bend: Bend) -> FloatArray:
        """(n_points, 3) in the world at a state z under a bend, mm."""
        mesh = self.embedding.mesh
        scales = self._scale_positions(z, bend)
        nodes = self._vertex_node.copy()
        if isinstance(self.embedding, BodyCell):
            start = int(self.embedding.world_map.starts[-1])
            nodes = np.where(nodes >= 0, nodes - 3 * self._inner.n_nodes + start, -1)
        free = mesh.vertex_kind[self._vertices] == FREE
        out = np.empty((len(self._vertices), 3))
        out[free] = _images(z, bend, POSITION, nodes[self._vertices[free]], self._shifts[free])
        carried = self._bonds[self._vertex_bond[self._vertices[~free]]] @ scales
        home = np.concatenate([carried.ravel(), z[-3:]])
        own = 3 * np.arange(len(carried))
        out[~free] = _images(home, bend, BODY_POINT, own, self._shifts[~free])
        return np.concatenate([scales, out])

    def contact_force(self, z: FloatArray, bend: Bend) -> FloatArray:
        """(n_points,) length of the force by which other scales press on a point, N."""
        force = np.zeros(len(self.rest))
        if self.contact is not None:
            y = self.embedding.world_map.place(z, bend).y
            n = self.mesh.n_scale_vertices  # they come first among the points
            force[:n] = self.contact.vertex_forces(y, n)
        return force

    def _scale_positions(self, z: FloatArray, bend: Bend) -> FloatArray:
        if isinstance(self.embedding, BodyCell):
            return self.embedding.scale_positions(z, bend)
        nodes = 3 * np.arange(self.embedding.mesh.n_scale_vertices)
        return _images(z, bend, POSITION, nodes, np.zeros((len(nodes), 2)))


def _images(
    z: FloatArray, bend: Bend, kind: int, nodes: IntArray, shifts: FloatArray
) -> FloatArray:
    """(n, 3) images of one kind whose home unknowns begin at `nodes` of z."""
    n = len(nodes)
    i = ImageVectors(np.full(n, kind), nodes, shifts, np.zeros((n, 2)))
    x, jacobian, rate = np.empty((n, 3)), np.empty((n, 3, 6)), np.empty((n, 3))
    place_images(
        z, bend.curvature, bend.direction, i.kinds, i.nodes, i.shifts, i.anchors, x, jacobian, rate
    )
    return x

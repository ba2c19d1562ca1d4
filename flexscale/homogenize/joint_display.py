"""Where everything of a cell on joints is at a state, for pictures: scales, and a sheet between."""

from __future__ import annotations

import numpy as np
import shapely
from scipy.spatial import cKDTree

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.bends import Bend
from flexscale.embedding.rigid_cell import RigidCell
from flexscale.mechanics.prism_contact import PrismContact
from flexscale.mesh.options import MeshOptions
from flexscale.mesh.torus import build_mesh
from flexscale.patterns.pattern import Pattern
from flexscale.tilings.lattice import reduction

#: Of a picture: nothing is computed with it.
MESH = MeshOptions(along=1.0, corner=1.0, scale_size=5.0, scale_layers=3, scale_order=1)


class JointDisplay:
    """Positions of all scale vertices, then of the sheet's corners, also under the scales.

    Between scales the sheet is drawn through a mean of how its neighbors move, with weights that
    fall off as the square of the distance from them; the model knows no more of it than its energy.

    Attributes
    ----------
    mesh : of scales and sheet.
    triangles : (n_triangles, 3) points with the sheet triangles' corners.
    rest : (n_points, 3) mm.
    """

    def __init__(
        self, pattern: Pattern, embedding: RigidCell, contact: PrismContact | None
    ) -> None:
        self.pattern, self.embedding, self.contact = pattern, embedding, contact
        mesh = self.mesh = build_mesh(pattern, MESH)
        keys = np.concatenate([mesh.triangles[..., None], mesh.triangle_offsets], axis=2)
        corners, number = np.unique(keys.reshape(-1, 3), axis=0, return_inverse=True)
        self.triangles: IntArray = mesh.n_scale_vertices + number.reshape(-1, 3)
        ground = mesh.positions[corners[:, 0]] + corners[:, 1:] @ mesh.lattice
        self.rest = np.concatenate([mesh.scale_positions, np.pad(ground, ((0, 0), (0, 1)))])
        self._carriers, self._weights = self._find_carriers()

    def _find_carriers(self) -> tuple[list[tuple[int, FloatArray]], FloatArray]:
        """Images of scales (number, lattice vector), and their weights (n_points, n_images)."""
        pattern = self.pattern
        short = reduction(pattern.lattice) @ pattern.lattice
        outlines = [shapely.Polygon(outline) for outline in pattern.outlines()]
        points = shapely.points(self.rest[:, :2])
        images, weights = [], []
        reach = 4.0 * max(pattern.gaps)
        for m in range(-2, 3):
            for n in range(-2, 3):
                shift = np.array([m, n]) @ short
                for scale, outline in enumerate(outlines):
                    moved = shapely.transform(outline, lambda xy, shift=shift: xy + shift)
                    distance = shapely.distance(points, moved)
                    if (distance < reach).any():
                        images.append((scale, shift))
                        weights.append(1.0 / np.maximum(distance, 1e-9 * pattern.gap) ** 2)
        shares = np.array(weights).T
        shares[shares < 1e-6 * shares.max(axis=1)[:, None]] = 0.0
        return images, shares / shares.sum(axis=1)[:, None]

    def place(self, z: FloatArray, bend: Bend) -> FloatArray:
        """(n_points, 3) in the world at a state z under a bend, mm."""
        scales = self.embedding.scales
        level = 0.5 * self.pattern.substrate_thickness  # of the bases, over the anchors
        out = np.zeros_like(self.rest)
        numbers = np.array([scale for scale, _ in self._carriers])
        places = scales.anchors[numbers] + [shift for _, shift in self._carriers]
        poses = self.embedding.place_images(z, bend, numbers, places)
        for place, pose, weight in zip(places, poses, self._weights.T, strict=True):
            used = weight > 0.0
            arms = self.rest[used] - [*place, -level]
            out[used] += weight[used, None] * (pose[0] + arms @ pose[1:].T)
        out[:, 2] -= level
        return out

    def contact_force(self, z: FloatArray, bend: Bend) -> FloatArray:
        """(n_points,) N, lengths of the forces by which other scales press on a scale, each at the
        scale's point nearest to where the two touch."""
        force = np.zeros(len(self.rest))
        contact, scales = self.contact, self.embedding.scales
        if contact is None:
            return force
        found, weights, lengths = contact.presses(self.embedding.place(z, bend).y)
        rows, table = scales.rows, scales.rows.table
        scale = scales.pairs[rows.pair, table.second.astype(int)]
        corners = table.rest + np.pad(scales.anchors[scale], ((0, 0), (0, 1)))
        corners[:, 2] -= 0.5 * self.pattern.substrate_thickness
        mesh = self.mesh
        owner = np.empty(mesh.n_scale_vertices, dtype=np.int64)
        owner[mesh.tets] = mesh.tet_scale[:, None]
        apart = 10.0 * float(np.ptp(self.rest, axis=0).max())  # of scales, on an axis of its own
        points = cKDTree(np.column_stack([mesh.scale_positions, apart * owner]))
        for side in (0, 1):
            of = scale[found[:, 3 * side]]
            at = np.einsum("nk,nkc->nc", weights[:, side], corners[found])
            nearest = points.query(np.column_stack([at, apart * of]))[1]
            np.add.at(force, nearest, lengths)
        return force

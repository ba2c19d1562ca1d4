"""Contact between scales: the barrier of Incremental Potential Contact (Li et al. 2020), by
`ipctk`.

The barrier acts between a home scale and other scales or lattice images of scales, each unordered
pair of the periodic pattern once. It starts at a distance d_hat, so it moves the onset of contact
by up to d_hat / gap; d_hat is a small fraction of the gap.
"""

from __future__ import annotations

from dataclasses import dataclass

import ipctk
import numpy as np
import scipy.sparse as sp

from flexscale.mechanics.energy import FloatArray, IntArray

ipctk.set_num_threads(1)


def barrier_stiffness(force: float, activation_distance: float) -> float:
    """Stiffness at which one pair at half the activation distance pushes with `force` [N].

    With b(d) = -(d^2 - d_hat^2)^2 ln(d^2/d_hat^2), db/dd at d_hat/2 is -4.33 d_hat^3.
    """
    s = 0.25
    slope = -2.0 * (s - 1.0) * np.log(s) - (s - 1.0) ** 2 / s
    return force / (-slope * activation_distance**3)


@dataclass(frozen=True)
class ContactSurface:
    """Surfaces of the home scales, then of their lattice images as far as they can be reached.

    Attributes
    ----------
    rows : (n,) rows of the world vectors with the vertices' positions.
    rest : (n, 3) rest positions, mm.
    triangles : (n_triangles, 3) vertices of this surface, outward.
    bodies : (n,) whole scale that a vertex belongs to; images are bodies of their own.
    n_home : vertices of home scales, they come first; images do not collide with one another.
    """

    rows: IntArray
    rest: FloatArray
    triangles: IntArray
    bodies: IntArray
    n_home: int


class ScaleContact:
    """Barrier energy of a contact surface; its elements are found anew at every state.

    Parameters
    ----------
    surface : the surfaces that can touch.
    activation_distance : d_hat, mm.
    stiffness : of the barrier, N mm-3 (times mm^4 of the squared-distance barrier).
    """

    part_names: tuple[str, ...] = ("contact",)

    def __init__(
        self, surface: ContactSurface, activation_distance: float, stiffness: float
    ) -> None:
        self.surface = surface
        self.activation_distance = activation_distance
        triangles = surface.triangles.astype(np.int32)
        rest = np.asfortranarray(surface.rest)
        self._mesh = ipctk.CollisionMesh(rest, ipctk.edges(triangles), triangles)
        apart = ipctk.make_vertex_patches_filter(surface.bodies.astype(np.int32))
        self._mesh.can_collide = apart & ipctk.make_static_obstacle_filter(surface.n_home)
        self._potential = ipctk.BarrierPotential(activation_distance, stiffness)
        self._sweep = ipctk.AdditiveCCD()
        self._found: tuple[FloatArray, FloatArray, ipctk.NormalCollisions] | None = None

    def _positions(self, y: FloatArray) -> FloatArray:
        return np.asfortranarray(y[self.surface.rows])

    def _collisions(self, y: FloatArray) -> tuple[FloatArray, ipctk.NormalCollisions]:
        if self._found is None or self._found[0] is not y:
            positions = self._positions(y)
            collisions = ipctk.NormalCollisions()
            collisions.build(self._mesh, positions, self.activation_distance)
            self._found = (y, positions, collisions)
        return self._found[1], self._found[2]

    def energy_parts(self, y: FloatArray) -> FloatArray:
        """(1,) N mm; assumes a state without intersections."""
        positions, collisions = self._collisions(y)
        return np.array([self._potential(collisions, self._mesh, positions)])

    def add_gradient(self, y: FloatArray, gradient: FloatArray) -> None:
        """Add dE/dy [N] to `gradient (n_y, 3)`."""
        positions, collisions = self._collisions(y)
        if len(collisions):
            slope = self._potential.gradient(collisions, self._mesh, positions).reshape(-1, 3)
            gradient[self.surface.rows] += slope

    def pair_blocks(self, y: FloatArray, project: bool = False) -> tuple[IntArray, FloatArray]:
        """Pairs (n, 2) of rows of y, a <= b, and blocks (n, 3, 3) of d2E/dy2."""
        positions, collisions = self._collisions(y)
        if not len(collisions):
            return np.zeros((0, 2), dtype=np.int64), np.zeros((0, 3, 3))
        method = ipctk.PSDProjectionMethod.CLAMP if project else ipctk.PSDProjectionMethod.NONE
        hessian = self._potential.hessian(collisions, self._mesh, positions, method)
        blocks = sp.bsr_array(hessian, blocksize=(3, 3))
        blocks.sum_duplicates()
        first = np.repeat(np.arange(len(self.surface.rows)), np.diff(blocks.indptr))
        pairs = self.surface.rows[np.stack([first, blocks.indices], axis=1)]
        kept = pairs[:, 0] <= pairs[:, 1]
        return pairs[kept], blocks.data[kept]

    def free_share(self, start: FloatArray, end: FloatArray) -> float:
        """Share of the straight way from y = start to end on which nothing passes through."""
        return float(
            ipctk.compute_collision_free_stepsize(
                self._mesh, self._positions(start), self._positions(end), 0.0, None, self._sweep
            )
        )

    def possible_pairs(self, reach: float) -> IntArray:
        """(n, 2) rows, a < b, of home and image vertices that primitives within `reach` share."""
        candidates = ipctk.Candidates()
        rest = np.asfortranarray(self.surface.rest)
        candidates.build(self._mesh, rest, 0.5 * reach)
        edges, faces = self._mesh.edges, self._mesh.faces
        stencils = [c.vertex_ids(edges, faces) for c in candidates.ee_candidates]
        stencils += [c.vertex_ids(edges, faces) for c in candidates.fv_candidates]
        if not stencils:
            return np.zeros((0, 2), dtype=np.int64)
        corners = self.surface.rows[np.array(stencils)[:, :4]]
        first, second = np.triu_indices(4, 1)
        pairs = np.stack([corners[:, first].ravel(), corners[:, second].ravel()], axis=1)
        pairs.sort(axis=1)
        return np.unique(pairs[pairs[:, 0] < pairs[:, 1]], axis=0)

    def intersects(self, y: FloatArray) -> bool:
        """Whether any triangle of one scale cuts an edge of another."""
        return bool(ipctk.has_intersections(self._mesh, self._positions(y)))

    def smallest_distance(self, y: FloatArray, reach: float) -> float:
        """Smallest distance between scales, mm; infinite beyond `reach`."""
        collisions, positions = ipctk.NormalCollisions(), self._positions(y)
        collisions.build(self._mesh, positions, reach)
        if not len(collisions):
            return float("inf")
        return float(np.sqrt(collisions.compute_minimum_distance(self._mesh, positions)))

    def active_pairs(self, y: FloatArray) -> int:
        """Number of primitive pairs closer than d_hat."""
        return len(self._collisions(y)[1])

    def force(self, y: FloatArray) -> float:
        """Sum of the contact forces on the home scales' vertices, as lengths of vectors, N."""
        gradient = np.zeros_like(y)
        self.add_gradient(y, gradient)
        rows = self.surface.rows[: self.surface.n_home]
        return float(np.linalg.norm(gradient[rows], axis=1).sum())

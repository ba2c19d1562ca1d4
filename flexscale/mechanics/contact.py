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

from flexscale.arrays import FloatArray, IntArray
from flexscale.mechanics.barrier import MOST_SWEEP_STEPS, SWEEPS, Barrier
from flexscale.mechanics.contact_gaps import LinearGaps

ipctk.set_num_threads(1)

NEAR = 20.0  # d_hat: primitives closer than this get room in the Hessian when contact needs any


@dataclass(frozen=True)
class ContactSurface:
    """Surfaces of the home scales, then of their lattice images as far as they can be reached.

    Attributes
    ----------
    rows : (n_rows,) rows of the world vectors with the positions of scale vertices, each once.
    weights : (n, n_rows) of these rows in the surface's vertices; affine motions are reproduced.
    vertices : (n,) scale vertex that each vertex of the surface is, or is an image of; -1 for none.
    rest : (n, 3) rest positions of the surface's vertices, mm.
    triangles : (n_triangles, 3) vertices of this surface, outward.
    bodies : (n,) whole scale that a vertex belongs to; images are bodies of their own.
    n_home : vertices of home scales, they come first; images do not collide with one another.
    neighbors : (n, 2) home scales k <= j that are near one another, images included.
    """

    rows: IntArray
    weights: sp.csr_array
    vertices: IntArray
    rest: FloatArray
    triangles: IntArray
    bodies: IntArray
    n_home: int
    neighbors: IntArray


class ScaleContact(Barrier):
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
        super().__init__(activation_distance, stiffness)
        self.surface = surface
        triangles = surface.triangles.astype(np.int32)
        rest = np.asfortranarray(surface.rest)
        self._mesh = ipctk.CollisionMesh(rest, ipctk.edges(triangles), triangles)
        apart = ipctk.make_vertex_patches_filter(surface.bodies.astype(np.int32))
        self._mesh.can_collide = apart & ipctk.make_static_obstacle_filter(surface.n_home)
        self._sweep = ipctk.AdditiveCCD(MOST_SWEEP_STEPS)
        self._found: tuple[FloatArray, FloatArray, ipctk.NormalCollisions] | None = None

    @property
    def _potential(self) -> ipctk.BarrierPotential:
        return ipctk.BarrierPotential(self.activation_distance, self.stiffness)

    def positions(self, y: FloatArray) -> FloatArray:
        """(n, 3) world positions of the surface's vertices, mm."""
        return np.asfortranarray(self.surface.weights @ y[self.surface.rows])

    def spread(self, forces: FloatArray, n_rows: int) -> FloatArray:
        """(n_rows, 3) forces on rows of y for those on the surface's vertices."""
        out = np.zeros((n_rows, 3))
        out[self.surface.rows] = self.surface.weights.T @ forces
        return out

    def _collisions(self, y: FloatArray) -> tuple[FloatArray, ipctk.NormalCollisions]:
        if self._found is None or self._found[0] is not y:
            positions = self.positions(y)
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
            gradient[self.surface.rows] += self.surface.weights.T @ slope

    def pair_blocks(self, y: FloatArray, project: bool = False) -> tuple[IntArray, FloatArray]:
        """Pairs (n, 2) of rows of y, a <= b, and blocks (n, 3, 3) of d2E/dy2."""
        positions, collisions = self._collisions(y)
        if not len(collisions):
            return np.zeros((0, 2), dtype=np.int64), np.zeros((0, 3, 3))
        method = ipctk.PSDProjectionMethod.CLAMP if project else ipctk.PSDProjectionMethod.NONE
        hessian = self._potential.hessian(collisions, self._mesh, positions, method)
        blocks = sp.bsr_array(hessian, blocksize=(3, 3))
        blocks.sum_duplicates()
        return self._spread_blocks(blocks)

    def _spread_blocks(self, blocks: sp.bsr_array) -> tuple[IntArray, FloatArray]:
        """Pairs and 3 x 3 blocks between rows of y, from blocks between surface vertices."""
        first = np.repeat(np.arange(blocks.shape[0] // 3), np.diff(blocks.indptr))
        left, middle, share = _expand(self.surface.weights, first)
        values = share[:, None, None] * blocks.data[middle]
        right, entry, share = _expand(self.surface.weights, blocks.indices[middle])
        values = share[:, None, None] * values[entry]
        rows = self.surface.rows
        a, b = rows[left[entry]], rows[right]
        kept = a <= b
        keys, slot = np.unique(a[kept] * (rows.max() + 1) + b[kept], return_inverse=True)
        out = np.zeros((len(keys), 3, 3))
        np.add.at(out, slot, values[kept])
        return np.stack(np.divmod(keys, rows.max() + 1), axis=1), out

    def free_share(self, start: FloatArray, end: FloatArray) -> float:
        """Share of the straight way from y = start to end on which nothing passes through.

        One sweep stops where a distance is a tenth of what it is at its start: the next goes on
        from there.
        """
        first, last = self.positions(start), self.positions(end)
        done = 0.0
        for _ in range(SWEEPS):
            here = np.asfortranarray(first + done * (last - first))
            share = ipctk.compute_collision_free_stepsize(
                self._mesh, here, last, 0.0, None, self._sweep
            )
            if share >= 1.0:
                return 1.0
            done += (1.0 - done) * share
        return float(done)

    def gaps(self, y: FloatArray, reach: float) -> LinearGaps:
        """Distances of primitives closer than `reach` [mm], linear around y."""
        positions, found = self.positions(y), ipctk.NormalCollisions()
        found.build(self._mesh, positions, reach)
        edges, faces = self._mesh.edges, self._mesh.faces
        stencils = np.full((len(found), 4), -1, dtype=np.int64)
        shares = np.zeros((len(found), 4))
        for k in range(len(found)):
            stencils[k], mix = _stencil(found[k], positions, edges, faces)
            shares[k, : len(mix)] = mix
        used = stencils >= 0
        entries = (shares[used], (np.nonzero(used)[0], stencils[used]))
        matrix = sp.csr_array(entries, shape=(len(found), len(positions)))
        arrows = matrix @ positions
        distances = np.linalg.norm(arrows, axis=1)
        bodies = np.where(used, self.surface.bodies[stencils], self.surface.bodies[stencils[:, :1]])
        pairs = bodies.min(axis=1) * (self.surface.bodies.max() + 1) + bodies.max(axis=1)
        return LinearGaps(matrix, arrows / distances[:, None], distances, pairs)

    def near_pairs(self, y: FloatArray) -> IntArray:
        """(n, 2) rows a <= b that primitives closer than `NEAR` d_hat couple."""
        positions = self.positions(y)
        found = ipctk.NormalCollisions()
        found.build(self._mesh, positions, NEAR * self.activation_distance)
        if not len(found):
            return np.zeros((0, 2), dtype=np.int64)
        edges, faces = self._mesh.edges, self._mesh.faces
        stencils = np.array([found[k].vertex_ids(edges, faces) for k in range(len(found))])
        used = stencils >= 0
        touched = sp.csr_array(
            (np.ones(used.sum()), (np.nonzero(used)[0], stencils[used])),
            shape=(len(stencils), len(self.surface.rest)),
        )
        reached = touched @ abs(self.surface.weights)
        first, second = (reached.T @ reached).nonzero()
        pairs = np.stack([self.surface.rows[first], self.surface.rows[second]], axis=1)
        return pairs[pairs[:, 0] <= pairs[:, 1]]

    def intersects(self, y: FloatArray) -> bool:
        """Whether any triangle of one scale cuts an edge of another."""
        return bool(ipctk.has_intersections(self._mesh, self.positions(y)))

    def smallest_distance(self, y: FloatArray, reach: float) -> float:
        """Smallest distance between scales, mm; infinite beyond `reach`."""
        collisions, positions = ipctk.NormalCollisions(), self.positions(y)
        collisions.build(self._mesh, positions, reach)
        if not len(collisions):
            return float("inf")
        return float(np.sqrt(collisions.compute_minimum_distance(self._mesh, positions)))

    def active_pairs(self, y: FloatArray) -> int:
        """Number of primitive pairs closer than d_hat."""
        return len(self._collisions(y)[1])

    def forces(self, y: FloatArray) -> FloatArray:
        """(n, 3) contact forces on the vertices of the surface, N."""
        positions, collisions = self._collisions(y)
        if not len(collisions):
            return np.zeros_like(self.surface.rest)
        gradient = self._potential.gradient(collisions, self._mesh, positions)
        return np.asarray(-gradient.reshape(-1, 3))

    def vertex_forces(self, y: FloatArray, n_vertices: int) -> FloatArray:
        """(n_vertices,) contact force on each scale vertex, as the length of a vector, N.

        A scale meets some neighbors itself, and others where one of its images meets a home scale.
        """
        known = self.surface.vertices >= 0
        lengths = np.linalg.norm(self.forces(y), axis=1)[known]
        found = np.bincount(self.surface.vertices[known], lengths, minlength=n_vertices)
        return found.astype(float)

    def force(self, y: FloatArray) -> float:
        """Sum of the contact forces on the home scales' vertices, as lengths of vectors, N."""
        return float(np.linalg.norm(self.forces(y)[: self.surface.n_home], axis=1).sum())


def _stencil(
    pair: ipctk.NormalCollision, positions: FloatArray, edges: IntArray, faces: IntArray
) -> tuple[IntArray, FloatArray]:
    """Vertices (4,) of a pair of primitives, and their shares in the arrow between nearest points.

    A function of its own: a pair that outlives its set of collisions is freed memory.
    """
    return pair.vertex_ids(edges, faces), pair.compute_coefficients(
        pair.dof(positions, edges, faces)
    )


def _expand(weights: sp.csr_array, rows: IntArray) -> tuple[IntArray, IntArray, FloatArray]:
    """Columns and weights of some rows of a CSR matrix, and the entry of `rows` each is for."""
    counts = np.diff(weights.indptr)[rows]
    entry = np.repeat(np.arange(len(rows)), counts)
    place = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    place += weights.indptr[rows][entry]
    return weights.indices[place].astype(np.int64), entry, weights.data[place]

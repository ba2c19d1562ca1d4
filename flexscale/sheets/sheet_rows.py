"""Rows y of a macro sheet: positions, derivatives and edge angles, and where they are at rest.

C1 sheets have (x, x_1, x_2) at every vertex and x_n at every edge. Directions 1 and 2 are those of
the boundary where there is one, so that what a hinge holds (x and its derivative along the edge)
and what it leaves free (the derivative across) are rows of their own; elsewhere u and v. Sheets of
linear triangles have x at every vertex, an angle at every edge, and x of a ghost: the third corner
of the triangle that a clamp would add beyond a clamped boundary edge.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexscale.arrays import BoolArray, FloatArray, IntArray
from flexscale.errors import BadInputError
from flexscale.mechanics.edge_angles import EdgeStencils
from flexscale.mesh.sheet import SheetMesh
from flexscale.sheets.surfaces import Surface

POSITION, DERIVATIVE, ANGLE = 0, 1, 2
_PARALLEL = 1e-6  # sine of the angle up to which two directions count as one
_SMOOTH = 0.5  # sine of the angle up to which two boundary edges count as one smooth boundary


@dataclass(frozen=True)
class SheetRows:
    """What each row of y is.

    Attributes
    ----------
    kinds : (n_rows,) POSITION, DERIVATIVE or ANGLE (in the first component).
    points : (n_rows, 2) parameters where it is taken.
    directions : (n_rows, 2) direction of a derivative in the parameters; of a ghost the arm from
        its edge's middle, as it lies in the tangent plane there.
    ends : (n_rows, 2) vertices a row belongs to: one twice, or the two ends of its edge.
    """

    kinds: IntArray
    points: FloatArray
    directions: FloatArray
    ends: IntArray

    @property
    def n_rows(self) -> int:
        return len(self.kinds)

    def place(self, surface: Surface) -> FloatArray:
        """(n_rows, 3) rows of a sheet that lies on a surface; edge angles are 0."""
        positions, gradients = surface(self.points)
        along = np.einsum("ncd,nd->nc", gradients, self.directions)
        out = along + np.where((self.kinds == POSITION)[:, None], positions, 0.0)
        out[self.kinds == ANGLE] = 0.0
        return out

    def rigid(self, vertices: BoolArray) -> IntArray:
        """Rows of what is clamped at vertices (n_vertices,) and along the edges between them."""
        return np.flatnonzero(vertices[self.ends].all(axis=1) & (self.kinds != ANGLE))

    def positions(self, vertices: BoolArray) -> IntArray:
        """Rows of the positions of vertices (n_vertices,)."""
        at = self.ends[:, 0] == self.ends[:, 1]
        return np.flatnonzero(at & (self.kinds == POSITION) & vertices[self.ends[:, 0]])

    def derivatives(self, vertices: BoolArray, direction: tuple[float, float]) -> IntArray:
        """Rows of the derivatives along a direction at vertices and the edges between them.

        None of a sheet of linear triangles.

        Raises
        ------
        BadInputError : a vertex has no derivative of its own along that direction.
        """
        of_kind = (self.kinds == DERIVATIVE) & vertices[self.ends].all(axis=1)
        sine = self.directions[:, 0] * direction[1] - self.directions[:, 1] * direction[0]
        along = of_kind & (abs(sine) <= _PARALLEL * np.hypot(*direction))
        at_vertex = self.ends[:, 0] == self.ends[:, 1]
        missing = np.setdiff1d(self.ends[of_kind & at_vertex, 0], self.ends[along & at_vertex, 0])
        if len(missing):
            place = self.points[np.flatnonzero(at_vertex & (self.ends[:, 0] == missing[0]))[0]]
            raise BadInputError(
                f"The sheet has no derivative along {direction} at ({place[0]:.4g}, "
                f"{place[1]:.4g}) mm: a vertex has those along the boundary's tangent and normal, "
                "or along x and y inside; hold all of the vertex, or turn the sheet."
            )
        return np.flatnonzero(along)


@dataclass(frozen=True)
class SmoothRows:
    """Rows of a C1 sheet, and what its elements need.

    Attributes
    ----------
    rows : what each row is.
    vectors : (n_triangles, 12) rows of each triangle in the order of `hct`.
    edge_normals : (n_triangles, 3, 2) directions of the mid-edge derivatives.
    vertex_frames : (n_triangles, 3, 2, 2) directions 1, 2 at the corners.
    """

    rows: SheetRows
    vectors: IntArray
    edge_normals: FloatArray
    vertex_frames: FloatArray


def smooth_rows(mesh: SheetMesh) -> SmoothRows:
    """Rows of a C1 sheet: three a vertex, then one an edge."""
    n, frames = mesh.n_vertices, _boundary_frames(mesh)
    span = mesh.points[mesh.edges[:, 1]] - mesh.points[mesh.edges[:, 0]]
    span /= np.linalg.norm(span, axis=1, keepdims=True)
    normals = np.stack([-span[:, 1], span[:, 0]], axis=1)
    directions = np.zeros((n, 3, 2))
    directions[:, 1:] = frames
    numbers = np.repeat(np.arange(n), 3)
    rows = SheetRows(
        kinds=np.concatenate(
            [np.tile([POSITION, DERIVATIVE, DERIVATIVE], n), np.full(len(span), DERIVATIVE)]
        ),
        points=np.concatenate([mesh.points[numbers], mesh.points[mesh.edges].mean(axis=1)]),
        directions=np.concatenate([directions.reshape(-1, 2), normals]),
        ends=np.concatenate([np.stack([numbers, numbers], axis=1), mesh.edges]),
    )
    corners = 3 * mesh.triangles[:, :, None] + np.arange(3)
    vectors = np.concatenate([corners.reshape(-1, 9), 3 * n + mesh.triangle_edges], axis=1)
    return SmoothRows(rows, vectors, normals[mesh.triangle_edges], frames[mesh.triangles])


def _boundary_frames(mesh: SheetMesh) -> FloatArray:
    """(n_vertices, 2, 2) directions 1, 2: tangent and normal of a smooth boundary, the two edges of
    a corner, u and v inside."""
    frames = np.tile(np.eye(2), (mesh.n_vertices, 1, 1))
    around: dict[int, list[FloatArray]] = {}
    for a, b in mesh.edges[mesh.boundary].tolist():
        span = mesh.points[b] - mesh.points[a]
        tangent = span / np.linalg.norm(span)
        around.setdefault(a, []).append(tangent)
        around.setdefault(b, []).append(-tangent)
    for vertex, (first, second) in around.items():
        if abs(first[0] * second[1] - first[1] * second[0]) > _SMOOTH:
            frames[vertex] = first, second
            continue
        mean = first - second
        tangent = mean / np.linalg.norm(mean)
        frames[vertex] = tangent, (-tangent[1], tangent[0])
    return frames


@dataclass(frozen=True)
class LinearRows:
    """Rows of a sheet of linear triangles, and what its elements need."""

    rows: SheetRows
    stencils: EdgeStencils


def linear_rows(mesh: SheetMesh, clamped: BoolArray) -> LinearRows:
    """Rows of a sheet of linear triangles: vertices, edge angles, ghosts.

    Parameters
    ----------
    clamped : (n_vertices,) vertices that are held with all around them; a boundary edge between two
        of them has a ghost.
    """
    n, sides = mesh.n_vertices, mesh.triangle_edges
    ghosted = mesh.boundary & clamped[mesh.edges].all(axis=1)
    ghost_row = n + len(mesh.edges) + np.cumsum(ghosted) - 1
    across, signs = _across(mesh)
    beyond = across < 0
    shares = np.where(beyond, np.where(ghosted[sides], 1.0, 0.0), 0.5)
    signs = np.where(ghosted[sides], 0.0, signs)
    own = mesh.triangles[:, [2, 0, 1]]  # across from its own edge: of no effect where share is 0
    neighbors = np.where(beyond, np.where(ghosted[sides], ghost_row[sides], own), across)
    vectors = np.concatenate([mesh.triangles, neighbors], axis=1)
    numbers = [np.stack([np.arange(n)] * 2, axis=1)]
    points, kinds = [mesh.points], [np.full(n, POSITION)]
    vectors = np.concatenate([vectors, n + sides], axis=1)
    numbers.append(mesh.edges)
    points.append(mesh.points[mesh.edges].mean(axis=1))
    kinds.append(np.full(len(mesh.edges), ANGLE))
    numbers.append(mesh.edges[ghosted])
    points.append(mesh.points[mesh.edges[ghosted]].mean(axis=1))
    kinds.append(np.full(int(ghosted.sum()), POSITION))
    arms = np.zeros((sum(map(len, points)), 2))
    arms[len(arms) - len(points[-1]) :] = _mirrored(mesh)[ghosted] - points[-1]
    rows = SheetRows(np.concatenate(kinds), np.concatenate(points), arms, np.concatenate(numbers))
    return LinearRows(rows, EdgeStencils(mesh.points[mesh.triangles], vectors, shares, signs))


def _across(mesh: SheetMesh) -> tuple[IntArray, FloatArray]:
    """(n_triangles, 3) vertex across each edge, -1 at the boundary, and +1 on one of its sides, -1
    on the other."""
    flat = mesh.triangle_edges.ravel()
    order = np.argsort(flat, kind="stable")
    first = np.concatenate([[True], np.diff(flat[order]) > 0])
    opposite = mesh.triangles[:, [2, 0, 1]].ravel()
    across, signs = np.full(flat.size, -1, dtype=np.int64), np.ones(flat.size)
    second = np.flatnonzero(~first)
    here, there = order[second - 1], order[second]
    across[here], across[there] = opposite[there], opposite[here]
    signs[there] = -1.0
    return across.reshape(-1, 3), signs.reshape(-1, 3)


def _mirrored(mesh: SheetMesh) -> FloatArray:
    """(n_edges, 2) the corner across an edge, mirrored in it."""
    corner = np.empty(len(mesh.edges), dtype=np.int64)
    corner[mesh.triangle_edges] = mesh.triangles[:, [2, 0, 1]]
    start, end = mesh.points[mesh.edges[:, 0]], mesh.points[mesh.edges[:, 1]]
    tangent = (end - start) / np.linalg.norm(end - start, axis=1, keepdims=True)
    arm = mesh.points[corner] - start
    along = np.sum(arm * tangent, axis=1, keepdims=True) * tangent
    return start + 2.0 * along - arm

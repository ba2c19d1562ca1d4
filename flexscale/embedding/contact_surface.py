"""Which parts of which scales can meet: home scales, and lattice images within reach of them; and
how far around a point of a scale its neighbor presses.

Scales touch along lines and at points, and under such loads an elastic body sinks in the deeper the
finer its mesh, without limit. Printed edges are rounded: they press over the size of the contact
edge. So a point of a contact surface follows the affine motion that fits the scale's surface best
within that radius (see `mesh.patches`), which spreads the force over it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.spatial import cKDTree

from flexscale.arrays import FloatArray, IntArray
from flexscale.mesh.patches import fit_affine
from flexscale.mesh.periodic_mesh import PeriodicMesh

#: In-plane reach of contact beyond a scale's outline, as a share of the root of the mean tile area.
REACH = 0.25

AT_ONCE = 200  # points of a surface whose surroundings are integrated together, to bound memory


@dataclass(frozen=True)
class SurfaceVertices:
    """Vertices of home scales and of their images, and the triangles between them.

    Attributes
    ----------
    vertices : (n,) vertices of the scales' surface.
    offsets : (n, 2) lattice offsets; (0, 0) first, then images.
    bodies : (n,) whole scale each belongs to; images are bodies of their own.
    scales : (n,) scale of the cell that each is of, or of an image of.
    triangles : (n_triangles, 3) entries of `vertices`.
    n_home : number of vertices at offset (0, 0).
    """

    vertices: IntArray
    offsets: IntArray
    bodies: IntArray
    scales: IntArray
    triangles: IntArray
    n_home: int


def find_surface(
    mesh: PeriodicMesh, positions: FloatArray, triangles: IntArray, scales: IntArray
) -> SurfaceVertices:
    """Home scales whole, and what lies within reach of them of the images on one side.

    `triangles (n, 3)` between `positions (n_vertices, 3)` [mm], and the scale of each.

    Of an image at L and one at -L only the first is taken (L lexicographically positive), so that
    each unordered pair of scales of the periodic pattern is met once.
    """
    reach = _reach(mesh)
    home_points = positions[np.unique(triangles)]
    tree = cKDTree(np.unique(np.round(home_points[:, :2], 9), axis=0))
    parts = [(triangles, scales, np.zeros(2, dtype=np.int64))]
    span = range(-2, 3)
    for offset in ((m, n) for m in span for n in span if m > 0 or (m == 0 and n > 0)):
        shifted = positions[:, :2] + np.array(offset) @ mesh.lattice
        near = tree.query(shifted, distance_upper_bound=reach)[0] < reach
        kept = near[triangles].any(axis=1)
        if kept.any():
            offset_array = np.array(offset, dtype=np.int64)
            parts.append((triangles[kept], scales[kept], offset_array))
    return _number(parts)


def _number(parts: list[tuple[IntArray, IntArray, IntArray]]) -> SurfaceVertices:
    vertices, offsets, bodies, homes, triangles = [], [], [], [], []
    start = body = 0
    for faces, scales, offset in parts:
        used, local = np.unique(faces, return_inverse=True)
        owner = np.zeros(len(used), dtype=np.int64)
        owner[local.ravel()] = np.repeat(scales, 3)
        _, number = np.unique(owner, return_inverse=True)
        vertices.append(used)
        offsets.append(np.broadcast_to(offset, (len(used), 2)))
        bodies.append(body + number)
        homes.append(owner)
        triangles.append(start + local.reshape(-1, 3))
        start += len(used)
        body += int(number.max()) + 1
    return SurfaceVertices(
        np.concatenate(vertices),
        np.concatenate(offsets),
        np.concatenate(bodies),
        np.concatenate(homes),
        np.concatenate(triangles),
        len(vertices[0]),
    )


def _reach(mesh: PeriodicMesh) -> float:
    return float(REACH * np.sqrt(mesh.triangle_areas().sum() / mesh.n_scales))


def near_scales(mesh: PeriodicMesh, rest: FloatArray, surface: SurfaceVertices) -> IntArray:
    """(n, 2) scales k <= j of which one is within reach of the other, or of an image of it.

    rest : (n_vertices, 3) of the surface's vertices, mm.
    """
    ground = np.column_stack([surface.bodies, surface.scales, np.round(rest[:, :2], 9)])
    ground = np.unique(ground, axis=0)  # one of all vertices above one another
    pairs = cKDTree(ground[:, 2:]).query_pairs(_reach(mesh), output_type="ndarray")
    first, second = ground[pairs[:, 0]], ground[pairs[:, 1]]
    scales = np.stack([first[:, 1], second[:, 1]], axis=1)[first[:, 0] != second[:, 0]]
    return np.unique(np.sort(scales, axis=1), axis=0).astype(np.int64)


def surface_rest(mesh: PeriodicMesh, positions: FloatArray, surface: SurfaceVertices) -> FloatArray:
    """(n, 3) rest positions of the surface's vertices, images shifted, mm."""
    rest = positions[surface.vertices].copy()
    rest[:, :2] += surface.offsets @ mesh.lattice
    return rest


def spread_contact(
    mesh: PeriodicMesh, radius: float, asked: IntArray | None = None
) -> sp.csr_array:
    """Weights (n_scale_vertices, n_scale_vertices) of scale vertices in the points that touch.

    Row v has the weights of the vertices within `radius` of v on its scale's surface in the
    position that contact sees there; they reproduce affine motions. With radius 0, for vertices
    inside a scale, and for others than those `asked` for, that is the position of v itself.
    """
    n = mesh.n_scale_vertices
    if radius <= 0.0:
        return sp.csr_array(sp.eye_array(n))
    corners = mesh.scale_positions[mesh.surface_triangles]
    middles = corners.mean(axis=1)
    extents = np.linalg.norm(corners - middles[:, None], axis=2).max(axis=1)
    owner = np.full(n, -1)
    owner[mesh.surface_triangles.ravel()] = np.repeat(mesh.surface_scale, 3)
    if asked is not None:
        owner[np.setdiff1d(np.arange(n), asked)] = -1
    rows, columns, weights = [], [], []
    for scale in range(mesh.n_scales):
        faces = np.flatnonzero(mesh.surface_scale == scale)
        tree, largest = cKDTree(middles[faces]), float(extents[faces].max())
        for vertices in _parts(np.flatnonzero(owner == scale), AT_ONCE):
            points = mesh.scale_positions[vertices]
            reached = tree.query_ball_point(points, radius + largest, return_sorted=True)
            group = np.repeat(np.arange(len(vertices)), [len(found) for found in reached])
            near = faces[np.concatenate(reached).astype(np.int64)]
            close = np.linalg.norm(middles[near] - points[group], axis=1) < radius + extents[near]
            near, group = near[close], group[close]
            arms = corners[near] - points[group, None]
            forms = fit_affine(arms, group, radius, quadratic=False, finest=0.5)
            rows.append(np.repeat(vertices[group], 3))
            columns.append(mesh.surface_triangles[near].ravel())
            weights.append(forms[:, :, 0].ravel())
    inside = np.flatnonzero(owner < 0)
    entries = (
        np.concatenate([*weights, np.ones(len(inside))]),
        (np.concatenate([*rows, inside]), np.concatenate([*columns, inside])),
    )
    spread = sp.csr_array(entries, shape=(n, n))
    spread.sum_duplicates()
    spread.eliminate_zeros()
    return spread


def _parts(vertices: IntArray, size: int) -> list[IntArray]:
    return [vertices[k : k + size] for k in range(0, len(vertices), size)]

"""Does an isometry of the plane carry a periodic mesh onto itself?"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from flexscale.mesh import PeriodicMesh
from flexscale.patterns import Isometry

TOLERANCE = 1e-8  # mm
SPREAD = 512  # more than lattice offsets within a triangle differ


def point_group(center: np.ndarray, order: int, mirrors: bool) -> list[Isometry]:
    """Rotations by 360° / order about a center and, if asked for, mirrors, one of them along x."""
    angles = 2.0 * np.pi * np.arange(order) / order
    linear = [np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]]) for a in angles]
    if mirrors:
        linear += [turn @ np.diag([1.0, -1.0]) for turn in linear]
    return [Isometry(matrix, center - matrix @ center) for matrix in linear]


def images_on_torus(
    points: np.ndarray, targets: np.ndarray, lattice: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Target (n,) that each point is a lattice image of, and the lattice offset (n, 2).

    Points (n, 2) or (n, 3): the lattice shifts the first two coordinates.
    """
    inverse = np.linalg.inv(lattice)
    grid = np.mgrid[-1:2, -1:2].reshape(2, -1).T
    home = np.floor(targets[:, :2] @ inverse)
    base = np.floor(points[:, :2] @ inverse)
    cloud = np.tile(targets, (len(grid), 1))
    cloud[:, :2] -= np.tile(home @ lattice, (len(grid), 1))
    cloud[:, :2] += np.repeat(grid @ lattice, len(targets), axis=0)
    sought = points.copy()
    sought[:, :2] -= base @ lattice
    distance, found = cKDTree(cloud).query(sought, distance_upper_bound=TOLERANCE)
    assert np.isfinite(distance).all(), "a node has no image"
    target = found % len(targets)
    return target, (base + grid[found // len(targets)] - home[target]).astype(int)


def assert_symmetric(mesh: PeriodicMesh, isometry: Isometry) -> None:
    """The isometry carries nodes, kinds, triangles, base triangles and tets onto one another."""
    vertex, offset = images_on_torus(isometry.apply(mesh.positions), mesh.positions, mesh.lattice)
    assert np.array_equal(np.sort(vertex), np.arange(mesh.n_vertices))
    assert np.array_equal(mesh.vertex_kind[vertex], mesh.vertex_kind)
    turn = np.rint(mesh.lattice @ isometry.linear.T @ np.linalg.inv(mesh.lattice)).astype(int)
    offsets = offset[mesh.triangles] + mesh.triangle_offsets @ turn
    covered = mesh.triangle_scale >= 0
    images = canonical(vertex[mesh.triangles], offsets, covered)
    assert np.array_equal(images, canonical(mesh.triangles, mesh.triangle_offsets, covered))

    moved = mesh.scale_positions.copy()
    moved[:, :2] = isometry.apply(moved[:, :2])
    image = images_on_torus(moved, mesh.scale_positions, mesh.lattice)[0]
    for cells in (mesh.base_triangles, mesh.tets, mesh.surface_triangles):
        assert np.array_equal(sorted_rows(np.sort(image[cells])), sorted_rows(np.sort(cells)))


def canonical(triangles: np.ndarray, offsets: np.ndarray, covered: np.ndarray) -> np.ndarray:
    """Triangles up to lattice shifts and the order of their corners, sorted (n, 4)."""
    best = np.zeros((0, 3))
    for reference in range(3):
        m, n = (offsets - offsets[:, reference, None] + SPREAD).transpose(2, 0, 1)
        keys = np.sort((triangles * 2 * SPREAD + m) * 2 * SPREAD + n)
        best = np.where(is_less(keys, best)[:, None], keys, best) if reference else keys
    return sorted_rows(np.column_stack([best, covered]))


def is_less(rows: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Whether each row comes before the other one in the order of words."""
    differs = rows != others
    first = differs.argmax(axis=1)
    here = np.arange(len(rows))
    return differs.any(axis=1) & (rows[here, first] < others[here, first])


def sorted_rows(rows: np.ndarray) -> np.ndarray:
    """The rows in the order of words."""
    return rows[np.lexsort(rows.T[::-1])]

"""Does an isometry of the plane carry a periodic mesh onto itself?"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from flexscale.mesh import PeriodicMesh
from flexscale.patterns import Isometry

TOLERANCE = 1e-8  # mm


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
    """Target (n,) that each point is a lattice image of, and the lattice offset (n, 2)."""
    inverse = np.linalg.inv(lattice)
    grid = np.mgrid[-1:2, -1:2].reshape(2, -1).T
    fractions = targets @ inverse
    home = np.floor(fractions)
    cloud = (fractions - home)[None] + grid[:, None]
    base = np.floor(points @ inverse)
    distance, found = cKDTree(cloud.reshape(-1, 2) @ lattice).query(points - base @ lattice)
    assert distance.max() < TOLERANCE, f"a node is {distance.max():.3g} mm from any image"
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
    assert images == canonical(mesh.triangles, mesh.triangle_offsets, covered)

    flat, heights = mesh.scale_positions[:, :2], mesh.scale_positions[:, 2]
    lifted = np.zeros(mesh.n_scale_vertices, dtype=int)
    for z in np.unique(heights):
        level = np.flatnonzero(heights == z)
        lifted[level] = level[images_on_torus(isometry.apply(flat[level]), flat[level],
                                              mesh.lattice)[0]]  # fmt: skip
    for cells in (mesh.base_triangles, mesh.tets, mesh.surface_triangles):
        assert {tuple(sorted(cell)) for cell in lifted[cells].tolist()} == {
            tuple(sorted(cell)) for cell in cells.tolist()
        }


def canonical(triangles: np.ndarray, offsets: np.ndarray, covered: np.ndarray) -> set:
    """Triangles up to lattice shifts and the order of their corners."""
    found = set()
    for corners, places, under in zip(triangles, offsets, covered, strict=True):
        entries = [(int(v), *map(int, place)) for v, place in zip(corners, places, strict=True)]
        shifted = [
            tuple(sorted((v, m - m0, n - n0) for v, m, n in entries)) for _, m0, n0 in entries
        ]
        found.add((min(shifted), bool(under)))
    return found

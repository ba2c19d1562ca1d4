"""Meshes of sheets: areas, counts, boundaries, refusals."""

from __future__ import annotations

import numpy as np
import pytest

from flexscale.errors import MeshError
from flexscale.mesh.sheet import (
    SheetMesh,
    annulus,
    crossed_rectangle,
    disc,
    rectangle,
    staggered_rectangle,
)

MESHES = {
    "crossed": (lambda: crossed_rectangle((0.0, 4.0), (-1.0, 2.0), (4, 3)), 12.0, 1),
    "staggered": (lambda: staggered_rectangle(4.0, 3.0, (5, 4)), 12.0, 1),
    "disc": (lambda: disc(2.0, 12, hub=0.5), 4.0 * np.pi, 1),
    "annulus": (lambda: annulus(1.0, 2.0, (3, 40)), 3.0 * np.pi, 0),
    "slit": (lambda: annulus(1.0, 2.0, (3, 40), slit=True), 3.0 * np.pi, 1),
}


@pytest.mark.parametrize("name", list(MESHES))
def test_area_boundary_and_euler_number(name):
    build, area, euler = MESHES[name]
    mesh = build()
    corners = mesh.points[mesh.triangles]
    areas = 0.5 * np.linalg.det(corners[:, 1:] - corners[:, :1])
    assert areas.sum() == pytest.approx(
        area, rel=0.01 if name in ("disc", "annulus", "slit") else 1e-12
    )
    assert mesh.n_vertices - len(mesh.edges) + len(mesh.triangles) == euler
    assert np.array_equal(np.unique(mesh.triangles), np.arange(mesh.n_vertices))
    # Each boundary is a closed line: every vertex on it has two boundary edges.
    counts = np.bincount(mesh.edges[mesh.boundary].ravel())
    assert set(counts[counts > 0]) == {2}
    ends = np.sort(mesh.edges[mesh.triangle_edges], axis=-1)
    expected = np.stack([mesh.triangles, np.roll(mesh.triangles, -1, axis=1)], axis=-1)
    assert np.array_equal(ends, np.sort(expected, axis=-1))


def test_rectangle_has_about_the_size_asked_for():
    mesh = rectangle(100.0, 50.0, 1.5)
    lengths = np.linalg.norm(np.diff(mesh.points[mesh.edges], axis=1)[:, 0], axis=1)
    assert np.median(lengths) == pytest.approx(1.5, rel=0.02)


def test_disc_has_a_ring_on_its_hub():
    mesh = disc(2.0, 10, hub=0.33)
    assert np.isclose(np.linalg.norm(mesh.points, axis=1), 0.33).any()


@pytest.mark.parametrize(
    ("build", "said"),
    [
        (lambda: annulus(2.0, 1.0, (2, 8)), "outer radius"),
        (lambda: crossed_rectangle((0.0, 1.0), (0.0, 1.0), (0, 2)), "1 or more"),
        (lambda: disc(1.0, 3, hub=2.0), "hub of 2 mm"),
        (lambda: SheetMesh(np.eye(3)[:, :2], np.array([[0, 1, 2], [1, 0, 2]])), "counterclockwise"),
    ],
)
def test_bad_sheets_are_refused(build, said):
    with pytest.raises(MeshError, match=said):
        build()

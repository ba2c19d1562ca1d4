"""Bonds of sheet points to scale bases."""

from __future__ import annotations

import numpy as np
import pytest

from flexscale.errors import MeshError
from flexscale.mesh import build_bonds, build_mesh
from tests.unit.pattern_shapes import SHAPES


@pytest.mark.parametrize("name", list(SHAPES))
def test_linear_fields_are_reproduced(name: str) -> None:
    mesh = build_mesh(SHAPES[name][0])
    carried = mesh.vertex_scale >= 0
    points, scales = mesh.positions[carried], mesh.vertex_scale[carried]
    bonds = build_bonds(mesh, points, scales)
    field = 0.3 + mesh.scale_positions[:, :2] @ np.array([2.0, -1.5])
    rows = np.repeat(np.arange(len(points)), np.diff(bonds.indptr))
    values = np.bincount(rows, bonds.values * field[bonds.scale_vertices])
    assert np.abs(values - (0.3 + points @ np.array([2.0, -1.5]))).max() < 1e-11
    for axis, slope in enumerate((2.0, -1.5)):
        slopes = np.bincount(rows, bonds.gradients[:, axis] * field[bonds.scale_vertices])
        assert np.abs(slopes - slope).max() < 1e-11
    assert (mesh.scale_positions[bonds.scale_vertices, 2] == 0.0).all()


def test_gradient_at_a_base_vertex_is_the_mean_over_its_triangles() -> None:
    mesh = build_mesh(SHAPES["square"][0])
    kink = int(
        np.flatnonzero(np.linalg.norm(mesh.scale_positions - [4.8, 4.8, 0], axis=1) < 1e-9)[0]
    )
    around = mesh.base_triangles[(mesh.base_triangles == kink).any(axis=1)]
    assert len(around) >= 2
    bump = np.zeros(mesh.n_scale_vertices)
    bump[kink] = 1.0
    expected = np.mean([_gradient(mesh.scale_positions[t, :2], bump[t]) for t in around], axis=0)
    bonds = build_bonds(mesh, mesh.scale_positions[[kink], :2], np.array([0]))
    assert np.allclose(bonds.gradients[bonds.scale_vertices == kink][0], expected, atol=1e-12)
    assert bonds.values[bonds.scale_vertices == kink] == pytest.approx(1.0)


def _gradient(corners: np.ndarray, values: np.ndarray) -> np.ndarray:
    return np.linalg.solve(np.column_stack([corners, np.ones(3)]), values)[:2]


def test_point_outside_its_scale_is_refused() -> None:
    mesh = build_mesh(SHAPES["square"][0])
    with pytest.raises(MeshError, match=r"\(4.9, 0\) mm does not lie under scale 0"):
        build_bonds(mesh, np.array([[4.9, 0.0]]), np.array([0]))


def test_no_points() -> None:
    bonds = build_bonds(build_mesh(SHAPES["square"][0]), np.zeros((0, 2)), np.zeros(0, dtype=int))
    assert bonds.indptr.tolist() == [0]
    assert bonds.gradients.shape == (0, 2)

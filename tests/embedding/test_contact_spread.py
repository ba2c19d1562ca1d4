"""Contact pressed over an edge: what touches follows affine motions of the scale exactly."""

from __future__ import annotations

import numpy as np
import pytest

import flexscale as fs
from flexscale.embedding.contact_surface import spread_contact
from flexscale.mesh.patches import fit_affine
from flexscale.mesh.torus import build_mesh

COARSE = fs.MeshOptions(along=4.0, corner=1.0, scale_size=10.0, scale_layers=1)


@pytest.fixture(scope="module")
def mesh():
    return build_mesh(fs.Pattern(fs.Tiling("IH20")), COARSE)


@pytest.mark.parametrize("radius", [0.2, 0.4, 3.0])
def test_affine_motions_are_reproduced(mesh, radius):
    rng = np.random.default_rng(1)
    gradient, shift = rng.standard_normal((3, 3)), rng.standard_normal(3)
    moved = mesh.scale_positions @ gradient.T + shift
    assert np.abs(spread_contact(mesh, radius) @ moved - moved).max() < 1e-9


def test_spread_reaches_no_further_than_the_radius_and_its_elements(mesh):
    spread = spread_contact(mesh, 0.4).tocoo()
    row, column = spread.coords
    arms = mesh.scale_positions[row] - mesh.scale_positions[column]
    edges = mesh.scale_positions[mesh.surface_triangles]
    longest = np.linalg.norm(edges - np.roll(edges, 1, axis=1), axis=2).max()
    reach = np.linalg.norm(arms[spread.data != 0.0], axis=1).max()
    assert 0.4 < reach < 0.4 + longest


def test_no_edge_presses_at_points(mesh):
    spread = spread_contact(mesh, 0.0)
    assert (spread != np.eye(mesh.n_scale_vertices)).sum() == 0


def test_a_flat_patch_in_space_is_fitted_in_its_plane():
    corners = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0], [0, 1, 0]]])
    middle, group = np.array([0.5, 0.5, 0.0]), np.zeros(2, dtype=np.int64)
    forms = fit_affine(corners - middle, group, 0.4, quadratic=False)
    nodes = corners.reshape(-1, 3)
    weights = forms.reshape(-1, 4)
    assert weights[:, 0].sum() == pytest.approx(1.0)
    assert weights[:, 0] @ nodes == pytest.approx([0.5, 0.5, 0.0])
    assert weights[:, 1:].T @ nodes == pytest.approx(np.diag([1.0, 1.0, 0.0]), abs=1e-9)

"""Meshes of a solid substrate: rows on both sides of the outlines, and wedges below them."""

from __future__ import annotations

import numpy as np
import pytest

import flexscale as fs
from flexscale.errors import MeshError
from flexscale.mesh.layers import build_layers, layer_levels
from flexscale.mesh.torus import build_mesh
from flexscale.patterns.named import named_patterns

SIZES = fs.MeshOptions(along=1.6, corner=0.2)
SOLID = fs.SolidOptions(edge=0.06, growth=2.0)


@pytest.mark.parametrize("name", [entry.name for entry in named_patterns()])
def test_edges_at_outlines_have_small_elements_on_both_sides(name: str) -> None:
    """The height of every triangle on an outline is within a fifth of the size asked for, or less;
    under the scales it is just that."""
    mesh = build_mesh(fs.named_pattern(name), SIZES, SOLID)
    outline = np.flatnonzero(mesh.edge_scale >= 0)
    ends = mesh.positions[mesh.edges[:, 1]] + mesh.edge_shift @ mesh.lattice
    length = np.linalg.norm(ends - mesh.positions[mesh.edges[:, 0]], axis=1)
    touches = np.isin(mesh.triangle_edges, outline)
    height = 2.0 * mesh.triangle_areas()[:, None] / length[mesh.triangle_edges]
    covered = np.broadcast_to(mesh.triangle_scale[:, None] >= 0, touches.shape)
    assert height[touches & covered] == pytest.approx(SOLID.edge, rel=0.01)
    assert height[touches & ~covered].max() < 1.2 * SOLID.edge


def test_a_column_of_wedges_below_every_triangle() -> None:
    mesh = build_mesh(fs.named_pattern("hexagon"), SIZES, SOLID)
    layers = build_layers(mesh, layer_levels(0.4, 3, 2.0))
    places = layers.plane[layers.triangles] + layers.offsets @ mesh.lattice
    middles = 0.5 * (places[:, :3] + np.roll(places[:, :3], -1, axis=1))
    assert places[:, 3:] == pytest.approx(middles, abs=1e-9)
    assert places[:, :3] == pytest.approx(layers.corners, abs=1e-12)
    under = np.unique(layers.triangles[mesh.triangle_scale >= 0])
    assert np.array_equal(under, np.flatnonzero(layers.plane_scale >= 0))
    assert layers.n_unknowns == 3 * (7 * layers.n_plane - len(under))


def test_rows_fill_a_width_with_no_more_than_the_sizes_asked_for() -> None:
    assert fs.SolidOptions(0.1, 2.0).n_rows(0.3) == 2
    assert fs.SolidOptions(0.1, 2.0).n_rows(0.31) == 3
    assert fs.SolidOptions(0.1, 1.0).n_rows(0.4) == 4
    finer = fs.SolidOptions(0.06, 2.0).finer(2.0)
    assert (finer.edge, finer.growth) == pytest.approx((0.03, 2.0**0.5))


def test_too_many_rows_are_refused() -> None:
    with pytest.raises(MeshError, match=r"more than 32 rows.*in 0.2 mm.*0.001 mm"):
        build_mesh(fs.named_pattern("square"), SIZES, fs.SolidOptions(0.001, 1.0))

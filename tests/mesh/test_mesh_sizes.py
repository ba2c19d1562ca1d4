"""Element sizes: nodes along chains, across gaps and at tips, strips and layers of scales."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from flexscale.mesh import MeshOptions, build_mesh
from flexscale.mesh.periodic_mesh import FREE
from flexscale.mesh.subdivision import TipSizes, subdivide_chain, subdivide_loop
from flexscale.mesh.tile import find_tip_sizes
from flexscale.patterns import Pattern, named_pattern
from flexscale.tilings import Tiling


def test_elements_across_the_gap() -> None:
    """Along the perpendicular bisector of a wall there is a row of nodes: across + 1 of them."""
    mesh = build_mesh(Pattern(Tiling("IH76")), MeshOptions(across=4, across_grading=2.0))
    middle = np.abs(mesh.positions[:, 1]) < 1e-12
    in_gap = np.abs(np.abs(mesh.positions[:, 0]) - 5.0) < 0.2 + 1e-12
    rows = np.sort(mesh.positions[middle & in_gap, 0] % 10.0)
    assert np.allclose(rows, [4.8, 4.8 + 0.2 / 3.0, 5.0, 5.2 - 0.2 / 3.0, 5.2])


@pytest.mark.parametrize("depths", [[], [0.1], [0.1, 0.3, 0.7]])
def test_strips_along_the_outline_of_a_base(depths: list[float]) -> None:
    """Each strip is twice as wide as the one outside it."""
    options = MeshOptions(scale_rim=0.1, scale_strips=len(depths), scale_growth=2.0, scale_order=1)
    mesh = build_mesh(Pattern(Tiling("IH76")), options)
    base = mesh.scale_positions[np.unique(mesh.base_triangles), :2]
    depth = np.sort(4.8 - np.abs(base).max(axis=1))
    outline = np.count_nonzero(depth < 1e-9)
    for row, expected in enumerate(depths, start=1):
        assert np.allclose(depth[row * outline : (row + 1) * outline], expected)
    deepest = depths[-1] if depths else 0.0
    assert depth[(len(depths) + 1) * outline] > deepest + 0.1


def test_strips_stop_before_an_inset_loses_a_corner() -> None:
    """A notch 0.4 mm wide in the tile: its scale's base has strips no deeper than fits."""
    tile = [(0, 0), (10, 0), (10, 10), (5.3, 10), (5.3, 9.7), (4.7, 9.7), (4.7, 10), (0, 10)]
    tooth = [(4.7, 9.7), (5.3, 9.7), (5.3, 10), (4.7, 10)]
    options = MeshOptions(scale_rim=0.05, scale_strips=3, scale_growth=2.0, scale_order=1)
    pattern = Pattern.from_polygons([tile, tooth], (10, 0), (0, 10), gap=0.1)
    mesh = build_mesh(pattern, options)  # validates itself
    small = np.unique(mesh.base_triangles[mesh.base_scale == 1])
    depth = 0.1 - np.abs(mesh.scale_positions[small, 1] - 9.85)
    assert np.allclose(np.unique(depth.round(9))[:2], [0.0, 0.05])
    assert depth.max() < 0.11


def test_layers_grow_upward() -> None:
    options = MeshOptions(scale_layers=3, layer_growth=2.0, scale_order=1)
    mesh = build_mesh(Pattern(Tiling("IH76")), options)
    heights = np.unique(mesh.scale_positions[:, 2])
    assert np.allclose(heights, np.array([0.0, 1.0, 3.0, 7.0]) * 4.0 / 7.0)


@pytest.mark.parametrize("sharp", [True, False])
@pytest.mark.parametrize("lengths", [[7.0], [2.5, 0.1, 4.4], [1.5, 0.3, 3.4, 0.3, 1.5]])
@pytest.mark.parametrize("tips", [TipSizes(), TipSizes(1.1, 0.2), TipSizes(9.0, 0.15)])
def test_chain_nodes_reverse_with_the_chain(
    sharp: bool, lengths: list[float], tips: TipSizes
) -> None:
    options = MeshOptions()
    there, back = (
        subdivide_chain(np.array(n), sharp, options, tips) for n in (lengths, lengths[::-1])
    )
    n = len(there.along)
    assert np.allclose(there.along[1:], 1.0 - back.along[:0:-1], atol=1e-15)
    assert there.coarse.tolist() == (n - back.coarse[::-1]).tolist()
    corners = np.concatenate([[0.0], np.cumsum(lengths)[:-1]]) / 7.0
    assert np.allclose(there.along[there.fraction == 0.0], corners)
    steps = 7.0 * np.diff(there.along, append=1.0)
    assert steps.max() <= options.along
    if sharp:
        assert steps[0] <= options.corner
        shrunk = steps[0] / options.corner  # to fit the chain's length
        near = 7.0 * there.along + steps < shrunk * tips.reach
        assert (steps[near] <= tips.largest * (1 + 1e-12)).all()
        for one, far in pairwise(steps):
            assert far < one * options.growth * (1 + 1e-12) or far < options.along
    if lengths == lengths[::-1]:
        assert np.abs(there.along - 0.5).min() < 1e-15  # a mirror may cross there


def test_edges_are_fine_until_past_the_tips_of_sharp_scales() -> None:
    """A tip of angle 2 a lies half a gap over tan a along the edge."""
    options = MeshOptions()
    rhombus, square = (named_pattern(name) for name in ("rhombus", "square"))
    assert find_tip_sizes(square.prototiles, [options]) == TipSizes()
    tips = find_tip_sizes(rhombus.prototiles, [options])
    assert tips.reach == pytest.approx(0.2 / np.tan(np.radians(30.0)) + 0.4)
    assert tips.largest == pytest.approx(0.2)
    mesh = build_mesh(rhombus, options)
    free = np.flatnonzero(mesh.vertex_kind == FREE)
    corner = rhombus.prototiles[0].polygon[0]
    arms = rhombus.prototiles[0].polygon[1] - corner
    along = (mesh.positions[free] - corner) @ arms / np.linalg.norm(arms)
    off = np.abs((mesh.positions[free] - corner) @ [-arms[1], arms[0]])
    on_edge = np.sort(along[(off < 1e-9) & (along > -1e-9)])
    assert np.diff(on_edge[on_edge < tips.reach]).max() <= tips.largest * (1 + 1e-9)
    assert np.diff(on_edge).max() > 2.0 * tips.largest


def test_nodes_of_a_curve_are_graded_as_on_a_straight_edge() -> None:
    """Corners of a fine curve are its only nodes, and those of a coarse one the fewest."""
    options = MeshOptions(corner=0.25, growth=1.6)
    straight = len(subdivide_chain(np.array([12.0]), True, options).along)
    for n_edges in (2, 5, 10):
        nodes = subdivide_chain(np.full(n_edges, 12.0 / n_edges), True, options)
        assert straight <= len(nodes.along) <= straight + n_edges + 1
    fine = subdivide_chain(np.full(100, 0.12), True, options)
    assert len(fine.along) == 100
    assert len(fine.coarse) < 20


def test_rounding_of_a_length_moves_no_node_of_the_base() -> None:
    """Wishes midway between two nodes: congruent chains must still agree on the nearest."""
    options = MeshOptions(along=0.5, corner=0.5, growth=1.0, scale_size=1.0, scale_growth=1.0)
    for half in np.linspace(3.0, 9.0, 37):
        lengths = 2.0 * half * (1.0 + np.arange(-8, 9) * 2.3e-16)
        found = {tuple(subdivide_chain(np.array([x]), True, options).coarse) for x in lengths}
        assert len(found) == 1


def test_loop_without_sharp_corners_has_nodes_in_the_middle_of_every_edge() -> None:
    angles = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    circle = 5.0 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    nodes = subdivide_loop(circle, np.zeros(24, dtype=bool), MeshOptions())
    assert np.allclose(nodes.fraction.reshape(24, 2), [0.0, 0.5])
    assert np.array_equal(nodes.coarse, np.arange(48))

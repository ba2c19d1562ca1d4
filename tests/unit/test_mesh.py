"""Periodic meshes: a torus without gaps, scales on it, and how the two meet."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from flexscale.errors import MeshError, UnitRangeError
from flexscale.mesh import MeshOptions, PeriodicMesh, build_bare_mesh, build_mesh
from flexscale.mesh.periodic_mesh import FREE
from flexscale.mesh.subdivision import TipSizes, subdivide_chain, subdivide_loop
from flexscale.mesh.tile import find_tip_sizes
from flexscale.patterns import Pattern, named_pattern
from flexscale.patterns.cell import polygon_area
from flexscale.tilings import Tiling
from tests.unit.pattern_shapes import SHAPES

OPTIONS = {
    "coarse": MeshOptions(along=1.0, corner=0.2, scale_size=2.5),
    "fine": MeshOptions(across=6, along=0.5, across_grading=1.5, scale_size=1.0, scale_layers=3),
}


@pytest.fixture(scope="module", params=[(n, o) for n in SHAPES for o in OPTIONS], ids="-".join)
def meshed(request: pytest.FixtureRequest) -> tuple[Pattern, PeriodicMesh]:
    name, options = request.param
    pattern = SHAPES[name][0]
    return pattern, build_mesh(pattern, OPTIONS[options])


def test_sheet_is_a_torus(meshed: tuple[Pattern, PeriodicMesh]) -> None:
    """Each edge has two triangles, in opposite directions; the Euler characteristic is 0."""
    _, mesh = meshed
    assert mesh.euler_characteristic == 0
    start = mesh.triangles
    a_here = mesh.edges[mesh.triangle_edges, 0]
    offset_here = (mesh.triangle_edge_offsets == mesh.triangle_offsets).all(axis=2)
    forward = (start == a_here) & offset_here
    directions = np.bincount(mesh.triangle_edges.ravel(), np.where(forward, 1, -1).ravel())
    assert not directions.any()
    assert (np.bincount(mesh.triangle_edges.ravel()) == 2).all()


def test_edges_join_the_corners_they_say(meshed: tuple[Pattern, PeriodicMesh]) -> None:
    _, mesh = meshed
    a, b = mesh.edges[mesh.triangle_edges].transpose(2, 0, 1)
    from_a = mesh.positions[a] + mesh.triangle_edge_offsets @ mesh.lattice
    to_b = mesh.triangle_edge_offsets + mesh.edge_shift[mesh.triangle_edges]
    from_b = mesh.positions[b] + to_b @ mesh.lattice
    corners = mesh.corner_positions()
    middles = 0.5 * (corners + np.roll(corners, -1, axis=1))
    assert np.abs(0.5 * (from_a + from_b) - middles).max() < 1e-12
    lengths = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    assert np.abs(np.linalg.norm(from_a - from_b, axis=2) - lengths).max() < 1e-12


def test_areas_and_volumes(meshed: tuple[Pattern, PeriodicMesh]) -> None:
    pattern, mesh = meshed
    areas = mesh.triangle_areas()
    assert (areas > 0.0).all()
    assert areas.sum() == pytest.approx(pattern.cell_area, rel=1e-12)
    assert (mesh.tet_volumes() > 0.0).all()
    for scale, outline in enumerate(pattern.outlines()):
        area = polygon_area(outline)
        assert areas[mesh.triangle_scale == scale].sum() == pytest.approx(area, rel=1e-9)
        assert mesh.base_areas()[mesh.base_scale == scale].sum() == pytest.approx(area, rel=1e-9)
        volume = mesh.tet_volumes()[mesh.tet_scale == scale].sum()
        assert volume == pytest.approx(area * pattern.scale_height, rel=1e-9)


def test_surface_encloses_each_scale(meshed: tuple[Pattern, PeriodicMesh]) -> None:
    """The divergence theorem gives the volume, so normals point outward and nothing is missing."""
    _, mesh = meshed
    corners = mesh.scale_positions[mesh.surface_triangles]
    signed = np.linalg.det(corners) / 6.0
    for scale in range(mesh.n_scales):
        volume = mesh.tet_volumes()[mesh.tet_scale == scale].sum()
        assert signed[mesh.surface_scale == scale].sum() == pytest.approx(volume, rel=1e-9)
    assert (corners[..., 2] >= 0.0).all()
    assert (corners[..., 2] <= mesh.scale_height).all()


def test_vertices_know_their_scale(meshed: tuple[Pattern, PeriodicMesh]) -> None:
    """Kinds follow from the triangles around a vertex; carried vertices sit at home."""
    _, mesh = meshed
    covered = mesh.triangle_scale >= 0
    n = mesh.n_vertices
    n_covered = np.bincount(mesh.triangles[covered].ravel(), minlength=n)
    n_free = np.bincount(mesh.triangles[~covered].ravel(), minlength=n)
    assert ((mesh.vertex_kind == 0) == (n_covered == 0)).all()
    assert ((mesh.vertex_kind == 3) == (n_free == 0)).all()
    assert ((mesh.vertex_scale == -1) == (mesh.vertex_kind == 0)).all()
    owner = np.repeat(mesh.triangle_scale[covered], 3)
    assert (mesh.vertex_scale[mesh.triangles[covered].ravel()] == owner).all()
    assert not mesh.triangle_offsets[covered].any()


def test_outline_edges_close_around_each_scale(meshed: tuple[Pattern, PeriodicMesh]) -> None:
    """Outline edges add up to the outline's length, turn at kinks only, and carry the tangent."""
    pattern, mesh = meshed
    on_outline = mesh.edge_scale >= 0
    a, b = mesh.edges[on_outline].T
    assert not mesh.edge_shift[on_outline].any()
    arms = mesh.positions[b] - mesh.positions[a]
    lengths = np.linalg.norm(arms, axis=1)
    for scale, outline in enumerate(pattern.outlines()):
        own = mesh.edge_scale[on_outline] == scale
        around = np.linalg.norm(np.roll(outline, -1, axis=0) - outline, axis=1).sum()
        assert lengths[own].sum() == pytest.approx(around, rel=1e-9)
        kinks = mesh.positions[(mesh.vertex_kind == 2) & (mesh.vertex_scale == scale)]
        apart = np.linalg.norm(kinks[:, None] - outline, axis=2)
        assert len(kinks) == len(outline)
        assert apart.min(axis=0).max() < 1e-9
    smooth = mesh.vertex_kind == 1
    sizes = np.linalg.norm(mesh.outline_tangent, axis=1)
    assert np.allclose(sizes, np.where(smooth, 1.0, 0.0))
    for ends in (a, b):
        here = smooth[ends]
        tangents = mesh.outline_tangent[ends[here]]
        cross = tangents[:, 0] * arms[here, 1] - tangents[:, 1] * arms[here, 0]
        assert np.abs(cross).max() < 1e-9


def test_sheet_edges_on_an_outline_lie_within_one_base_edge(
    meshed: tuple[Pattern, PeriodicMesh],
) -> None:
    _, mesh = meshed
    base = mesh.base_triangles[:, :3]
    sides = np.stack([base, np.roll(base, -1, axis=1)], axis=-1)
    sides = sides.reshape(-1, 2)
    _, where, counts = np.unique(
        np.sort(sides, axis=1), axis=0, return_index=True, return_counts=True
    )
    start, end = mesh.scale_positions[sides[where[counts == 1]], :2].transpose(1, 0, 2)
    for edge in np.flatnonzero(mesh.edge_scale >= 0):
        points = mesh.positions[mesh.edges[edge]]
        distances = [_distance_to_segments(point, start, end) for point in points]
        assert (np.maximum(*distances) < 1e-9).any()


def _distance_to_segments(point: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    arms = end - start
    shares = np.sum((point - start) * arms, axis=1) / np.sum(arms**2, axis=1)
    nearest = start + np.clip(shares, 0.0, 1.0)[:, None] * arms
    return np.linalg.norm(point - nearest, axis=1)


def test_default_square_cell_is_small() -> None:
    mesh = build_mesh(Pattern(Tiling("IH76")))
    assert 100 <= (mesh.triangle_scale < 0).sum() <= 300
    assert mesh.n_scale_vertices < 20000  # they cost set-up only: scales move by few modes


@pytest.mark.parametrize("digits", [3, 4, 5, 6, 7, 9])
def test_polygons_typed_with_few_digits(digits: int) -> None:
    """Two hexagons whose typed corners miss each other, or their congruence, in the last digit."""
    hexagon = Pattern(Tiling("IH20"))
    (t1, t2), tile = hexagon.lattice, hexagon.tiles[0]
    tiles = [np.round(tile, digits), np.round(tile + t2, digits)]
    pattern = Pattern.from_polygons(tiles, np.round(t1, digits), np.round(2.0 * t2, digits))
    mesh = build_mesh(pattern, OPTIONS["coarse"])
    assert mesh.n_scales == 2
    assert (mesh.vertex_kind == 2).sum() == 12


def test_same_options_give_the_same_bits() -> None:
    pattern = Pattern(Tiling("IH20"))
    first, second = build_mesh(pattern), build_mesh(pattern)
    for name in PeriodicMesh.__dataclass_fields__:
        assert np.array_equal(getattr(first, name), getattr(second, name)), name


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
    assert find_tip_sizes(square.prototiles, square.gap, options) == TipSizes()
    tips = find_tip_sizes(rhombus.prototiles, rhombus.gap, options)
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


def test_validate_finds_a_turned_triangle() -> None:
    mesh = build_mesh(Pattern(Tiling("IH76")))
    triangles = mesh.triangles.copy()
    triangles[0] = triangles[0, ::-1]
    offsets = mesh.triangle_offsets.copy()
    offsets[0] = offsets[0, ::-1]
    with pytest.raises(MeshError, match="turned over"):
        replace(mesh, triangles=triangles, triangle_offsets=offsets).validate()


def test_validate_finds_a_missing_triangle() -> None:
    mesh = build_bare_mesh([[10.0, 0.0], [5.0, 9.0]], 3.0)
    cut = {name: getattr(mesh, name)[1:] for name in
           ("triangles", "triangle_offsets", "triangle_scale", "triangle_edges",
            "triangle_edge_offsets")}  # fmt: skip
    with pytest.raises(MeshError, match="does not have exactly two triangles"):
        replace(mesh, **cut).validate()


@pytest.mark.parametrize("size", [0.5, 3.0, 20.0])
def test_bare_sheet(size: float) -> None:
    mesh = build_bare_mesh([[10.0, 0.0], [5.0, 9.0]], size)
    mesh.validate()
    assert mesh.n_scales == 0
    assert not mesh.vertex_kind.any()
    corners = mesh.corner_positions()
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max()
    assert longest <= 1.2 * size


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        ({"across": 3}, MeshError, "even number"),
        ({"across": 0}, MeshError, "even number"),
        ({"across": "two"}, UnitRangeError, "must be a number"),
        ({"scale_layers": 1.5}, MeshError, "whole number"),
        ({"growth": 0.9}, MeshError, "at least 1"),
        ({"scale_growth": 0.5}, MeshError, "scale_growth is 0.5"),
        ({"scale_strips": -1}, MeshError, "0 or more"),
        ({"scale_rim": 0.0}, UnitRangeError, "scale_rim is 0 mm"),
        ({"layer_growth": -1.0}, UnitRangeError, "layer_growth is -1"),
        ({"scale_layers": 0}, MeshError, "1 or more"),
        ({"along": 0.0}, UnitRangeError, "along is 0 mm"),
        ({"corner": -0.1}, UnitRangeError, "corner is -0.1 mm"),
        ({"scale_size": float("nan")}, UnitRangeError, "finite"),
    ],
)
def test_options_out_of_range(options: dict, error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        MeshOptions(**options)


def test_finer_options() -> None:
    options = MeshOptions(along=1.0, across=2, scale_layers=3, growth=1.44, scale_strips=1)
    assert MeshOptions(**options.to_config()) == options
    finer = options.finer(2.0)
    assert (finer.across, finer.along, finer.scale_layers) == (4, 0.5, 6)
    assert finer.growth == pytest.approx(1.2)
    assert (finer.scale_rim, finer.scale_corner) == (0.5 * options.scale_rim, 0.3)
    assert finer.scale_strips == 2
    assert finer.layer_growth**2 == pytest.approx(options.layer_growth)
    assert options.finer(1.0) == options

"""Periodic meshes: a torus without gaps, scales on it, and how the two meet."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexscale.errors import MeshError, UnitRangeError
from flexscale.mesh import MeshOptions, PeriodicMesh, build_bare_mesh, build_mesh
from flexscale.patterns import Pattern
from flexscale.patterns.cell import polygon_area
from flexscale.tilings import Tiling
from tests.patterns.pattern_shapes import SHAPES

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
        ({"across": 0}, UnitRangeError, r"across is 0, .* between 2 and 64\."),
        ({"across": "two"}, UnitRangeError, "must be a number"),
        ({"scale_layers": 1.5}, UnitRangeError, "whole number"),
        ({"growth": 0.9}, UnitRangeError, r"growth is 0\.9, .* between 1 and 1000\."),
        ({"scale_growth": 0.5}, UnitRangeError, r"scale_growth is 0\.5, .* between 1 and 1000\."),
        ({"scale_strips": -1}, UnitRangeError, r"scale_strips is -1, .* between 0 and 64\."),
        ({"scale_rim": 0.0}, UnitRangeError, "scale_rim is 0 mm"),
        ({"layer_growth": -1.0}, UnitRangeError, "layer_growth is -1"),
        ({"scale_layers": 0}, UnitRangeError, r"scale_layers is 0, .* between 1 and 64\."),
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

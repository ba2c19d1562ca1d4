"""Patterns: outlines, symmetries, junctions, configuration."""

from __future__ import annotations

import json
from itertools import product

import numpy as np
import pytest
import shapely

from flexscale.patterns import TPU, NeoHookean, Pattern
from flexscale.patterns.cell import build_cell, polygon_area
from flexscale.patterns.outlines import inset_edges
from flexscale.tilings import Tiling
from flexscale.tilings.drawn_symmetry import drawn_symmetry
from tests.patterns.pattern_shapes import BRICK, SHAPES, SQUARE, custom

NAMES = list(SHAPES)


@pytest.mark.parametrize("name", NAMES)
def test_scales_are_one_gap_apart(name: str) -> None:
    """Smallest distance between any two scales of the plane is the gap."""
    pattern = SHAPES[name][0]
    outlines = pattern.outlines()
    distances = [
        shapely.Polygon(a).distance(shapely.Polygon(b + offset @ pattern.lattice))
        for (i, a), (j, b) in product(enumerate(outlines), repeat=2)
        for offset in np.array(list(product((-2, -1, 0, 1, 2), repeat=2)))
        if i != j or offset.any()
    ]
    assert min(distances) == pytest.approx(pattern.gap, rel=1e-6)


@pytest.mark.parametrize("name", NAMES)
def test_copies_carry_prototiles_onto_tiles(name: str) -> None:
    pattern, orders = SHAPES[name]
    assert [len(prototile.stabiliser) for prototile in pattern.prototiles] == orders
    for tile, copy in zip(pattern.tiles, pattern.copies, strict=True):
        image = copy.placement.apply(pattern.prototiles[copy.prototile].polygon)
        nearest = np.linalg.norm(image[:, None] - tile, axis=2).min(axis=1)
        assert nearest.max() < 1e-12
    assert sum(map(polygon_area, pattern.tiles)) == pytest.approx(pattern.cell_area, rel=1e-12)


def test_paper_values_are_the_defaults() -> None:
    pattern = Pattern(Tiling("IH76"))
    assert (pattern.gap, pattern.scale_height, pattern.substrate_thickness) == (0.4, 4.0, 0.4)
    assert (pattern.name, pattern.tile_area) == ("square", 100.0)
    assert np.allclose(pattern.outlines()[0], np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * 4.8)
    assert polygon_area(Pattern(Tiling("IH20")).tiles[0]) == pytest.approx(100.0, rel=1e-13)


@pytest.mark.parametrize("family", ["IH20", "IH76", "IH07", "IH54", "IH93"])
def test_pattern_stands_on_the_primitive_cell(family: str) -> None:
    tiling = Tiling(family)
    repeats = drawn_symmetry(tiling.tiles, tiling.lattice).n_primitive_cells
    pattern = Pattern(tiling, tile_area=49.0)
    assert pattern.n_scales * repeats == len(tiling.tiles)
    assert pattern.symmetry().n_primitive_cells == 1
    assert pattern.cell_area == pytest.approx(49.0 * pattern.n_scales, rel=1e-12)
    if family in ("IH20", "IH76"):  # what does not repeat stays as it was, to the last bit
        given = build_cell([7.0 * tile for tile in tiling.tiles], 7.0 * tiling.lattice)
        assert np.array_equal(pattern.lattice, given.lattice)
        assert np.array_equal(pattern.tiles[0], given.tiles[0])


def test_corners_in_the_middle_of_straight_edges_are_inserted() -> None:
    tile = custom([BRICK], (10, 0), (5, 5)).tiles[0]
    assert tile.tolist() == [[0, 0], [5, 0], [10, 0], [10, 5], [5, 5], [0, 5]]


def test_orientation_of_input_does_not_matter() -> None:
    forward = custom([BRICK], (10, 0), (5, 5))
    backward = custom([BRICK[:1] + BRICK[:0:-1]], (5, 5), (10, 0))
    assert np.linalg.det(backward.lattice) > 0.0
    assert {tuple(corner) for corner in backward.tiles[0]} == {
        tuple(corner) for corner in forward.tiles[0]
    }
    assert polygon_area(backward.tiles[0]) > 0.0


def test_corners_typed_with_six_digits_are_merged() -> None:
    third = 3.333333
    tiles = [
        [(0, 0), (10, 0), (10, third), (0, third)],
        [(0, 3.3333334), (10, 3.3333334), (10, 10), (0, 10)],
    ]
    pattern = custom(tiles, (10, 0), (0, 10))
    low, high = (np.unique(tile[:, 1]) for tile in pattern.tiles)
    assert low[1] == high[0]


@pytest.mark.parametrize("name", NAMES)
def test_configuration_rebuilds_the_pattern_bit_for_bit(name: str) -> None:
    pattern = SHAPES[name][0]
    again = Pattern.from_config(json.loads(json.dumps(pattern.to_config())))
    assert again == pattern
    assert all(np.array_equal(a, b) for a, b in zip(again.tiles, pattern.tiles, strict=True))


@pytest.mark.parametrize("name", ["square", "brick"])
def test_changed_copy(name: str) -> None:
    pattern = SHAPES[name][0]
    soft = pattern.with_(gap=0.6, scale_material=TPU)
    assert (soft.gap, soft.scale_material, soft.name) == (0.6, TPU, pattern.name)
    assert soft.outlines()[0][:, 0].min() == pytest.approx(pattern.tiles[0][:, 0].min() + 0.3)
    assert pattern.gap == 0.4


def test_bond_radius_is_twice_the_thickness_unless_given() -> None:
    pattern = SHAPES["square"][0]
    assert pattern.bond_radius == 0.8
    assert pattern.with_(substrate_thickness=0.6).bond_radius == 1.2
    narrow = pattern.with_(bond_radius=0.1)
    assert narrow.with_(substrate_thickness=0.6).bond_radius == 0.1
    assert narrow.to_config()["bond_radius"] == 0.1
    assert narrow != pattern
    assert pattern.with_(bond_radius=0.0).bond_radius == 0.0


def test_pattern_cannot_be_changed_in_place() -> None:
    pattern = custom([SQUARE], (10, 0), (0, 10))
    with pytest.raises(AttributeError, match=r"with_\(gap=…\)"):
        pattern.gap = 1.0
    with pytest.raises(ValueError, match="read-only"):
        pattern.tiles[0][0, 0] = 1.0


def test_lame_constants() -> None:
    steel = NeoHookean(young_modulus=210e3, poisson_ratio=0.3)
    assert steel.shear_modulus == pytest.approx(80769.2308)
    assert steel.lame_lambda == pytest.approx(121153.8462)


def wavy_square(n_points: int) -> Pattern:
    """Tile with two mirrors: fine U curves on all four sides."""
    x = np.linspace(0.0, 0.5, n_points)
    wave = np.stack([x, 0.1 * np.sin(np.pi * x) ** 2], axis=1)
    return Pattern(Tiling("IH73", edges={"a": wave}))


def test_outlines_of_fine_curves_are_as_symmetric_as_the_tile() -> None:
    pattern = wavy_square(60)
    assert pattern.symmetry().group == "p4g"
    prototile = pattern.prototiles[0]
    assert len(prototile.stabiliser) == 4
    assert len(prototile.outline) >= len(prototile.polygon) - 20
    for isometry in prototile.stabiliser:
        image = isometry.apply(prototile.outline)
        apart = np.linalg.norm(image[:, None] - prototile.outline, axis=2).min(axis=1)
        assert apart.max() < 1e-10


@pytest.mark.parametrize("inset", [0.2, 0.5, 1.5])
def test_images_of_edges_in_an_inset(inset: float) -> None:
    """They lie parallel to the edges at the distance, each starting where the one before ends."""
    polygon = wavy_square(12).tiles[0]
    images = inset_edges(polygon, inset)
    assert images is not None
    assert np.allclose(images[:, 1], np.roll(images[:, 0], -1, axis=0), atol=1e-9)
    along = np.roll(polygon, -1, axis=0) - polygon
    tangents = along / np.linalg.norm(along, axis=1)[:, None]
    normals = np.stack([-tangents[:, 1], tangents[:, 0]], axis=1)
    lengths = np.sum((images[:, 1] - images[:, 0]) * tangents, axis=1)
    kept = lengths > 0.0
    full = np.linalg.norm(images[:, 1] - images[:, 0], axis=1)
    assert np.allclose(full[kept], lengths[kept], rtol=1e-4)  # corners may stand for short images
    depths = np.sum((images - polygon[:, None]) * normals[:, None], axis=2)
    assert np.allclose(depths[kept], inset, atol=0.01 * inset)
    assert (inset < 0.3) == kept.all()
    inside = shapely.Polygon(polygon).buffer(-0.99 * inset)
    assert all(inside.contains(shapely.Point(point)) for point in images[:, 0])


def test_no_images_of_edges_where_an_inset_falls_apart() -> None:
    waist = [(0, 0), (4, 0), (4, 3), (6, 3), (6, 0), (10, 0), (10, 8), (6, 8), (6, 5), (4, 5),
             (4, 8), (0, 8)]  # fmt: skip
    assert inset_edges(np.array(waist, dtype=float), 0.9) is not None
    assert inset_edges(np.array(waist, dtype=float), 1.1) is None
    assert inset_edges(np.array(SQUARE), 5.1) is None


def test_corners_that_say_nothing_are_dropped() -> None:
    square = [(0, 0), (3, 0), (10, 0), (10, 10), (3, 10), (0, 10)]
    assert len(custom([square], (10, 0), (0, 10)).tiles[0]) == 4
    brick = custom([BRICK], (10, 0), (4, 5)).tiles[0]
    assert len(brick) == 6  # three tiles meet at the corners in the middle of its edges

"""Patterns: outlines, symmetries, junctions, configuration."""

from __future__ import annotations

import json
from itertools import product

import numpy as np
import pytest
import shapely

from flexscale.patterns import TPU, NeoHookean, Pattern
from flexscale.patterns.cell import polygon_area
from flexscale.tilings import Tiling
from flexscale.tilings.drawn_symmetry import drawn_symmetry
from tests.unit.pattern_shapes import BRICK, SHAPES, SQUARE, custom

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
        given = Pattern.from_polygons([7.0 * tile for tile in tiling.tiles], *7.0 * tiling.lattice)
        assert np.array_equal(pattern.lattice, given.lattice)
        assert np.array_equal(pattern.tiles[0], given.tiles[0])


def test_corners_in_the_middle_of_straight_edges_are_inserted() -> None:
    tile = custom([BRICK], (10, 0), (5, 5)).tiles[0]
    assert tile.tolist() == [[0, 0], [5, 0], [10, 0], [10, 5], [5, 5], [0, 5]]


def test_orientation_of_input_does_not_matter() -> None:
    forward = custom([BRICK], (10, 0), (5, 5))
    backward = custom([BRICK[::-1]], (5, 5), (10, 0))
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

"""The symmetry of drawn tilings: groups, axes, operations, primitive cells, refusals."""

from __future__ import annotations

import numpy as np
import pytest

from flexscale.errors import TilingError, UnitRangeError
from flexscale.patterns import Pattern
from flexscale.tilings import Tiling
from flexscale.tilings.congruence import same_outline
from flexscale.tilings.drawn_symmetry import drawn_symmetry, primitive_cell
from tests.tilings.drawn_tilings import CAIRO, DRAWN, HEX, box, hexagon, turned
from tests.tilings.wallpaper_samples import (
    AXES,
    GENERATORS,
    ROTATION_ORDER,
    general_position,
    orbit_tiling,
)

SECTOR_WIDTH = {"p3": 60, "p4": 90, "p6": 60, "p3m1": 30, "p31m": 30, "p4m": 45, "p4g": 45,
                "p6m": 30, "p1": 180, "p2": 180}  # fmt: skip
POINTS = np.array([(0.13, 0.21), (0.38, 0.07), (0.71, 0.83)])


@pytest.mark.parametrize("group", GENERATORS)
def test_every_group_is_told_apart(group: str) -> None:
    symmetry = drawn_symmetry(*orbit_tiling(group, POINTS))
    assert symmetry.group == group
    centerings = 2 if group in ("cm", "cmm") else 1
    assert symmetry.n_primitive_cells == centerings
    assert symmetry.point_group_order == len(general_position(group)) // centerings
    assert symmetry.rotation_order == ROTATION_ORDER[group]
    mirrors, glides = AXES.get(group, ([], []))
    assert symmetry.mirror_axes == pytest.approx(mirrors, abs=1e-9)
    assert symmetry.glide_axes == pytest.approx(glides, abs=1e-9)
    width = SECTOR_WIDTH.get(group, 90)
    assert symmetry.sector == pytest.approx((0, width, bool(mirrors or glides)), abs=1e-9)


@pytest.mark.parametrize("name", DRAWN)
def test_well_known_tilings(name: str) -> None:
    tiles, lattice, group, n_cells, sector = DRAWN[name]
    symmetry = drawn_symmetry(tiles, lattice)
    assert symmetry.group == group
    assert symmetry.n_primitive_cells == n_cells
    assert symmetry.sector == pytest.approx(sector, abs=1e-9)


@pytest.mark.parametrize("name", DRAWN)
def test_operations_carry_the_edges_onto_edges(name: str) -> None:
    """Middles of edges, corners merged out: each lies on some tile's edge after the isometry."""
    tiles, lattice, *_ = DRAWN[name]
    lattice = np.array(lattice, dtype=float)
    grid = np.mgrid[-5:6, -5:6].reshape(2, -1).T @ lattice
    corners = [np.array(tile, dtype=float) for tile in tiles]
    starts = np.concatenate(corners)
    edges = np.concatenate([np.roll(tile, -1, axis=0) - tile for tile in corners])
    for operation in drawn_symmetry(tiles, lattice).operations:
        images = operation.apply(starts + 0.37 * edges)
        images -= np.floor(images @ np.linalg.inv(lattice)) @ lattice
        arms = images[:, None, None] - (starts[None] + grid[:, None])[None]
        along = np.clip(np.sum(arms * edges, axis=-1) / np.sum(edges**2, axis=-1), 0.0, 1.0)
        distance = np.linalg.norm(arms - along[..., None] * edges, axis=-1)
        assert distance.min(axis=(1, 2)).max() < 1e-12 * np.abs(lattice).max() * 100


def test_operations_of_the_square() -> None:
    symmetry = drawn_symmetry([box(-0.5, -0.5, 1, 1)], np.eye(2))
    kinds = [(operation.kind, operation.angle) for operation in symmetry.operations]
    assert kinds == [("rotation", angle) for angle in (0, 90, 180, 270)] + [
        ("mirror", axis) for axis in (0, 45, 90, 135)
    ]
    for operation in symmetry.operations:
        assert set(np.unique(operation.linear)) <= {-1.0, 0.0, 1.0}
    assert np.array_equal(symmetry.primitive_lattice, np.eye(2))


def test_a_coset_of_mirrors_is_not_called_glide() -> None:
    """Whatever translate of the mirror is stored: a mirror through a tile beside the origin."""
    tiles, lattice, *_ = DRAWN["stacked bricks"]
    symmetry = drawn_symmetry([np.array(tile) + np.array((2.9, 1.3)) for tile in tiles], lattice)
    assert [operation.kind for operation in symmetry.operations] == ["rotation"] * 2 + [
        "mirror"
    ] * 2


@pytest.mark.parametrize("name", DRAWN)
def test_translations_lie_in_the_primitive_cell(name: str) -> None:
    tiles, lattice, *_ = DRAWN[name]
    symmetry = drawn_symmetry([turned(tile, 33.0) for tile in tiles], turned(lattice, 33.0))
    for operation in symmetry.operations:
        fractions = operation.translation @ np.linalg.inv(symmetry.primitive_lattice)
        assert np.all((fractions > -1e-8) & (fractions < 1.0 - 1e-10))


def test_axes_turn_with_the_tiling() -> None:
    """A brick's mirrors at 20° and 110°."""
    tiles, lattice, *_ = DRAWN["running bond"]
    symmetry = drawn_symmetry([turned(tile, 20.0) for tile in tiles], turned(lattice, 20.0))
    assert symmetry.mirror_axes == pytest.approx((20.0, 110.0), abs=1e-10)
    assert symmetry.sector == pytest.approx((20.0, 110.0, True), abs=1e-10)


def test_a_corner_off_by_little_breaks_the_symmetry_and_by_nothing_does_not() -> None:
    for off, group in ((1e-9, "p4g"), (1e-3, "p1")):
        tiles = [tile.copy() for tile in CAIRO]
        tiles[0][1, 0] += off  # overlaps its neighbor by as much: the drawing is what is asked for
        assert drawn_symmetry(tiles, [(6, 0), (0, 6)]).group == group


def test_digits_somebody_typed_need_a_tolerance() -> None:
    tiles, lattice = [np.round(hexagon(), 3)], np.round(HEX, 3)
    assert drawn_symmetry(tiles, lattice).group == "cmm"
    assert drawn_symmetry(tiles, lattice, tolerance=3e-3).group == "p6m"


def test_one_odd_tile_makes_the_cell_primitive() -> None:
    """Two bricks of four, one above the other, are merged into one and cut the other way."""
    tiles = [box(0, 0, 2, 1), box(2, 0, 2, 1), box(0, 1, 2, 1), box(2, 1, 2, 1)]
    assert drawn_symmetry(tiles, [(4, 0), (0, 2)]).n_primitive_cells == 4
    tiles[0], tiles[2] = box(0, 0, 1, 2), box(1, 0, 1, 2)
    symmetry = drawn_symmetry(tiles, [(4, 0), (0, 2)])
    assert (symmetry.n_primitive_cells, symmetry.group) == (1, "pmm")


def test_a_corner_given_twice_with_noise_is_walked_back_over() -> None:
    square = box(0, 0, 4, 4)
    doubled = np.insert(square, 1, [(2.0, 0.0), (2.0 - 1e-9, 0.0)], axis=0)
    assert same_outline(doubled, square, 1e-6)
    assert same_outline(square, doubled, 1e-6)


@pytest.mark.parametrize(
    ("center", "same"), [((0.0, 0.0), True), ((0.3, 0.0), False), ((0.0, 1e-9), True)]
)
def test_outlines_through_the_same_corners(center: tuple[float, float], same: bool) -> None:
    """A dart has its inner corner between two of three others: between which makes the shape."""
    a, b, c = turned([(4, 0)], 90), turned([(4, 0)], 210), turned([(4, 0)], 330)
    dart = np.concatenate([a, b, [(0.0, 0.0)], c])
    assert same_outline(dart, np.concatenate([[center], c, a, b]), 1e-6) == same
    assert not same_outline(dart, np.concatenate([a, b, c, [center]]), 1e-6)


def test_outlines_that_take_a_short_cut_differ() -> None:
    """All corners of one lie on the other, in order; only one of them goes round the notch."""
    notched = np.array([(0, 0), (4, 0), (4, 4), (3, 4), (2, 3), (1, 4), (0, 4)], dtype=float)
    plain = notched[[0, 1, 2, 3, 5, 6]]
    assert not same_outline(plain, notched, 1e-6)
    assert not same_outline(notched, plain, 1e-6)


def test_primitive_cell_keeps_the_first_tile_of_every_class() -> None:
    tiles = [box(x + y, y, 10, 5) for y in (0, 5) for x in (0, 10)]
    kept, lattice = primitive_cell(tiles, [(20, 0), (0, 10)])
    assert len(kept) == 1
    assert np.array_equal(kept[0], tiles[0])
    assert np.allclose(lattice, [(5, 5), (-5, 5)])
    assert drawn_symmetry(kept, lattice).group == "cmm"


def test_primitive_cell_leaves_a_primitive_one_alone() -> None:
    given = np.array([(9.0, 0.0), (12.0, 5.0)])
    kept, lattice = primitive_cell([box(0, 0, 9, 5)], given)
    assert np.array_equal(lattice, given)
    assert np.array_equal(kept[0], box(0, 0, 9, 5))


@pytest.mark.parametrize("name", ["cairo", "running bond, two rows", "pinwheel 3"])
def test_patterns_have_the_symmetry_of_their_tiles(name: str) -> None:
    tiles, lattice, group, n_cells, sector = DRAWN[name]
    pattern = Pattern.from_polygons(tiles, *lattice, gap=0.01)
    symmetry = pattern.symmetry()
    assert (symmetry.group, symmetry.n_primitive_cells) == (group, n_cells)
    assert symmetry.sector == pytest.approx(sector, abs=1e-9)
    smaller, primitive = primitive_cell(pattern.tiles, pattern.lattice)
    again = Pattern.from_polygons(smaller, *primitive, gap=0.01)
    assert again.n_scales * n_cells == pattern.n_scales
    assert (again.symmetry().group, again.symmetry().n_primitive_cells) == (group, 1)


@pytest.mark.parametrize(("family", "sector"), [("IH76", (0, 45, True)), ("IH20", (0, 30, True))])
def test_sectors_of_the_default_patterns(family: str, sector: tuple[float, float, bool]) -> None:
    assert Pattern(Tiling(family)).symmetry().sector == sector


@pytest.mark.parametrize(
    ("tiles", "lattice", "words"),
    [
        ([], np.eye(2), "three or more"),
        ([[(0, 0), (1, 0)]], np.eye(2), "three or more"),
        ([[(0, 0), (1, 0), ("a", 1)]], np.eye(2), "three or more"),
        ([[(0, 0), (1, 0), (np.nan, 1)]], np.eye(2), "finite"),
        ([box(0, 0, 1, 1)], [(1, 0)], "two .x, y. vectors"),
        ([box(0, 0, 1, 1)], [(1, 0), (2, 0)], "add up to 1, but the lattice's cell has 0"),
        ([box(0, 0, 1, 1)], [(1, 0), (0, 2)], "add up to 1, but the lattice's cell has 2"),
    ],
)
def test_refusals(tiles, lattice, words: str) -> None:
    with pytest.raises(TilingError, match=words):
        drawn_symmetry(tiles, lattice)
    with pytest.raises(TilingError, match=words):
        primitive_cell(tiles, lattice)


def test_tolerance_must_be_positive() -> None:
    with pytest.raises(UnitRangeError, match="tolerance is 0"):
        drawn_symmetry([box(0, 0, 1, 1)], np.eye(2), tolerance=0.0)

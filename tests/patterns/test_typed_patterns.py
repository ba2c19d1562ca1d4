"""Polygons as users have them: far from the origin, typed with few digits, nearly symmetric."""

from __future__ import annotations

import logging

import numpy as np
import pytest

import flexscale as fs
from flexscale.errors import PatternError
from flexscale.patterns import Pattern
from flexscale.patterns.cell import polygon_area
from flexscale.patterns.typed_cell import say_once
from tests.patterns.pattern_shapes import BRICK, SQUARE, custom

RADIUS = 10.0 / np.sqrt(1.5 * np.sqrt(3.0))  # of a hexagon of 100 mm²
HEXAGON = RADIUS * np.array([(np.cos(a), np.sin(a)) for a in np.radians(60.0 * np.arange(6))])
HEXAGONAL = RADIUS * np.array([(1.5, np.sqrt(0.75)), (0.0, np.sqrt(3.0))])
COARSE = fs.MeshOptions(scale_layers=2, scale_size=6, scale_strips=1, across=2)


def moved(pattern: Pattern, tiles) -> float:
    """Largest distance between corners given and those of the pattern, mm."""
    start = np.array(tiles[0], dtype=float)[0]
    return max(
        float(np.linalg.norm(ours - (np.array(given) - start), axis=1).max())
        for ours, given in zip(pattern.tiles, tiles, strict=True)
    )


@pytest.mark.parametrize(
    "move", [(-3.7, 2.2), (3000.0, 4000.0), (1e4, 0.0), (192800.123, 231454.456), (-1e6, 1e6)]
)
def test_a_moved_pattern_is_the_same_pattern(move: tuple[float, float]) -> None:
    tiles = [BRICK, [(15, 0), (20, 0), (20, 10), (15, 10)]]
    here = custom(tiles, (20, 0), (5, 5))
    there = custom([np.array(tile) + move for tile in tiles], (20, 0), (5, 5))
    assert there.to_config() == here.to_config()
    assert there == here
    for one, other in zip(here.tiles, there.tiles, strict=True):
        assert np.array_equal(one, other)


def test_tiles_listed_cells_away_are_brought_near() -> None:
    near = custom([SQUARE, np.add(SQUARE, (10.0, 0.1))], (20, 0), (0, 10))
    far = custom([SQUARE, np.add(SQUARE, (10.0 + 20e3, 0.1 - 10e3))], (20, 0), (0, 10))
    assert far == near


def test_long_thin_cells_are_as_quick() -> None:
    """Sheared lattices have the same points; counting images must not grow with the shear."""
    assert len(custom([SQUARE], (10, 0), (9e8, 10)).tiles) == 1


def test_no_digits_left() -> None:
    small = 0.01 * np.array(SQUARE)
    with pytest.raises(PatternError, match=r"hold 5e-07 mm, too coarse .* nearer to the origin"):
        custom([small + 9e8], (0.1, 0), (0, 0.1), gap=0.01)


def test_area_far_from_the_origin() -> None:
    assert polygon_area(np.array(SQUARE) + 1e9) == 100.0


@pytest.mark.parametrize("digits", [3, 4, 5, 6, 9, 12, 15])
def test_a_hexagon_typed_with_some_digits_is_regular(digits: int) -> None:
    tile = np.round(HEXAGON, digits)
    pattern = custom([tile], *np.round(HEXAGONAL, digits))
    symmetry = pattern.symmetry()
    assert symmetry.group == "p6m"
    assert set(symmetry.mirror_axes) == {0.0, 30.0, 60.0, 90.0, 120.0, 150.0}
    assert len(pattern.prototiles[0].stabiliser) == 12
    assert moved(pattern, [tile]) <= max(10.0**-digits, 1e-8)
    edges = np.linalg.norm(np.roll(pattern.tiles[0], -1, axis=0) - pattern.tiles[0], axis=1)
    assert np.ptp(edges) < 1e-12


@pytest.mark.parametrize("digits", [3, 4])
def test_isosceles_triangles(digits: int) -> None:
    """Turned, so that no digit of them is exact."""
    turn = np.array([[0.8, 0.6], [-0.6, 0.8]]) @ np.array([[0.28, 0.96], [-0.96, 0.28]])
    for height, group in ((8.0, "cmm"), (5.0 * np.sqrt(3.0), "p6m")):
        tiles = [[(0, 0), (10, 0), (5, height)], [(10, 0), (15, height), (5, height)]]
        typed = [np.round(np.array(tile) @ turn, digits) for tile in tiles]
        lattice = np.round(np.array([(10, 0), (5, height)]) @ turn, digits)
        assert custom(typed, *lattice).symmetry().group == group


@pytest.mark.parametrize(("width", "height"), [(10.0, 11.0), (10.0, 9.9), (10.0, 9.99)])
def test_rectangles_are_no_squares(width: float, height: float) -> None:
    tile = np.array([(0, 0), (width, 0), (width, height), (0, height)])
    pattern = custom([tile], (width, 0), (0, height))
    assert pattern.symmetry().group == "pmm"
    assert moved(pattern, [tile]) == 0.0


def test_nearly_symmetric_is_told_and_made_so(caplog: pytest.LogCaptureFixture) -> None:
    """Digits that promise more than the numbers hold."""
    drawn_out = np.array((1.0, 1.00005))
    tile, lattice = (HEXAGON * drawn_out).round(6), (HEXAGONAL * drawn_out).round(6)
    say_once.cache_clear()
    with caplog.at_level(logging.WARNING):
        pattern = custom([tile], *lattice, gap=0.5)
    assert "nearly p6m, off by 0.000" in caplog.text
    assert "`symmetrize` makes it exact" in caplog.text
    assert pattern.symmetry().group == "cmm"
    caplog.clear()
    exact = pattern.symmetrize()
    assert exact == custom([tile], *lattice, gap=0.5, symmetrize=True)
    assert (exact.symmetry().group, exact.gap) == ("p6m", 0.5)
    assert len(exact.prototiles[0].stabiliser) == 12
    assert Pattern.from_config(exact.to_config()).symmetry().group == "p6m"
    assert moved(exact, [tile]) < 1e-3


def test_symmetrize_leaves_what_has_no_more_symmetry() -> None:
    pattern = custom([[(0, 0), (10, 0), (13, 8), (3, 8)]], (10, 0), (3, 8))
    assert pattern.symmetrize() == pattern


def test_supercells_typed_with_few_digits_are_exact() -> None:
    third = [np.round(np.array(SQUARE) * (1 / 3, 1) + (k * 10 / 3, 0), 3) for k in range(3)]
    pattern = custom(third, (10, 0), (0, 10))
    symmetry = pattern.symmetry()
    assert (symmetry.group, symmetry.n_primitive_cells) == ("pmm", 3)
    assert len(pattern.prototiles) == 1
    assert moved(pattern, third) <= 1e-3


def test_lattice_with_more_digits_than_the_tiles() -> None:
    pattern = custom([HEXAGON.round(4)], *HEXAGONAL)
    assert pattern.symmetry().group == "p6m"


def shifted_rows(shift: float) -> Pattern:
    """2 x 30 bricks, every second row of which is shifted [mm], typed with 4 decimals."""
    starts = [(10 * column + shift * (row % 2), 10 * row) for row in range(30) for column in (0, 1)]
    tiles = [np.round(np.add(SQUARE, start), 4) for start in starts]
    return custom(tiles, (20, 0), (0, 300))


@pytest.mark.parametrize(
    ("shift", "corners", "said"),
    [
        (0.0001, 4, ""),
        (0.0002, 4, "differ by 0.0002 mm are taken for one point, typed to 0.0001 mm: those"),
        (0.0003, 4, "differ by 0.0003 mm are taken for one point, typed to 0.0001 mm: those"),
        (0.0005, 6, "nearly p4m, off by 0.0003 mm, and is computed as pmg"),
    ],
)
def test_corners_that_differ_by_more_than_rounding_are_told_when_made_one(
    shift: float, corners: int, said: str, caplog: pytest.LogCaptureFixture
) -> None:
    say_once.cache_clear()
    with caplog.at_level(logging.WARNING):
        tiles = [tile for _ in range(2) for tile in shifted_rows(shift).tiles]
    assert {len(tile) for tile in tiles} == {corners}
    assert len(caplog.records) == bool(said)
    assert said in caplog.text


ROOT = np.sqrt(57.0)
# The pentagon of type 14 as it is published: heights to 5 or 6 decimals, widths exact.
TYPE_14 = [
    [((ROOT - 3) / 8, 3.51623), ((3 * ROOT - 9) / 8, 1.87118), (1, 0), (0, 0), (0, 2.6937)],
    [((3 - ROOT) / 8, 3.51623), ((9 - 3 * ROOT) / 8, 1.87118), (-1, 0), (0, 0), (0, 2.6937)],
    [((1 + ROOT) / 4, -1.64505), (1, 0), ((3 * ROOT - 9) / 8, 1.87118),
     ((3 * ROOT - 1) / 8, 1.87118), ((3 * ROOT - 1) / 8, -0.822525)],
    [((ROOT - 1) / 2, -1.64505), ((3 * ROOT - 5) / 4, 0), ((7 + 3 * ROOT) / 8, 1.87118),
     ((3 * ROOT - 1) / 8, 1.87118), ((3 * ROOT - 1) / 8, -0.822525)],
    [((7 + 3 * ROOT) / 8, 1.87118), ((3 * ROOT - 9) / 8, 1.87118), ((ROOT - 3) / 8, 3.51623),
     ((ROOT - 3) / 4, 4.33875), ((31 + 3 * ROOT) / 16, 2.80676)],
    [(-1, 0), (1, 0), ((1 + ROOT) / 4, -1.64505), ((5 + ROOT) / 8, -2.46757),
     (3 * (ROOT - 11) / 16, -0.935588)],
]  # fmt: skip
TYPE_14_LATTICE = np.array([((1 - ROOT) / 2, 4.33875), ((21 + ROOT) / 16, 5.27434)])


@pytest.mark.parametrize(("size", "digits"), [(1.0, 4), (1.0, 5), (1.0, 15), (5.0, 4)])
def test_published_pentagons(size: float, digits: int) -> None:
    tiles = [np.round(size * np.array(tile), digits) for tile in TYPE_14]
    pattern = custom(tiles, *np.round(size * TYPE_14_LATTICE, digits), gap=0.1)
    assert pattern.symmetry().group == "p2"
    assert pattern.symmetry().n_primitive_cells == 1


def test_tangent_of_typed_hexagons_is_isotropic() -> None:
    pattern = custom([HEXAGON.round(3)], *HEXAGONAL.round(3))
    stiffness = fs.tangent_stiffness(pattern, model=fs.NativeModel("shell", mesh=COARSE)).stiffness
    values = [stiffness(angle) for angle in (0.0, 11.0, 45.0, 90.0)]
    assert np.ptp(values) < 1e-8 * np.mean(values)


def test_tangent_of_squares_far_from_the_origin() -> None:
    near, far = (
        fs.tangent_stiffness(
            custom([np.array(SQUARE) + move], (10, 0), (0, 10)),
            model=fs.NativeModel("shell", mesh=COARSE),
        )
        for move in (0.0, (192800.0, 231454.0))
    )
    assert far.stiffness(0.0) == near.stiffness(0.0)

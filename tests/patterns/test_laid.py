"""Patterns laid on sheets: pieces cover the sheet, whole scales are the pattern's, cut ones fit."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
import shapely

import flexscale as fs
from flexscale.errors import PatternError
from flexscale.patterns import overlay
from flexscale.patterns.laid import SLIVER, LaidPattern, disc, lay_pattern, on_line, rectangle
from flexscale.patterns.outlines import SHORTEST
from flexscale.patterns.pattern import Pattern
from tests.sampling import every

NAMES = every(3, [entry.name for entry in fs.named_patterns()])
SHEET = rectangle(60.0, 30.0)
#: Direction, degree, and offset, mm.
PLACES = [(0.0, (0.0, 0.0)), (37.0, (3.0, -2.0)), (90.0, (1.0, 0.5))]


def polygons(outlines) -> np.ndarray:
    return np.array([shapely.Polygon(outline) for outline in outlines])


def in_pattern(points: np.ndarray, laid: LaidPattern, offset: tuple[float, float]) -> np.ndarray:
    """Points (n, 2) of the sheet in the pattern's coordinates."""
    middle = 0.5 * (laid.border.min(axis=0) + laid.border.max(axis=0))
    x, y = (points - middle).T
    turned = (x + 1j * y) * np.exp(1j * np.radians(laid.direction))
    return np.stack([turned.real, turned.imag], axis=1) + offset


def whole_outlines(laid: LaidPattern) -> list[np.ndarray]:
    return [outline for outline, whole in zip(laid.outlines, laid.whole, strict=True) if whole]


def spots(laid: LaidPattern) -> set[tuple[float, float]]:
    """Where the scales are, and how large, so that sheets can be compared."""
    return {
        (*np.round(shapely.centroid(one).coords[0], 6) + 0.0, round(one.area, 6))
        for one in polygons(laid.outlines)
    }


def lies_on_lattice(way: np.ndarray, pattern: Pattern) -> bool:
    steps = np.linalg.solve(pattern.lattice.T, way)
    return bool(np.abs(steps - np.round(steps)).max() < 1e-9)


@pytest.mark.parametrize(("direction", "offset"), PLACES)
@pytest.mark.parametrize("border", [SHEET, disc(30.0, 2.0)], ids=["rectangle", "disc"])
@pytest.mark.parametrize("name", NAMES)
def test_tiles_and_bare_pieces_are_the_sheet(
    name: str, border: np.ndarray, direction: float, offset: tuple[float, float]
) -> None:
    """Their areas add up, and all of them together leave nothing out: none lies on another."""
    laid = lay_pattern(fs.named_pattern(name), border, direction, offset)
    pieces = polygons([*laid.tiles, *laid.bare])
    assert laid.area == pytest.approx(shapely.Polygon(border).area, rel=1e-12)
    assert shapely.area(pieces).sum() == pytest.approx(laid.area, rel=1e-12)
    assert overlay.union(pieces).area == pytest.approx(laid.area, rel=1e-9)
    assert len(laid.tiles) == len(laid.outlines) == len(laid.whole)
    assert all(shapely.is_ccw(piece.exterior) for piece in pieces)


@pytest.mark.parametrize(("direction", "offset"), PLACES)
@pytest.mark.parametrize("name", NAMES)
def test_whole_scales_are_those_of_the_turned_and_moved_pattern(
    name: str, direction: float, offset: tuple[float, float]
) -> None:
    pattern = fs.named_pattern(name)
    laid = lay_pattern(pattern, SHEET, direction, offset)
    known, counts = pattern.outlines(), np.zeros(pattern.n_scales, dtype=int)
    for outline in whole_outlines(laid):
        there = in_pattern(outline, laid, offset)
        same = [
            k
            for k, one in enumerate(known)
            if one.shape == there.shape
            and lies_on_lattice(there[0] - one[0], pattern)
            and np.allclose(there - there[0], one - one[0], rtol=0.0, atol=1e-9)
        ]
        assert len(same) == 1
        counts[same] += 1
    # As many as lie within the sheet, those aside that reach to its border but for rounding.
    edge = in_pattern(laid.border, laid, offset)
    within, about = (shapely.Polygon(edge).buffer(w, join_style="mitre") for w in (-1e-6, 1e-6))
    ways = np.array(list(product(range(-12, 13), repeat=2))) @ pattern.lattice
    for count, tile in zip(counts, pattern.tiles, strict=True):
        placed = shapely.polygons(tile + ways[:, None])
        assert shapely.covers(within, placed).sum() <= count <= shapely.covers(about, placed).sum()
    assert counts.sum() == laid.whole.sum() > 2


def test_whole_tiles_are_congruent() -> None:
    laid = lay_pattern(fs.named_pattern("chevron"), SHEET, 20.0)
    assert laid.whole.any()
    assert not laid.whole.all()
    areas, lengths = (measure(polygons(laid.tiles)) for measure in (shapely.area, shapely.length))
    assert areas[laid.whole] == pytest.approx(100.0, rel=1e-12)
    assert np.ptp(lengths[laid.whole]) < 1e-9
    assert areas[~laid.whole].max() < 100.0


def test_the_direction_is_that_of_the_length_in_the_pattern() -> None:
    """Bricks lie along the sheet at 0 degree and across it at 90; at 30 they lie at -30."""
    for direction in (0.0, 30.0, 90.0):
        (long, *_) = whole_outlines(lay_pattern(fs.named_pattern("brick"), SHEET, direction))
        sides = np.roll(long, -1, axis=0) - long
        longest = sides[np.linalg.norm(sides, axis=1).argmax()]
        found = np.degrees(np.arctan2(longest[1], longest[0])) % 180.0
        assert found == pytest.approx(-direction % 180.0, abs=1e-9)


def test_the_offset_is_the_point_in_the_middle() -> None:
    pattern = fs.named_pattern("pinwheel3")
    center = pattern.outlines()[0].mean(axis=0) + pattern.lattice[1]
    moved = [lay_pattern(pattern, SHEET, 25.0, center + way) for way in (0.0, pattern.lattice[0])]
    middles = np.array([outline.mean(axis=0) for outline in moved[0].outlines])
    assert np.linalg.norm(middles - [30.0, 15.0], axis=1).min() < 1e-9
    assert spots(moved[0]) == spots(moved[1])
    assert spots(moved[0]) != spots(lay_pattern(pattern, SHEET, 25.0, 1.01 * center))


@pytest.mark.parametrize("border", [SHEET, disc(30.0, 2.0)], ids=["rectangle", "disc"])
@pytest.mark.parametrize("name", NAMES)
def test_scales_keep_half_a_gap_from_the_border_and_a_gap_from_each_other(
    name: str, border: np.ndarray
) -> None:
    pattern = fs.named_pattern(name, gap=0.5)
    laid = lay_pattern(pattern, border, 37.0, (3.0, -2.0))
    scales, tiles = polygons(laid.outlines), polygons(laid.tiles)
    assert shapely.covers(tiles, scales).all()
    # Short edges that the inset leaves of cut tiles are one corner.
    within = np.where(laid.whole, 1e-9, SHORTEST * 0.25)
    from_tiles = shapely.distance(scales, shapely.get_exterior_ring(tiles))
    assert (np.abs(from_tiles - 0.25) <= within).all()
    from_border = shapely.distance(scales, shapely.Polygon(border).exterior)
    assert (from_border >= 0.25 - within).all()
    assert np.median(from_border[~laid.whole]) == pytest.approx(0.25, abs=1e-6)
    first, second = shapely.STRtree(scales).query(scales, predicate="dwithin", distance=0.6)
    apart = shapely.distance(scales[first], scales[second])[first != second]
    assert apart.min() == pytest.approx(0.5, abs=SHORTEST * 0.25)


@pytest.mark.parametrize("name", NAMES)
def test_slivers_stay_bare_and_nothing_else(name: str) -> None:
    """What is bare would have a smaller scale than a twentieth of a tile, or one in parts."""
    pattern = fs.named_pattern(name)
    for direction, offset in PLACES:
        laid = lay_pattern(pattern, SHEET, direction, offset)
        least = SLIVER * pattern.tile_area
        assert shapely.area(polygons(laid.outlines)).min() > least
        for piece in polygons(laid.bare):
            scale = piece.buffer(-0.5 * pattern.gap, join_style="mitre")
            assert scale.geom_type == "MultiPolygon" or scale.area <= least


@pytest.mark.parametrize(("rest", "n_scales"), [(0.92, 3), (0.93, 9)])
def test_the_least_scale_is_a_twentieth_of_a_tile(rest: float, n_scales: int) -> None:
    """Rows of 10 mm beside squares, scales 9.6 mm long: 4.99 and 5.09 mm2 of 100."""
    laid = lay_pattern(fs.named_pattern("square"), rectangle(30.0, 10.0 + 2.0 * rest))
    assert (len(laid.tiles), len(laid.bare)) == (n_scales, 9 - n_scales)
    assert shapely.area(polygons(laid.bare)).sum() == pytest.approx((9 - n_scales) * 10.0 * rest)


def test_a_piece_with_a_neck_stays_bare() -> None:
    """A chevron cut near its tip is two legs that hang together by less than the gap."""
    laid = lay_pattern(fs.named_pattern("chevron"), SHEET, 90.0)
    insets = [piece.buffer(-0.2, join_style="mitre") for piece in polygons(laid.bare)]
    in_parts = [inset for inset in insets if inset.geom_type == "MultiPolygon"]
    assert max(inset.area for inset in in_parts) > SLIVER * 100.0


@pytest.mark.parametrize(
    ("border", "size"),
    [
        (rectangle(2.0, 2.0), "2 x 2 mm"),
        (rectangle(60.0, 0.3), "60 x 0.3 mm"),
        (rectangle(60.0, 0.9), "60 x 0.9 mm"),
        (disc(1.0, 0.5), "2 x 2 mm"),
    ],
)
def test_sheets_of_slivers_alone_are_refused(border: np.ndarray, size: str) -> None:
    with pytest.raises(PatternError, match=f"A sheet of {size} cuts all scales .* to slivers"):
        lay_pattern(fs.named_pattern("square"), border)
    assert len(lay_pattern(fs.named_pattern("square"), rectangle(60.0, 1.0)).tiles) > 0


def test_a_disc_has_the_symmetries_of_patterns() -> None:
    border = disc(30.0, 2.0)
    assert np.linalg.norm(border, axis=1) == pytest.approx(30.0, rel=1e-12)
    sides = np.linalg.norm(np.roll(border, -1, axis=0) - border, axis=1)
    assert 1.5 < sides.min() <= sides.max() < 2.0
    assert len(border) % 12 == 0
    assert len(disc(1.0, 50.0)) == 12
    x, y = border.T
    for degrees in (60.0, 90.0):
        turned = (x + 1j * y) * np.exp(1j * np.radians(degrees))
        assert np.abs(turned[:, None] - (x + 1j * y)).min(axis=1).max() < 1e-9
    assert np.abs((x - 1j * y)[:, None] - (x + 1j * y)).min(axis=1).max() < 1e-9


def test_hexagons_on_a_disc_are_the_same_every_sixty_degrees() -> None:
    laid = lay_pattern(fs.named_pattern("hexagon"), disc(30.0, 2.0))
    assert (len(laid.tiles), laid.whole.sum()) == (37, 19)
    places = np.array([shapely.centroid(one).coords[0] for one in polygons(laid.outlines)])
    z = places @ [1.0, 1j]
    assert np.abs((z * np.exp(1j * np.pi / 3.0))[:, None] - z).min(axis=1).max() < 1e-9


def test_tiles_that_end_at_an_end_have_an_edge_there() -> None:
    laid = lay_pattern(fs.named_pattern("square"), rectangle(45.0, 30.0), 0.0, (2.5, 0.0))
    at_ends = [sum(on_line(tile, x) for tile in laid.tiles) for x in (0.0, 45.0, 22.5)]
    assert at_ends == [3, 3, 0]
    corner = np.array([[0.0, 0.0], [3.0, -1.0], [3.0, 1.0]])
    assert not on_line(corner, 0.0)
    assert on_line(corner, 3.0)

"""Walls, grooves and plans of printable sheets."""

from __future__ import annotations

import re

import numpy as np
import pytest
import shapely
import shapely.affinity

import flexscale as fs
from flexscale.errors import FabricationError, UnitRangeError, UnknownNameError
from flexscale.fabricate import Disc, Grooves, Layout, Printer, Rectangle
from flexscale.fabricate.grooves import groove_rings
from flexscale.fabricate.plan import build_plan
from flexscale.fabricate.shapes import circle_points
from flexscale.fabricate.walls import (
    GRID,
    is_printable,
    lost_fins,
    opened,
    polygonal,
    smallest_wall,
    without_thin_parts,
)
from flexscale.patterns.overlay import difference, union
from tests.sampling import every

NAMES = every(3, [entry.name for entry in fs.named_patterns()])
SQUARE = fs.named_pattern("square")
SMALL = Rectangle(60.0, 40.0)


def plan(pattern=SQUARE, shape=SMALL, layout=None, grooves=None, printer=None):
    return build_plan(
        pattern, shape, layout or Layout(), grooves or Grooves(), printer or Printer()
    )


def needle(degrees: float) -> shapely.Polygon:
    """Isosceles triangle with this angle at its tip, 10 mm long."""
    half = 10.0 * np.tan(np.deg2rad(0.5 * degrees))
    return shapely.Polygon([(0.0, 0.0), (10.0, -half), (10.0, half)])


def test_walls_of_plain_shapes() -> None:
    dumbbell = shapely.union_all(
        [shapely.box(0, 0, 5, 5), shapely.box(4, 2, 9, 2.7), shapely.box(8, 0, 13, 5)]
    )
    finned = shapely.union(shapely.box(0, 0, 5, 5), shapely.box(5, 2, 8, 2.3))
    ring = shapely.difference(shapely.box(0, 0, 6, 6), shapely.box(0.5, 1, 5, 5))
    plain = shapely.box(0, 0, 9, 1.3)
    for start in (0.2, 0.4):
        assert smallest_wall([plain], start) == pytest.approx(1.3, abs=1e-3)
        assert smallest_wall([dumbbell], start) == pytest.approx(0.7, abs=1e-3)
        assert smallest_wall([finned], start) == pytest.approx(0.3, abs=1e-3)
        assert smallest_wall([ring], start) == pytest.approx(0.5, abs=1e-3)
        assert smallest_wall([plain, finned], start) == pytest.approx(0.3, abs=1e-3)
    assert np.isnan(smallest_wall([], 0.4))


def test_corners_are_no_walls_but_needles_are() -> None:
    assert is_printable(needle(33.0), 0.4)
    assert not is_printable(needle(25.0), 0.4)


@pytest.mark.parametrize("width", [0.1, 0.2, 0.25, 0.3, 0.35])
@pytest.mark.parametrize("length", [0.3, 0.45, 0.6])
def test_short_fins_are_thin_too(width: float, length: float) -> None:
    """Their tips lie nearer to the middle of a bead than those of sharp corners do."""
    block = shapely.box(0, 0, 5, 5)
    finned = shapely.union(block, shapely.box(5, 2, 5 + length, 2 + width))
    turned = shapely.affinity.rotate(finned, 33.0)
    for area in (finned, turned):
        assert not is_printable(area, 0.4)
        assert smallest_wall([area], 0.4) == pytest.approx(width, abs=0.02)
    assert without_thin_parts(finned, 0.4).area == pytest.approx(block.area, abs=2e-3)
    wide = shapely.union(block, shapely.box(5, 2, 5 + length, 2.42))
    assert without_thin_parts(wide, 0.4) is wide
    # What sticks out by less than half a bead is a bump, not a fin.
    assert is_printable(shapely.union(block, shapely.box(5, 2, 5.15, 2 + width)), 0.4)


@pytest.mark.parametrize("degrees", [30.0, 45.0, 60.0, 90.0, 100.0])
def test_corners_are_no_fins(degrees: float) -> None:
    tip = needle(degrees)
    for wall in (0.4, 0.8):
        assert lost_fins(tip, wall) == []
        assert lost_fins(tip.difference(shapely.box(-1, -1, 0.1, 1)), wall) == []  # blunted


def test_a_scale_with_a_fin_is_refused() -> None:
    """Tabs of 0.7 x 0.5 mm at a gap of 0.4 mm: fins of 0.3 mm on the scales."""
    tab = [(10.0, 4.0), (10.5, 4.0), (10.5, 4.7), (10.0, 4.7)]
    notch = [(x - 10.0, y) for x, y in reversed(tab)]
    tile = [(0.0, 0.0), (10.0, 0.0), *tab, (10.0, 10.0), (0.0, 10.0), *notch]
    pattern = fs.Pattern.from_polygons([tile], (10.0, 0.0), (0.0, 10.0))
    with pytest.raises(
        FabricationError, match=r"a fin or a needle of 0\.[23]\d* mm, below .* 0\.4"
    ):
        plan(pattern)
    assert plan(pattern, printer=Printer(nozzle=0.25)).n_whole > 0


def test_thin_parts_are_cut_off_and_nothing_else() -> None:
    block = shapely.box(0, 0, 5, 5)
    assert without_thin_parts(block, 0.4) is block
    left = without_thin_parts(shapely.union(block, shapely.box(5, 2, 8, 2.3)), 0.4)
    assert shapely.symmetric_difference(left, block).area < 1e-3
    blunt = without_thin_parts(needle(20.0), 0.4)
    assert is_printable(blunt, 0.4)
    assert 0.98 < blunt.area / needle(20.0).area < 1.0
    assert without_thin_parts(shapely.box(0, 0, 9, 0.3), 0.4) is None


def test_rings_of_a_square_have_the_areas_of_squares() -> None:
    rings = groove_rings(shapely.box(-5, -5, 5, 5), Grooves(width=0.8, pitch=2.0, margin=1.0))
    sides = [(8.0, 6.4), (4.0, 2.4)]
    assert [ring.area for ring in rings] == pytest.approx([a**2 - b**2 for a, b in sides], rel=2e-3)
    assert all(len(ring.interiors) == 1 for ring in rings)
    assert groove_rings(shapely.box(-5, -5, 5, 5), Grooves(depth=0.0)) == []
    assert groove_rings(shapely.box(-1, -5, 1, 5), Grooves()) == []


def substrate_between(base, rings):
    """What stands of the substrate between the grooves under one scale."""
    return list(shapely.get_parts(polygonal(difference(base, union(rings)))))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    "grooves", [Grooves(), Grooves(0.4, 0.8, 0.3), Grooves(1.1, 1.7, 0.1, 0.5)], ids=str
)
def test_neither_grooves_nor_what_is_between_gets_thinner_than_asked(
    name: str, grooves: Grooves
) -> None:
    for prototile in fs.named_pattern(name).prototiles:
        base = shapely.Polygon(prototile.outline)
        rings = groove_rings(base, grooves)
        assert len(rings) >= 2
        assert smallest_wall(rings, 0.4) >= grooves.width
        between = substrate_between(base, rings)
        assert smallest_wall(between, 0.4) >= min(grooves.spacing, grooves.first)
        nearest = min(shapely.distance(base.exterior, ring) for ring in rings)
        assert nearest == pytest.approx(grooves.first, abs=8 * GRID)


@pytest.mark.parametrize("name", NAMES)
def test_grooves_of_cut_pieces_are_as_wide(name: str) -> None:
    pieces = plan(fs.named_pattern(name), Disc(45.0, hub=8.0)).scales
    rings = [ring for scale in pieces if not scale.whole for ring in scale.grooves]
    assert len(rings) > 10
    assert smallest_wall(rings, 0.8 - GRID) >= 0.8 - GRID
    between = [
        area
        for scale in pieces
        if not scale.whole
        for area in substrate_between(scale.outline, scale.grooves)
    ]
    assert smallest_wall(between, 0.4) >= 0.4


def test_parts_that_a_neck_joins_do_not_join_again() -> None:
    arms = [shapely.box(0, 0, 4, 4), shapely.box(4.3, 0, 7, 4), shapely.box(3, 1.8, 5, 2.2)]
    left = opened(shapely.union_all(arms), 0.8, 0.2)
    assert [part.area for part in left.geoms] == pytest.approx([16.0, 10.8], rel=1e-3)
    apart = opened(shapely.union_all(arms), 0.8, 0.5)
    assert [part.area for part in apart.geoms] == pytest.approx([16.0], rel=1e-3)


@pytest.mark.parametrize("name", NAMES)
def test_whole_scales_are_the_simulated_outlines(name: str) -> None:
    pattern = fs.named_pattern(name)
    layout = Layout(direction=27.0, center=(3.0, -1.0))
    scales = [scale for scale in plan(pattern, layout=layout).scales if scale.whole]
    turn = np.deg2rad(27.0)
    back = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    outlines = pattern.outlines()
    assert {scale.tile for scale in scales} == set(range(pattern.n_scales))
    for scale in scales:
        corners = shapely.get_coordinates(scale.outline)[:-1] @ back.T + (3.0, -1.0)
        wanted = outlines[scale.tile]
        assert len(corners) == len(wanted)
        steps = (corners.mean(axis=0) - wanted.mean(axis=0)) @ np.linalg.inv(pattern.lattice)
        assert np.abs(steps - np.rint(steps)).max() < 1e-4
        shift = np.rint(steps) @ pattern.lattice
        gaps = np.linalg.norm(corners[:, None] - (wanted + shift)[None], axis=2)
        assert gaps.min(axis=1).max() < 1.5 * GRID
        assert gaps.min(axis=0).max() < 1.5 * GRID


def test_scales_of_a_square_sheet_are_counted() -> None:
    # Squares of 10 mm around the origin: 5 x 3 of them lie in 60 x 40 mm, 24 at the border are cut.
    middle = np.mean(SQUARE.tiles[0], axis=0)
    layout = Layout(center=tuple(middle))
    found = plan(layout=layout)
    assert (found.n_whole, len(found.scales), found.n_removed) == (15, 35, 0)
    areas = sorted(scale.outline.area for scale in found.scales)
    half, quarter = 9.6 * 4.8, 4.8**2
    assert areas == pytest.approx([quarter] * 4 + [half] * 16 + [9.6**2] * 15, rel=1e-4)
    whole = plan(layout=Layout(center=tuple(middle), border="whole"))
    assert (whole.n_whole, len(whole.scales), whole.n_left_out) == (15, 15, 20)
    large = plan(layout=Layout(center=tuple(middle), smallest_area=30.0))
    assert (len(large.scales), large.n_removed) == (31, 4)


def test_direction_turns_the_pattern_against_the_sheet() -> None:
    brick = fs.named_pattern("brick")
    lengths = []
    for layout in (Layout(), Layout(direction=90.0)):
        scale = next(scale for scale in plan(brick, layout=layout).scales if scale.whole)
        left, low, right, high = scale.outline.bounds
        lengths.append((right - left, high - low))
    assert lengths[0] == pytest.approx(lengths[1][::-1], abs=1e-3)
    assert lengths[0][0] != pytest.approx(lengths[0][1], abs=1.0)


def test_cut_pieces_end_at_the_border_and_keep_the_gap() -> None:
    disc = Disc(30.0, hub=8.0)
    found = plan(fs.named_pattern("arrowhead"), disc)
    region = disc.scaled_region().buffer(2 * GRID)
    outlines = [scale.outline for scale in found.scales]
    assert all(shapely.covers(region, outline) for outline in outlines)
    assert found.smallest_wall(0.4) >= 0.4
    gaps = shapely.STRtree(outlines).query_nearest(outlines, exclusive=True, return_distance=True)
    assert gaps[1].min() == pytest.approx(0.4, abs=2 * GRID)
    tiles = shapely.union_all(outlines)
    hidden = shapely.area(tiles) / shapely.area(region)
    assert 0.8 < hidden < 0.95


def test_round_holes_let_the_pin_pass() -> None:
    around, inside = circle_points(2.0, outside=True), circle_points(2.0, outside=False)
    middles = 0.5 * (around + np.roll(around, 1, axis=0))
    assert np.linalg.norm(middles, axis=1) == pytest.approx(np.full(len(around), 2.0))
    assert np.linalg.norm(inside, axis=1) == pytest.approx(np.full(len(inside), 2.0))
    assert np.linalg.norm(around, axis=1).max() < 2.01


REFUSED = [
    (
        "gap of pattern 'square' is 0.3 mm, narrower than the nozzle of 0.4 mm",
        {"pattern": SQUARE.with_(gap=0.3)},
    ),
    (
        "0.5 mm deep, but the substrate is 0.4 mm thick .* depth of 0.3 mm at most",
        {"grooves": Grooves(depth=0.5)},
    ),
    ("one layer of 0.1 mm must stay", {"grooves": Grooves(depth=0.4)}),
    ("are 0.3 mm wide, narrower than the smallest wall", {"grooves": Grooves(width=0.3)}),
    ("substrate that are 0.2 mm wide", {"grooves": Grooves(width=0.8, pitch=1.0, margin=1.0)}),
    ("margin that is 0.1 mm wide", {"grooves": Grooves(margin=0.1)}),
    ("groove depth is 0.25 mm, no whole number of 0.1 mm", {"grooves": Grooves(depth=0.25)}),
    (
        "substrate thickness is 0.45 mm, .* Choose 0.4 or 0.5 mm",
        {"pattern": SQUARE.with_(substrate_thickness=0.45)},
    ),
    (
        "9x9 mm holds no whole scale .* measures 9 x 9 mm, a scale 9.6 x 9.6 mm",
        {"shape": Rectangle(9.0, 9.0)},
    ),
    ("reaches 600 mm from its middle, but .* 500 mm", {"shape": Disc(600.0)}),
    (
        "about 31426 scales on tiles of 24 mm², more than 20000",
        {"shape": Disc(490.0), "pattern": SQUARE.with_(tile_area=24.0)},
    ),
    ("disc-5 mm holds no whole scale", {"shape": Disc(5.0)}),
    ("wall of the hinge barrels is 0.2 mm", {"shape": Rectangle(barrel_wall=0.2)}),
    ("leaves a ring of 0.1 mm", {"shape": Disc(4.1, hub=8.0)}),
    (
        "has a wall, a fin or a needle of .* mm, below the smallest wall of 8 mm: give a larger",
        {
            "pattern": fs.named_pattern("chevron"),
            "shape": Disc(60.0),
            "printer": Printer(smallest_wall=8.0),
            "grooves": Grooves(depth=0.0),
        },
    ),
]


@pytest.mark.parametrize(("said", "given"), REFUSED, ids=[said[:30] for said, _ in REFUSED])
def test_what_cannot_be_printed_is_refused_in_a_sentence(said: str, given: dict) -> None:
    with pytest.raises(FabricationError, match=said) as caught:
        plan(**given)
    assert re.fullmatch(r"[A-Z].*\.", str(caught.value))


def test_options_check_themselves() -> None:
    with pytest.raises(FabricationError, match=r"smallest wall is 0.2 mm, narrower than the nozz"):
        Printer(smallest_wall=0.2)
    with pytest.raises(FabricationError, match=r"hub hole of 8 mm diameter takes up the whole"):
        Disc(4.0)
    with pytest.raises(
        UnitRangeError, match=r"pin clearance is -0\.1 mm, .* between 0 mm and 10000 mm\."
    ):
        Rectangle(clearance=-0.1)
    with pytest.raises(
        UnitRangeError, match=r"smallest area is -1 mm², .* 0 mm² and 100000000 mm²\."
    ):
        Layout(smallest_area=-1.0)
    with pytest.raises(
        UnitRangeError, match=r"groove depth is -0\.1 mm, .* between 0 mm and 10000 mm\."
    ):
        Grooves(depth=-0.1)
    with pytest.raises(UnknownNameError, match=r"no border 'torn'. Known: 'cut', 'whole'"):
        Layout(border="torn")

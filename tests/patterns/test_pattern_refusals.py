"""Bad polygons, gaps, sizes and materials get one clear sentence, before any meshing."""

from __future__ import annotations

import numpy as np
import pytest

from flexscale.errors import BadInputError, PatternError, TilingError, UnitRangeError
from flexscale.patterns import NeoHookean, Pattern, named_pattern
from flexscale.tilings import Tiling
from flexscale.units import AREAS
from tests.patterns.pattern_shapes import SQUARE, custom

# Two blocks joined by a neck 1 mm wide, and the piece between the necks of two of them.
DUMBBELL = [(0, 0), (4, 0), (4, 3.5), (6, 3.5), (6, 0), (10, 0), (10, 8), (6, 8), (6, 4.5),
            (4, 4.5), (4, 8), (0, 8)]  # fmt: skip
BETWEEN = [(4, 4.5), (6, 4.5), (6, 11.5), (4, 11.5)]

POLYGONS = {
    "crossing": ([[(0, 0), (10, 10), (10, 0), (0, 10)]], (10, 0), (0, 10), "Self-intersection"),
    "too few corners": ([[(0, 0), (10, 0), (10, 0)]], (10, 0), (0, 10), "2 distinct corners"),
    "a line": ([[(0, 0), (10, 0), (20, 0)]], (10, 0), (0, 10), "simple polygon"),
    "not numbers": ([[(0, 0), (10, float("nan")), (0, 10)]], (10, 0), (0, 10), "finite"),
    "not points": ([["a", "b"]], (10, 0), (0, 10), "list of (x, y) corners"),
    "a number": (np.array(1.0), (10, 0), (0, 10), "must be a list of polygons"),
    "no tile": ([], (10, 0), (0, 10), "at least one tile"),
    "holes": ([SQUARE], (10, 0), (0, 11), "leave holes"),
    "overlap": ([SQUARE], (10, 0), (0, 9), "overlap"),
    "right area, wrong place": (
        [SQUARE, [(13, 1), (23, 1), (23, 11), (13, 11)]],
        (20, 0),
        (0, 10),
        "do not cover the plane: the edge of tile",
    ),
    "parallel lattice": ([SQUARE], (10, 0), (20, 0), "parallel"),
    "half a lattice": ([SQUARE], (10, 0), (0,), "two finite numbers"),
}


@pytest.mark.parametrize("family", [np.zeros(2, dtype=[("a", float)]), 7, None])
def test_a_family_is_a_text(family: object) -> None:
    config = custom([SQUARE], (10, 0), (0, 10)).to_config() | {"family": family}
    with pytest.raises(PatternError, match="family must be a text"):
        Pattern.from_config(config)


@pytest.mark.parametrize("case", list(POLYGONS))
def test_polygons(case: str) -> None:
    tiles, t1, t2, words = POLYGONS[case]
    with pytest.raises(PatternError) as caught:
        custom(tiles, t1, t2)
    assert words in str(caught.value)
    assert caught.value.exit_code == 2


def test_gap_at_which_the_scale_vanishes() -> None:
    with pytest.raises(
        PatternError, match=r"11 mm is too wide for tile 0 .*vanishes.* of 9\.99 mm at most"
    ):
        Pattern(Tiling("IH76"), gap=11.0)


def test_gap_at_which_the_scale_falls_apart() -> None:
    tiles = [DUMBBELL, BETWEEN]
    assert custom(tiles, (10, 0), (0, 8), gap=0.9).n_scales == 2
    with pytest.raises(
        PatternError, match=r"for tile 0 .*falls apart into 2 pieces.* of 0\.999 mm at most"
    ):
        custom(tiles, (10, 0), (0, 8), gap=1.2)


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("gap", 0.0, "gap is 0 mm"),
        ("gap", float("nan"), "finite"),
        ("scale_height", -4.0, "scale height is -4 mm"),
        ("substrate_thickness", 0.0, "substrate thickness is 0 mm"),
        ("tile_area", -1.0, "tile area is -1 mm²"),
        ("bond_radius", -0.1, "bond radius is -0.1 mm"),
        ("bond_radius", 11.0, "between 0 mm and 10 mm"),
    ],
)
def test_sizes(key: str, value: float, words: str) -> None:
    with pytest.raises(UnitRangeError, match=words):
        Pattern(Tiling("IH76"), **{key: value})


@pytest.mark.parametrize("name", ["hexagon", "square", "pinwheel3", "chevron"])
@pytest.mark.parametrize("area", AREAS)
def test_areas_at_their_bounds(name: str, area: float) -> None:
    pattern = named_pattern(name, tile_area=area, gap=1e-3, bond_radius=0.0)
    assert pattern.tile_area == area
    assert Pattern.from_config(pattern.to_config()) == pattern


@pytest.mark.parametrize("side", [0.00999, 3163.0])
def test_polygons_beyond_the_bounds_of_areas(side: float) -> None:
    tile = side * np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    with pytest.raises(UnitRangeError, match=r"tile area is .* between 0\.0001 mm² and 1"):
        custom([tile], (side, 0.0), (0.0, side), gap=1e-3)


@pytest.mark.parametrize(
    ("modulus", "ratio", "words"),
    [
        (0.0, 0.3, "Young's modulus is 0 MPa"),
        (26.0, 0.5, "between -0.95 and 0.4999"),
        (26.0, -1.0, "between -0.95 and 0.4999"),
        (26.0, float("inf"), "finite"),
    ],
)
def test_materials(modulus: float, ratio: float, words: str) -> None:
    with pytest.raises(UnitRangeError, match=words):
        NeoHookean(young_modulus=modulus, poisson_ratio=ratio)


@pytest.mark.parametrize(
    ("config", "words"),
    [
        ({"family": "IH76", "gapp": 0.4}, "Did you mean 'gap'"),
        ({"family": "IH76", "tiles": []}, "no key 'tiles'"),
        ({"tiles": [SQUARE], "symetrize": True}, "Did you mean 'symmetrize'"),
        ({"family": "IH76", "symmetrize": True}, "no key 'symmetrize'"),
        ({"family": "IH94"}, "IH94"),
        ({"family": "custom"}, "'tiles' and 'lattice'"),
        ({"tiles": [SQUARE], "lattice": [(10, 0)]}, "two vectors"),
        ({"family": "IH76", "scale_material": {"young_modulus": 1.0}}, "'poisson_ratio'"),
    ],
)
def test_configurations(config: dict, words: str) -> None:
    with pytest.raises((PatternError, TilingError)) as caught:
        Pattern.from_config(config)
    assert words in str(caught.value)


def test_wrong_kinds_of_arguments() -> None:
    with pytest.raises(BadInputError, match="Tiling"):
        Pattern("IH76")
    with pytest.raises(BadInputError, match="NeoHookean"):
        Pattern(Tiling("IH76"), scale_material=2020.0)
    with pytest.raises(BadInputError, match="Did you mean 'gap'"):
        Pattern(Tiling("IH76")).with_(gaps=1.0)
    with pytest.raises(BadInputError, match="no parameter 'tile_area'"):
        custom([SQUARE], (10, 0), (0, 10)).with_(tile_area=1.0)


@pytest.mark.parametrize("given", ["no", 1, None, np.array([True, False])])
def test_whether_to_symmetrize_is_true_or_false(given: object) -> None:
    with pytest.raises(BadInputError, match=r"^symmetrize is .*: give True or False\.$"):
        custom([SQUARE], (10, 0), (0, 10), symmetrize=given)


def _told_gap(error: pytest.ExceptionInfo[PatternError]) -> float:
    return float(str(error.value).split("Use a gap of ")[1].split(" mm")[0])


@pytest.mark.parametrize("angle", [17.0, 40.0, 73.3, 90.0])
@pytest.mark.parametrize("times", [1.0002, 1.5])
def test_the_widest_gap_that_is_named_works(angle: float, times: float) -> None:
    """Rhombs of side 10 mm vanish at their width, 10 sin(angle)."""
    turn = np.radians(angle)
    t1, t2 = np.array([10.0, 0.0]), 10.0 * np.array([np.cos(turn), np.sin(turn)])
    width = 10.0 * float(np.sin(turn))
    rhomb = [np.zeros(2), t1, t1 + t2, t2]
    with pytest.raises(PatternError, match="its scale vanishes") as error:
        Pattern.from_polygons([rhomb], t1, t2, gap=times * width)
    told = _told_gap(error)
    assert 0.99 * width < told < width
    assert Pattern.from_polygons([rhomb], t1, t2, gap=told).gap == told


def test_the_widest_gap_is_that_of_all_tiles() -> None:
    """The first tile takes up to 4 mm, the second one up to 2 mm."""
    tiles = [[(0, 0), (10, 0), (10, 4), (0, 4)], [(0, 4), (10, 4), (10, 6), (0, 6)]]
    with pytest.raises(PatternError, match=r"too wide for tile 0 .* vanishes") as error:
        Pattern.from_polygons(tiles, (10, 0), (0, 6), gap=4.5)
    told = _told_gap(error)
    assert 1.8 < told < 2.0
    assert Pattern.from_polygons(tiles, (10, 0), (0, 6), gap=told).gap == told


def test_a_scale_without_width_has_vanished() -> None:
    """Of a tile 5 mm wide, 0.05 mm are left: both ends are shorter than what counts as an edge."""
    tile = [(0, 0), (10, 0), (10, 5), (0, 5)]
    with pytest.raises(PatternError, match="its scale vanishes"):
        Pattern.from_polygons([tile], (10, 0), (0, 5), gap=4.95)

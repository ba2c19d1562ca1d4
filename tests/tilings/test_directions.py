"""Equivalent bending directions: the fundamental sector, folding into it, spreading from it."""

from __future__ import annotations

import numpy as np
import pytest

from flexscale.errors import UnitRangeError
from flexscale.tilings.directions import fundamental_sector
from flexscale.tilings.drawn_symmetry import drawn_symmetry
from flexscale.tilings.wallpaper import DrawnSymmetry
from tests.tilings.drawn_tilings import DRAWN, turned


def symmetry_of(name: str, degrees: float = 0.0) -> DrawnSymmetry:
    tiles, lattice, *_ = DRAWN[name]
    return drawn_symmetry([turned(tile, degrees) for tile in tiles], turned(lattice, degrees))


@pytest.mark.parametrize(
    ("order", "axes", "sector"),
    [
        (1, [], (0, 180, False)),
        (2, [], (0, 180, False)),
        (3, [], (0, 60, False)),
        (4, [], (0, 90, False)),
        (6, [], (0, 60, False)),
        (1, [100], (10, 100, True)),
        (2, [25, 115], (25, 115, True)),
        (3, [0, 60, 120], (0, 30, True)),
        (3, [30, 90, 150], (0, 30, True)),
        (3, [20, 80, 140], (20, 50, True)),
        (4, [10, 55, 100, 145], (10, 55, True)),
        (6, [7, 37, 67, 97, 127, 157], (7, 37, True)),
        (1, [180 - 1e-12], (0, 90, True)),
    ],
)
def test_sectors(order: int, axes: list[float], sector: tuple[float, float, bool]) -> None:
    assert fundamental_sector(order, axes) == pytest.approx(sector)


@pytest.mark.parametrize(
    ("name", "direction", "expected"),
    [
        ("hexagons", 100.0, 20.0),
        ("hexagons", 150.0, 30.0),
        ("hexagons", -25.0, 25.0),
        ("pinwheel 6", 100.0, 40.0),
        ("pinwheel 3", 125.0, 5.0),
        ("squares", 80.0, 10.0),
        ("pinwheel 4", 100.0, 10.0),
        ("pinwheel 4", 80.0, 80.0),
        ("running bond", 91.0, 89.0),
        ("herringbone", 10.0, 80.0),
        ("herringbone", 136.0, 134.0),
        ("third bond", 179.0, 179.0),
        ("third bond", 180.0, 0.0),
        ("third bond", 360.0 - 1e-12, 0.0),
        ("third bond", 725.0, 5.0),
    ],
)
def test_equivalent(name: str, direction: float, expected: float) -> None:
    symmetry = symmetry_of(name)
    found, operation = symmetry.equivalent(direction)
    assert found == pytest.approx(expected, abs=1e-9)
    assert np.isclose((operation.turn(direction) - found + 90.0) % 180.0, 90.0)
    # The operation does to a vector what it does to its angle.
    radians = np.deg2rad(direction)
    vector = operation.linear @ (np.cos(radians), np.sin(radians))
    across = np.array([-np.sin(np.deg2rad(found)), np.cos(np.deg2rad(found))])
    assert abs(vector @ across) < 1e-9


@pytest.mark.parametrize("name", DRAWN)
@pytest.mark.parametrize("degrees", [0.0, 12.3])
def test_directions_inside_are_left_alone(name: str, degrees: float) -> None:
    symmetry = symmetry_of(name, degrees)
    start, stop, closed = symmetry.sector
    for direction in np.linspace(start, stop, 7)[: None if closed else -1]:
        found, operation = symmetry.equivalent(direction)
        assert found == pytest.approx(direction, abs=1e-12)
        assert operation is symmetry.operations[0]
    if not closed:
        assert symmetry.equivalent(stop)[0] == start


@pytest.mark.parametrize("name", DRAWN)
def test_expanding_the_sector_fills_the_circle_evenly(name: str) -> None:
    symmetry = symmetry_of(name, 12.3)
    start, stop, closed = symmetry.sector
    given = np.linspace(start, stop, 7 if closed else 6, endpoint=closed)
    images = symmetry.expand(given)
    directions = np.array([image.direction for image in images])
    spacing = (stop - start) / 6.0
    assert len(images) == round(180.0 / spacing)
    assert np.allclose(np.diff(directions), spacing)
    assert np.all((directions >= 0.0) & (directions < 180.0))
    for image in images:
        assert symmetry.equivalent(image.direction)[0] == pytest.approx(given[image.source])
        turn = image.operation.turn(given[image.source]) - image.direction
        assert np.isclose((turn + 90.0) % 180.0, 90.0)


def test_round_directions_stay_round() -> None:
    images = symmetry_of("hexagons").expand([0.0, 10.0, 20.0, 30.0])
    assert [image.direction for image in images] == [10.0 * k for k in range(18)]
    assert [image.source for image in images] == [0, 1, 2, 3, 2, 1] * 3


def test_equal_directions_count_once() -> None:
    images = symmetry_of("squares").expand([0.0, 90.0, 180.0, 1e-12])
    assert [(image.direction, image.source) for image in images] == [(0.0, 0), (90.0, 0)]


def test_directions_must_be_finite() -> None:
    with pytest.raises(UnitRangeError, match="direction is nan"):
        symmetry_of("squares").equivalent(float("nan"))
    with pytest.raises(UnitRangeError, match="direction is inf"):
        symmetry_of("squares").expand([0.0, float("inf")])

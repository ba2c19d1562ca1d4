"""Corners of tiles: which are one, which lie on edges of others, which are kept."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from flexscale.errors import PatternError
from flexscale.mesh import MeshOptions, build_mesh
from flexscale.patterns import Pattern
from flexscale.patterns.corners import torus_classes
from flexscale.patterns.drawing import read_drawing
from flexscale.patterns.typed_cell import say_once
from tests.mesh.mesh_checks import assert_sound
from tests.patterns.pattern_shapes import SQUARE, custom

SQUARE_CORNERS = [list(corner) for corner in SQUARE]
COARSE = MeshOptions(scale_layers=2, scale_size=6, scale_strips=1, across=2)


def tabs(line: np.ndarray, n: int = 1) -> tuple[list[np.ndarray], tuple, tuple]:
    """Tiles of 10 x 10 mm between copies of a line from (0, 0) to (10, 0), n x n of them."""
    tile = np.vstack([line, np.add(line, (0, 10))[::-1]])
    tiles = [np.add(tile, (10 * i, 10 * j)) for i in range(n) for j in range(n)]
    return tiles, (10 * n, 0), (0, 10 * n)


def arc(center: tuple[float, float], radius: float, start: float, end: float, n: int) -> np.ndarray:
    """Points (n + 1, 2) on an arc."""
    angles = np.radians(np.linspace(start, end, n + 1))
    return np.array(center) + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


FILLET = np.vstack(
    [[(0, 0)], arc((3.4, 0.1), 0.1, -90, 0, 40), [(3.5, 1), (6.5, 1), (6.5, 0), (10, 0)]]
)
ROUND = np.vstack([[(0, 0)], arc((5, 0), 2.0, 180, 0, 32), [(10, 0)]])
X = np.linspace(0.0, 10.0, 201)
LINES = {
    "fillet of 0.1 mm in 40 steps": FILLET,
    "arc of 32 points": ROUND,
    "curve of 200 points": np.stack([X, np.sin(0.2 * np.pi * X)], axis=1),
    "curve of slight turns": np.stack([X, 0.0004 * np.sin(0.2 * np.pi * X)], axis=1),
}


@pytest.mark.parametrize("n", [1, 3])
@pytest.mark.parametrize("name", list(LINES))
def test_outlines_of_many_short_steps_keep_their_corners(name: str, n: int) -> None:
    tiles, *lattice = tabs(LINES[name], n)
    pattern = custom(tiles, *lattice, gap=0.1)
    assert pattern.n_scales == n * n
    for tile, given in zip(pattern.tiles, tiles, strict=True):
        apart = np.linalg.norm(given[:, None] - tile, axis=2).min(axis=1)
        # Corners that turn nowhere, as at the inflection of a curve, may go.
        assert np.count_nonzero(apart > 2e-8) <= 0.03 * len(given)


@pytest.mark.parametrize("name", ["fillet of 0.1 mm in 40 steps", "arc of 32 points"])
def test_fine_outlines_can_be_meshed(name: str) -> None:
    tiles, *lattice = tabs(LINES[name].round(3))
    pattern = custom(tiles, *lattice)
    assert_sound(build_mesh(pattern, COARSE), pattern)


def test_repeated_corners_are_told_by_the_last_one_kept() -> None:
    line = np.stack([np.linspace(0.0, 10.0, 21), np.zeros(21)], axis=1)
    close = np.array(
        [(10.0, 0.0), (10.0, 1e-9), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0), (0.0, 0.0)]
    )
    pattern = custom([np.vstack([line, close])], (10, 0), (0, 10))
    assert pattern.tiles[0].tolist() == SQUARE_CORNERS


@pytest.mark.parametrize("n", [10, 30])
def test_rows_of_long_cells_stay_shifted(n: int) -> None:
    low = [np.array(SQUARE) * (1, 0.3) + (10 * k, 0) for k in range(n)]
    high = [np.add(tile, (0.2, 3)) for tile in low]
    pattern = custom([*low, *high], (10 * n, 0), (0, 6))
    assert pattern.symmetry().group == "pmg"
    assert pattern.symmetry().n_primitive_cells == n
    assert min(pattern.tiles[n][:, 0]) == 0.2


@pytest.mark.parametrize("n", [1, 3, 10])
def test_tolerances_do_not_grow_with_the_cell(n: int) -> None:
    tiles = [np.add(SQUARE, (10 * i + 0.002 * (j % 2), 10 * j)) for i in range(n) for j in range(2)]
    pattern = custom(tiles, (10 * n, 0), (0, 20))
    assert {round(float(tile[:, 0].min()) % 10, 9) for tile in pattern.tiles} == {0.0, 0.002}


def test_lattice_classes_are_told_in_mm() -> None:
    points = np.array([(0.0, 0.0), (0.2, 0.0), (600.0, 6.0), (0.2, 5.9995)])
    assert torus_classes(points, np.array([(600.0, 0.0), (0.0, 6.0)]), 1e-3).tolist() == [
        0,
        1,
        0,
        1,
    ]
    skewed = np.array([(600.0, 0.0), (6000.3, 6.0)])
    assert torus_classes(points, skewed, 1e-3).tolist() == [0, 1, 2, 3]


@pytest.mark.parametrize("size", [10.0, 100.0])
@pytest.mark.parametrize("share", [0.5e-4, 0.9e-4, 1.1e-4, 1.5e-4, 1.9e-4, 2.0e-4, 2.1e-4])
def test_no_shift_of_rows_is_refused(size: float, share: float) -> None:
    shift = round(size * share, 5)
    tile = np.array(SQUARE) * size / 10.0
    pattern = custom([tile], (size, 0), (shift, size))
    assert pattern.symmetry().group == "p2"
    assert shift in pattern.tiles[0][:, 0].round(9)


@pytest.mark.parametrize("angle", [10.0, 30.0, 60.0])
def test_corners_near_acute_corners_are_put_into_one_edge(angle: float) -> None:
    across = 3.0 / np.tan(np.radians(angle))
    for digits in (4, 6, 15):
        for shift in (-0.05, -0.0011, -5e-4, 0.0021):
            tile = np.round([(0, 0), (10, 0), (10 + across, 3), (across, 3)], digits)
            pattern = custom([tile], (10, 0), np.round((across + shift, 3), digits))
            assert len(pattern.tiles[0]) == 6


def test_digits_given() -> None:
    assert read_drawing([SQUARE], (10, 0), (0, 10)).unit == 1.0
    assert read_drawing([SQUARE], (10, 0), (0.25, 10)).unit == 0.01
    assert read_drawing([np.array(SQUARE) / 3], (10 / 3, 0), (0, 10 / 3)).unit == 1e-8


def rows(apart: float) -> Pattern:
    """Two rows of rectangles that leave a slit, mm."""
    low, high = 3.33, 3.33 + apart
    tiles = [
        [(0, 0), (10, 0), (10, low), (0, low)],
        [(0, high), (10, high), (10, 10), (0, 10)],
    ]
    return custom(tiles, (10, 0), (0, 10))


def test_corners_that_agree_to_fewer_digits_are_made_one(caplog: pytest.LogCaptureFixture) -> None:
    say_once.cache_clear()
    pattern = rows(0.000123)
    assert "agree to 0.0003 mm only" in caplog.text
    assert len(np.unique(np.concatenate(pattern.tiles)[:, 1])) == 3


def test_what_cannot_be_kept_is_refused_for_that() -> None:
    with pytest.raises(PatternError, match=r"corners must agree to 0.0007 mm"):
        rows(0.001)


@pytest.mark.slow
def test_many_points_in_one_outline() -> None:
    """12,000 points, typed to 1e-6 mm: those left out lie on the outline, to these digits."""
    x = np.linspace(0.0, 10.0, 6001)
    tiles, *lattice = tabs(np.stack([x, np.sin(0.2 * np.pi * x)], axis=1).round(6))
    pattern = Pattern.from_polygons(tiles, *lattice)
    assert len(pattern.tiles[0]) > 10000
    kept = shapely.Polygon(pattern.tiles[0])
    given = shapely.points(np.asarray(tiles[0]) - tiles[0][0])
    assert shapely.distance(kept.exterior, given).max() < 2e-6
    assert kept.area == pytest.approx(pattern.cell_area, rel=1e-9)

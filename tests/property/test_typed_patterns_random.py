"""What must not matter to a pattern of polygons: where it lies, and how many digits are typed."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from flexscale.errors import PatternError
from flexscale.patterns import Pattern
from flexscale.patterns.drawing import read_drawing
from flexscale.tilings.drawn_symmetry import primitive_cell
from tests.tilings.wallpaper_samples import GENERATORS, orbit_tiling

FEW = settings(max_examples=3, deadline=None, suppress_health_check=list(HealthCheck))
SQUARE = np.array([(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)])


def drawn(group: str, seed: int) -> tuple[list[np.ndarray], np.ndarray]:
    """A random tiling with a group, with tiles of 100 mm² on average."""
    tiles, lattice = orbit_tiling(group, np.random.default_rng(seed).random((3, 2)))
    tiles, lattice = primitive_cell(tiles, lattice)
    factor = 10.0 / np.sqrt(abs(np.linalg.det(lattice)) / len(tiles))
    return [factor * tile for tile in tiles], factor * lattice


@pytest.mark.parametrize("group", ["p1", "p2", "pm", "pgg", "cmm", "p4", "p4g", "p3m1", "p6"])
@FEW
@given(st.integers(0, 2**32 - 1), st.integers(4, 12))
def test_typed_digits_leave_the_group(group: str, seed: int, digits: int) -> None:
    """Found, exact in the tiles, and no corner moved by more than a digit."""
    assert group in GENERATORS
    tiles, lattice = drawn(group, seed)
    typed = [np.round(tile, digits) for tile in tiles]
    pattern = Pattern.from_polygons(typed, *np.round(lattice, digits))
    assert pattern.symmetry().group == group
    for tile, image in zip(typed, pattern.tiles, strict=True):
        given_corners = tile - typed[0][0]
        apart = np.linalg.norm(given_corners[:, None] - image, axis=2).min(axis=1)
        assert apart.max() <= 3.0 * max(10.0**-digits, 1e-8)


@settings(FEW, max_examples=10)
@given(
    st.sampled_from(["p1", "p2", "cm", "p4", "p31m"]),
    st.integers(0, 2**32 - 1),
    st.integers(3, 8),
    st.tuples(st.floats(-1e6, 1e6), st.floats(-1e6, 1e6)),
)
def test_a_move_leaves_the_configuration(
    group: str, seed: int, digits: int, move: tuple[float, float]
) -> None:
    tiles, lattice = drawn(group, seed)
    typed, vectors = [np.round(tile, digits) for tile in tiles], np.round(lattice, digits)
    try:
        here = Pattern.from_polygons(typed, *vectors)
    except PatternError:
        return  # so few digits that short edges are lost
    there = Pattern.from_polygons([tile + move for tile in typed], *vectors)
    assert there.to_config() == here.to_config()


@settings(FEW, max_examples=40)
@given(
    st.floats(-7.0, -1.0).map(lambda exponent: 10.0**exponent),
    st.sampled_from([-1, 1]),
    st.sampled_from([5.0, 10.0, 45.0, 90.0]),
    st.integers(3, 12),
)
def test_no_offset_of_rows_is_refused(offset: float, sign: int, angle: float, digits: int) -> None:
    """T-junctions from 0.1 nm to 0.1 mm beside a corner, also an acute one."""
    across = 0.0 if angle == 90.0 else 5.0 / np.tan(np.radians(angle))
    tile = np.round([(0, 0), (10, 0), (10 + across, 5), (across, 5)], digits)
    above = np.round((across + sign * offset, 5), digits)
    pattern = Pattern.from_polygons([tile], (10, 0), above)
    assert pattern.symmetry().rotation_order >= 2
    shift = abs(above - tile[3])[0]
    unit = read_drawing([tile], (10, 0), above).unit
    assert len(pattern.tiles[0]) == 6 or shift <= 3.001 * unit or shift < 1e-6


@pytest.mark.parametrize("n", [1, 3, 10, pytest.param(100, marks=pytest.mark.slow)])
@settings(FEW, max_examples=2)
@given(st.floats(0.002, 0.3))
def test_the_size_of_the_cell_does_not_matter(n: int, shift: float) -> None:
    """Every second row of n x n squares or nearly so is shifted; none comes out unshifted."""
    rows = 2 * ((n + 1) // 2)
    shift = round(shift, 4)
    tiles = [
        np.add(SQUARE, (10.0 * i + shift * (j % 2), 10.0 * j))
        for i in range(n)
        for j in range(rows)
    ]
    pattern = Pattern.from_polygons(tiles, (10.0 * n, 0.0), (0.0, 10.0 * rows))
    assert pattern.symmetry().group == "pmg"
    for tile, given_tile in zip(pattern.tiles, tiles, strict=True):
        assert np.abs(tile[:, 0].min() - given_tile[0, 0]) < 1e-9

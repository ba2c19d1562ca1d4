"""What must not matter: origin, choice of cell, orientation of the axes, number of copies.

Moments of equivalent descriptions of one sheet agree to 1e-8.
"""

from __future__ import annotations

import numpy as np
import pytest

import flexscale as fs
from flexscale.patterns import Pattern

SQUARE = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]])
# No symmetry but the lattice's: nothing is hidden by mirror images.
OBLIQUE = np.array([[0.0, 0.0], [11.0, 0.0], [13.0, 8.0], [2.0, 8.0]])
COARSE = fs.MeshOptions(along=4.0, corner=1.0, scale_size=10.0, scale_layers=1)


def moment(pattern: Pattern, direction: float = 25.0, curvature: float = 0.008) -> np.ndarray:
    """Moments to both sides."""
    solver = fs.SolverOptions(tolerance=1e-11)
    curvatures = [0.0, curvature]
    data = fs.sweep(
        pattern,
        [direction % 180.0],
        curvatures,
        workers=1,
        model=fs.NativeModel("shell", mesh=COARSE, solver=solver),
    )
    assert (data.status == 0).all()
    return data.moment.values[:, 0, 1]


def turn(degrees: float) -> np.ndarray:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, -s], [s, c]])


@pytest.fixture(scope="module")
def oblique_moment() -> np.ndarray:
    return moment(Pattern.from_polygons([OBLIQUE], OBLIQUE[1], OBLIQUE[3]))


def test_moving_the_pattern_in_the_plane(oblique_moment):
    """The cylinder's axis may lie anywhere above the sheet."""
    moved = Pattern.from_polygons([OBLIQUE + np.array([3.7, -2.2])], OBLIQUE[1], OBLIQUE[3])
    assert moment(moved) == pytest.approx(oblique_moment, rel=1e-8)


def test_another_fundamental_cell(oblique_moment):
    """t1, t1 + t2 span the same lattice."""
    other = Pattern.from_polygons([OBLIQUE], OBLIQUE[1], OBLIQUE[1] + OBLIQUE[3])
    assert moment(other) == pytest.approx(oblique_moment, rel=1e-8)


@pytest.mark.parametrize("degrees", [90.0, 33.0])
def test_turning_pattern_and_direction_together(oblique_moment, degrees):
    r = turn(degrees)
    turned = Pattern.from_polygons([OBLIQUE @ r.T], r @ OBLIQUE[1], r @ OBLIQUE[3])
    assert moment(turned, 25.0 + degrees) == pytest.approx(oblique_moment, rel=1e-8)


@pytest.fixture(scope="module")
def square_moment() -> np.ndarray:
    return moment(Pattern.from_polygons([SQUARE], (10.0, 0.0), (0.0, 10.0)))


@pytest.mark.parametrize("copies", [(2, 1), pytest.param((1, 3), marks=pytest.mark.slow)])
def test_supercell(square_moment, copies):
    """n x m copies in one cell add freedom, but before buckling nothing uses it."""
    n, m = copies
    tiles = [SQUARE + 10.0 * np.array([i, j]) for i in range(n) for j in range(m)]
    super_cell = Pattern.from_polygons(tiles, (10.0 * n, 0.0), (0.0, 10.0 * m))
    assert moment(super_cell) == pytest.approx(square_moment, rel=1e-8)


def test_polygons_and_tiling_describe_one_pattern(square_moment):
    """Squares typed as a polygon are the family IH76."""
    assert moment(Pattern(fs.Tiling("IH76"))) == pytest.approx(square_moment, rel=1e-8)

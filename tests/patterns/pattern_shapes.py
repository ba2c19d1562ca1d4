"""Patterns for tests of geometry and mesh: one for every kind of tile symmetry and junction."""

from __future__ import annotations

import numpy as np

from flexscale.patterns import Pattern
from flexscale.tilings import Tiling


def turned(points: list[tuple[float, float]], degrees: float, center: tuple[float, float]):
    """Points (n, 2) turned about a center."""
    angle = np.deg2rad(degrees)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return (np.array(points) - center) @ turn.T + center


def s_edged(n: int) -> np.ndarray:
    """Regular n-gon of inradius 5 about the origin whose edges are S-shaped: rotations alone."""
    half = 5.0 * np.tan(np.pi / n)
    edge = [(5.0, -half), (5.6, -0.4 * half), (4.4, 0.4 * half)]
    return np.concatenate([turned(edge, 360.0 * k / n, (0.0, 0.0)) for k in range(n)])


def custom(tiles, t1, t2, **sizes) -> Pattern:
    """Shorthand for `Pattern.from_polygons`."""
    return Pattern.from_polygons(tiles, t1, t2, **sizes)


BRICK = [(0.0, 0.0), (10.0, 0.0), (10.0, 5.0), (0.0, 5.0)]  # four corners: T-junctions to be found
SQUARE = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)]
ARROWHEAD = [(0.0, 0.0), (5.0, 3.0), (10.0, 0.0), (10.0, 2.0), (5.0, 5.0), (0.0, 2.0)]

# name -> (pattern, order of the symmetry group of each prototile)
SHAPES: dict[str, tuple[Pattern, list[int]]] = {
    "square": (Pattern(Tiling("IH76")), [8]),
    "hexagon": (Pattern(Tiling("IH20")), [12]),
    "brick": (custom([BRICK], (10, 0), (5, 5)), [4]),
    "parallelogram": (custom([[(0, 0), (10, 0), (13, 8), (3, 8)]], (10, 0), (3, 8)), [2]),
    "pinwheel 4": (custom([s_edged(4)], (10, 0), (0, 10)), [4]),
    "pinwheel 6": (custom([s_edged(6)], (10, 0), (5, 5 * np.sqrt(3))), [6]),
    "arrowhead": (custom([ARROWHEAD], (10, 0), (0, 2)), [2]),
    "herringbone": (
        custom([BRICK, [(15, 0), (20, 0), (20, 10), (15, 10)]], (20, 0), (5, 5)),
        [4],
    ),
    "triangles": (
        custom([[(0, 0), (10, 0), (5, 8)], [(10, 0), (15, 8), (5, 8)]], (10, 0), (5, 8)),
        [2],
    ),
    "corner and square": (
        custom(
            [
                [(0, 0), (10, 0), (10, 5), (5, 5), (5, 10), (0, 10)],
                [(5, 5), (10, 5), (10, 10), (5, 10)],
            ],
            (10, 0),
            (0, 10),
        ),
        [2, 8],
    ),
    "lopsided": (
        custom(
            [[(0, 0), (3, 1), (10, 0), (11.5, 4), (10, 10), (3, 11), (0, 10), (1.5, 4)]],
            (10, 0),
            (0, 10),
        ),
        [1],
    ),
    # The long brick's middle edge ends straight on both sides: diagonals of equal length.
    "wide and narrow": (
        custom(
            [
                [(0, 0), (30, 0), (30, 5), (0, 5)],
                *([(x, 5), (x + 10, 5), (x + 10, 10), (x, 10)] for x in (0, 10, 20)),
            ],
            (30, 0),
            (0, 10),
        ),
        [4, 4],
    ),
    # Rows shifted by less than the gap: the outline has no corner for the short edges.
    "nearly aligned": (custom([SQUARE], (10, 0), (0.1, 10)), [2]),
}

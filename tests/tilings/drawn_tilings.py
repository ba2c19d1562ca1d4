"""Well-known tilings, drawn by hand, and the wallpaper groups that books give them."""

from __future__ import annotations

import numpy as np

ROOT3 = np.sqrt(3.0)
HEX = np.array([(ROOT3, 0.0), (0.5 * ROOT3, 1.5)])
S_EDGE = [(0.6, -0.4), (-0.6, 0.4)]
ARROWHEAD = [(0, 0), (5, 3), (10, 0), (10, 2), (5, 5), (0, 2)]


def turned(points, degrees: float) -> np.ndarray:
    """Points (n, 2) turned about the origin."""
    c, s = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
    return np.array(points, dtype=float) @ np.array([[c, s], [-s, c]])


def box(x: float, y: float, width: float, height: float) -> np.ndarray:
    """Rectangle by its lower left corner."""
    return np.array([(x, y), (x + width, y), (x + width, y + height), (x, y + height)])


def pinwheel(n: int, edge, alternating: bool = False) -> np.ndarray:
    """Regular n-gon of inradius 5 with corners (outward, along in half edges) on every edge.

    In an alternating one every second edge is the translate of the one opposite.
    """
    half = 5.0 * np.tan(np.pi / n)
    corners = []
    for k in range(n):
        bent = [(5.0 + out, along * half) for out, along in edge]
        if alternating and k % 2:
            bent = [(5.0 - out, -along * half) for out, along in reversed(edge)]
        corners.append(turned([(5.0, -half), *bent], 360.0 * k / n))
    return np.concatenate(corners)


def hexagon() -> np.ndarray:
    """Regular, with corners at 30°, 90°, … and circumradius 1."""
    return np.concatenate([turned([(1.0, 0.0)], 60.0 * k + 30.0) for k in range(6)])


def rhombs() -> list[np.ndarray]:
    """A hexagon cut in three: cubes in perspective."""
    corners = hexagon()
    return [np.array([(0, 0), *corners[[k, k + 1, (k + 2) % 6]]]) for k in (0, 2, 4)]


def swollen_triangles() -> list[np.ndarray]:
    """Upward triangles whose edges have a corner outward, and the downward ones between."""
    up, down = np.array([(0, 0), HEX[0], HEX[1]]), np.array([HEX[0], HEX[0] + HEX[1], HEX[1]])
    tiles = []
    for triangle, swell in ((up, 1.2), (down, 0.8)):
        middles = 0.5 * (triangle + np.roll(triangle, -1, axis=0))
        middles = triangle.mean(axis=0) + swell * (middles - triangle.mean(axis=0))
        tiles.append(np.stack([triangle, middles], axis=1).reshape(-1, 2))
    return tiles


CAIRO = [turned([(0, 0), (2, 1), (3, 3), (1, 4), (-1, 2)], 90.0 * k) for k in range(4)]

#: name -> (tiles, lattice, group, number of primitive cells, sector)
DRAWN = {
    "squares": ([box(0, 0, 1, 1)], np.eye(2), "p4m", 1, (0, 45, True)),
    "hexagons": ([hexagon()], HEX, "p6m", 1, (0, 30, True)),
    "regular triangles": (
        [[(0, 0), HEX[0], HEX[1]], [HEX[0], HEX[0] + HEX[1], HEX[1]]],
        HEX,
        "p6m",
        1,
        (0, 30, True),
    ),
    "cubes": (rhombs(), HEX, "p6m", 1, (0, 30, True)),
    "swollen triangles": (swollen_triangles(), HEX, "p3m1", 1, (0, 30, True)),
    "swollen hexagons": (
        [pinwheel(6, [(0.5, 0.0)], alternating=True)],
        [(10, 0), (5, 5 * ROOT3)],
        "p31m",
        1,
        (0, 30, True),
    ),
    "pinwheel 3": (
        [pinwheel(6, [(0.5, -0.3)], alternating=True)],
        [(10, 0), (5, 5 * ROOT3)],
        "p3",
        1,
        (0, 60, False),
    ),
    "pinwheel 6": ([pinwheel(6, S_EDGE)], [(10, 0), (5, 5 * ROOT3)], "p6", 1, (0, 60, False)),
    "pinwheel 4": ([pinwheel(4, S_EDGE)], 10 * np.eye(2), "p4", 1, (0, 90, False)),
    "two squares": ([box(0, 0, 2, 2), box(2, 0, 1, 1)], [(2, 1), (-1, 2)], "p4", 1, (0, 90, False)),
    "cairo": (CAIRO, [(6, 0), (0, 6)], "p4g", 1, (0, 45, True)),
    "basket weave": (
        [box(0, 0, 2, 1), box(0, 1, 2, 1), box(2, 0, 1, 2), box(3, 0, 1, 2)],
        [(4, 0), (2, 2)],
        "p4g",
        1,
        (0, 45, True),
    ),
    "herringbone": (
        [box(0, 0, 10, 5), box(15, 0, 5, 10)],
        [(20, 0), (5, 5)],
        "pgg",
        1,
        (45, 135, True),
    ),
    "stacked bricks": ([box(0, 0, 10, 5)], [(10, 0), (0, 5)], "pmm", 1, (0, 90, True)),
    "running bond": ([box(0, 0, 10, 5)], [(10, 0), (5, 5)], "cmm", 1, (0, 90, True)),
    "running bond, corners on edges": (
        [[(0, 0), (5, 0), (10, 0), (10, 5), (5, 5), (0, 5)]],
        [(10, 0), (5, 5)],
        "cmm",
        1,
        (0, 90, True),
    ),
    "running bond, two rows": (
        [box(0, 0, 10, 5), box(5, 5, 10, 5)],
        [(10, 0), (0, 10)],
        "cmm",
        2,
        (0, 90, True),
    ),
    "third bond": ([box(0, 0, 9, 5)], [(9, 0), (3, 5)], "p2", 1, (0, 180, False)),
    "rhombs": ([[(0, -2), (3, 0), (0, 2), (-3, 0)]], [(3, 2), (3, -2)], "cmm", 1, (0, 90, True)),
    "scalene triangles": (
        [[(0, 0), (10, 0), (3, 8)], [(10, 0), (13, 8), (3, 8)]],
        [(10, 0), (3, 8)],
        "p2",
        1,
        (0, 180, False),
    ),
    "leaning rows": (
        [[(0, 0), (10, 0), (13, 8), (3, 8)], [(3, 8), (13, 8), (10, 16), (0, 16)]],
        [(10, 0), (0, 16)],
        "pmg",
        1,
        (0, 90, True),
    ),
    "arrowheads": ([ARROWHEAD], [(10, 0), (0, 2)], "pm", 1, (0, 90, True)),
    "shifted arrowheads": ([ARROWHEAD], [(10, 1), (0, 2)], "cm", 1, (0, 90, True)),
}

"""Tilings of known symmetry: Voronoi cells of generic points repeated by each wallpaper group."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from scipy.spatial import Voronoi

# General positions of the International Tables, without the identity and lattice translations:
# enough of them to generate the group. γ = 90°, or 120° in the hexagonal ones.
GENERATORS = {
    "p1": "",
    "p2": "-x,-y",
    "pm": "-x,y",
    "pg": "-x,y+1/2",
    "cm": "-x,y; x+1/2,y+1/2",
    "pmm": "-x,-y; -x,y",
    "pmg": "-x,-y; -x+1/2,y",
    "pgg": "-x,-y; -x+1/2,y+1/2",
    "cmm": "-x,-y; -x,y; x+1/2,y+1/2",
    "p4": "-y,x",
    "p4m": "-y,x; -x,y",
    "p4g": "-y,x; -x+1/2,y+1/2",
    "p3": "-y,x-y",
    "p3m1": "-y,x-y; -y,-x",
    "p31m": "-y,x-y; y,x",
    "p6": "x-y,x",
    "p6m": "x-y,x; y,x",
}
#: Reflecting elements of the point group: directions of mirrors, and of glides that are none.
AXES = {
    "pm": ([90], []),
    "pg": ([], [90]),
    "cm": ([90], [90]),
    "pmm": ([0, 90], []),
    "pmg": ([90], [0]),
    "pgg": ([], [0, 90]),
    "cmm": ([0, 90], [0, 90]),
    "p4m": ([0, 45, 90, 135], [45, 135]),
    "p4g": ([45, 135], [0, 45, 90, 135]),
    "p3m1": ([30, 90, 150], [30, 90, 150]),
    "p31m": ([0, 60, 120], [0, 60, 120]),
    "p6m": ([0, 30, 60, 90, 120, 150], [0, 30, 60, 90, 120, 150]),
}
ROTATION_ORDER = {name: int(name[1]) if name[1].isdigit() else 1 for name in GENERATORS}
ROTATION_ORDER |= dict.fromkeys(("pmm", "pmg", "pgg", "cmm"), 2)
OBLIQUE = np.array([(1.0, 0.0), (0.23, 0.87)])
RECTANGLE = np.array([(1.0, 0.0), (0.0, 1.37)])
HEXAGONAL = np.array([(1.0, 0.0), (-0.5, 0.5 * np.sqrt(3.0))])


def lattice_of(group: str) -> np.ndarray:
    """Conventional lattice (2, 2) with no more symmetry than the group asks for."""
    if group in ("p1", "p2"):
        return OBLIQUE
    if ROTATION_ORDER[group] in (3, 6):
        return HEXAGONAL
    return np.eye(2) if ROTATION_ORDER[group] == 4 else RECTANGLE


def general_position(group: str) -> list[tuple[np.ndarray, np.ndarray]]:
    """All elements modulo lattice translations: matrices and shifts of columns of fractions."""
    seeds = [_parsed(text) for text in GENERATORS[group].split(";") if text]
    found = {((1, 0), (0, 1), (Fraction(0), Fraction(0)))}
    while True:
        grown = found | {_product(one, other) for one in found for other in seeds}
        if grown == found:
            return [(np.array(e[:2]), np.array(e[2], dtype=float)) for e in sorted(found)]
        found = grown


def orbit_tiling(group: str, points: np.ndarray) -> tuple[list[np.ndarray], np.ndarray]:
    """Voronoi cells of all images of generic points; three of them leave no further symmetry.

    Parameters
    ----------
    points : (n, 2) fractions of the conventional cell.

    Returns
    -------
    tiles, lattice : one polygon for each image in the conventional cell.
    """
    lattice = lattice_of(group)
    home = np.concatenate([points @ matrix.T + shift for matrix, shift in general_position(group)])
    home -= np.floor(home)
    grid = np.mgrid[-2:3, -2:3].reshape(2, -1).T
    grid = grid[np.argsort(np.abs(grid).sum(axis=1), kind="stable")]  # the cell itself leads
    diagram = Voronoi((home[None] + grid[:, None]).reshape(-1, 2) @ lattice)
    tiles = []
    for site in range(len(home)):
        corners = diagram.vertices[diagram.regions[diagram.point_region[site]]]
        arms = corners - diagram.points[site]
        tiles.append(corners[np.argsort(np.arctan2(arms[:, 1], arms[:, 0]))])
    return tiles, lattice


def _parsed(text: str):
    """Element "-x+1/2,y" as two matrix rows and a shift."""
    signed = [part if part.startswith("-") else "+" + part for part in text.strip().split(",")]
    rows = [tuple((f"+{v}" in part) - (f"-{v}" in part) for v in "xy") for part in signed]
    return rows[0], rows[1], tuple(Fraction("+1/2" in part, 2) for part in signed)


def _product(one, other):
    """First `one`, then `other`, modulo lattice translations."""
    (a, b), (c, d), (e, f) = one
    (p, q), (r, s), (t, u) = other
    return (
        (p * a + q * c, p * b + q * d),
        (r * a + s * c, r * b + s * d),
        ((p * e + q * f + t) % 1, (r * e + s * f + u) % 1),
    )

"""Edges through walls: two prisms side by side, and one that leans into the other."""

from __future__ import annotations

import numpy as np
import pytest

import flexscale as fs
from flexscale.embedding.bends import Bend
from flexscale.homogenize.joint_cell import JointCell
from flexscale.mechanics.prism_crossings import any_crossing, passes_through

WALL = np.array([[0.0, -1.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 2.0]])


@pytest.mark.parametrize(
    ("start", "end", "expected"),
    [
        ((-1.0, 0.0, 1.0), (1.0, 0.0, 1.0), True),
        ((1.0, 0.5, 1.9), (-1.0, 0.5, 1.9), True),
        ((-1.0, 0.0, 1.0), (-0.1, 0.0, 1.0), False),  # ends before it
        ((-1.0, 0.0, 2.1), (1.0, 0.0, 2.1), False),  # above it
        ((-1.0, 1.1, 1.0), (1.0, 1.1, 1.0), False),  # beside it
        ((-1.0, 0.0, 1.0), (-1.0, 0.5, 1.0), False),  # along it
    ],
)
def test_a_way_through_a_rectangle(start: tuple, end: tuple, expected: bool) -> None:
    assert passes_through(np.array(start), np.array(end), *WALL) == expected


@pytest.mark.parametrize("name", ["hexagon", "square"])
def test_scales_that_lean_into_one_another(name: str) -> None:
    """Tops of scales 4 mm high, 10 mm apart, with gaps of 0.4 mm meet at about 0.01 mm-1."""
    problem = JointCell(
        fs.named_pattern(name), fs.joint_law(fs.named_pattern(name)), fs.NativeModel()
    )
    table, cell = problem.contact.rows.table, problem.embedding
    for curvature, expected in ((0.0, False), (0.007, False), (0.012, True), (-0.03, False)):
        z = cell.rest.copy()
        z[3:6] = 1e-4, -2e-4, 1e-4  # no edges are exactly parallel to walls
        assert any_crossing(cell.place(z, Bend(curvature, 0.1)).y, table) == expected

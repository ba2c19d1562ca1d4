"""Cells on joints as pictures show them: where scales are marked that press on one another."""

from __future__ import annotations

import numpy as np
import pytest

import flexscale as fs
from flexscale.homogenize.shape import solve_shapes
from flexscale.plotting.cell_geometry import cell_offsets, lattice_motions

FAR = 1.1  # mm: two points that touch are each half an edge of the drawn mesh, 1 mm, off at most


@pytest.mark.parametrize(("pattern", "n_marked"), [("brick", 6), ("hexagon", 4)])
def test_marks_stand_where_scales_touch(pattern: str, n_marked: int) -> None:
    """Corners of bricks press on the middles of walls, whose own ends are free."""
    bends = [("closing", 90.0, 0.02), ("opening", 0.0, 0.01)]
    shape = solve_shapes(fs.named_pattern(pattern), bends)
    force = shape["contact_force"].values
    assert not force[1].any()
    marked = np.flatnonzero(force[0] > 0.0)
    assert len(marked) == n_marked
    world = (shape["points"].values + shape["displacement"].values[0])[marked]
    xx, yy, xy = shape["stretch"].values[0]
    offsets = cell_offsets(5)
    offsets = offsets[offsets.any(axis=1)]
    shifts = offsets @ shape["lattice"].values @ np.array([[xx, xy], [xy, yy]])
    turns, ways = lattice_motions(shifts, 90.0, 0.02)
    others = np.concatenate([world @ turn.T + way for turn, way in zip(turns, ways, strict=True)])
    apart = np.linalg.norm(world[:, None] - others[None], axis=2)
    assert apart.min(axis=1).max() < FAR
    # Half a turn maps these cells to themselves.
    points = shape["points"].values[marked]
    turned = np.linalg.norm(points[:, None] - points * [-1.0, -1.0, 1.0], axis=2).argmin(axis=1)
    np.testing.assert_allclose(points[turned], points * [-1.0, -1.0, 1.0], atol=1e-6)
    np.testing.assert_allclose(force[0, marked][turned], force[0, marked], rtol=1e-4)

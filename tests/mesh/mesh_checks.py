"""What a periodic mesh must be whatever the pattern: a torus, filled, covered and watertight."""

from __future__ import annotations

import numpy as np
import pytest

from flexscale.errors import PatternError
from flexscale.mesh import PeriodicMesh
from flexscale.patterns import Pattern
from flexscale.patterns.cell import polygon_area
from flexscale.tilings import Tiling


def pattern_if_any(tiling: Tiling, **sizes: float) -> Pattern | None:
    """The pattern, or None if its tiles are too thin for the gap to leave scales in one piece."""
    try:
        return Pattern(tiling, **sizes)
    except PatternError as error:
        if "is too wide for tile" not in str(error):
            raise
        return None


def assert_sound(mesh: PeriodicMesh, pattern: Pattern) -> None:
    """Conforming torus of positive area, scales of positive volume with closed surfaces."""
    mesh.validate()
    assert mesh.n_scales == pattern.n_scales
    assert_conforming(mesh)
    areas = mesh.triangle_areas()
    assert areas.min() > 0.0
    assert areas.sum() == pytest.approx(pattern.cell_area, rel=1e-10)
    assert mesh.tet_volumes().min() > 0.0
    sides = np.stack([mesh.surface_triangles, np.roll(mesh.surface_triangles, -1, axis=1)], axis=-1)
    forth = np.sort(_keys(sides, mesh.n_scale_vertices))
    back = np.sort(_keys(sides[..., ::-1], mesh.n_scale_vertices))
    assert (np.diff(forth) > 0).all()
    assert np.array_equal(forth, back), "the surface of a scale is not closed"
    signed = np.linalg.det(mesh.scale_positions[mesh.surface_triangles]) / 6.0
    for scale, outline in enumerate(pattern.outlines()):
        area = polygon_area(outline)
        assert areas[mesh.triangle_scale == scale].sum() == pytest.approx(area, rel=1e-9)
        volume = area * pattern.scale_height
        assert mesh.tet_volumes()[mesh.tet_scale == scale].sum() == pytest.approx(volume, rel=1e-9)
        assert signed[mesh.surface_scale == scale].sum() == pytest.approx(volume, rel=1e-9)


def assert_conforming(mesh: PeriodicMesh) -> None:
    """Every edge has two triangles, in opposite directions, whose ends are where the edge's are."""
    assert mesh.euler_characteristic == 0
    edges = mesh.triangle_edges
    a, b = mesh.edges[edges].transpose(2, 0, 1)
    offset = mesh.triangle_edge_offsets
    starts_at_a = (mesh.triangles == a) & (offset == mesh.triangle_offsets).all(axis=2)
    assert (np.bincount(edges.ravel()) == 2).all()
    directions = np.where(starts_at_a, 1.0, -1.0)
    assert not np.bincount(edges.ravel(), directions.ravel()).any()
    corners = mesh.corner_positions()
    ends = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2)
    ends = np.where(starts_at_a[..., None, None], ends, ends[:, :, ::-1])
    shifts = np.stack([offset, offset + mesh.edge_shift[edges]], axis=2)
    expected = mesh.positions[np.stack([a, b], axis=2)] + shifts @ mesh.lattice
    assert np.abs(ends - expected).max() < 1e-10


def _keys(sides: np.ndarray, n: int) -> np.ndarray:
    return (sides[..., 0] * n + sides[..., 1]).ravel()

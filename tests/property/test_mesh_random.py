"""Random patterns give valid meshes: any quadrilateral covers the plane with its turned copy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from flexscale.mesh import MeshOptions, build_mesh
from flexscale.patterns import Pattern
from flexscale.patterns.cell import polygon_area
from flexscale.tilings import Tiling
from tests.property.mesh_symmetry import assert_symmetric, point_group

FEW = settings(max_examples=12, deadline=None, suppress_health_check=list(HealthCheck))
COORDINATE = st.floats(-2.5, 2.5)
OPTIONS = st.builds(
    MeshOptions,
    across=st.sampled_from([2, 4]),
    along=st.floats(0.5, 3.0),
    corner=st.floats(0.1, 1.0),
    growth=st.floats(1.0, 2.5),
    scale_size=st.floats(1.0, 6.0),
    scale_corner=st.floats(0.2, 3.0),
    scale_rim=st.floats(0.05, 2.0),
    scale_strips=st.sampled_from([0, 1, 3]),
    scale_growth=st.floats(1.0, 4.0),
    scale_layers=st.sampled_from([1, 2]),
    layer_growth=st.floats(0.5, 4.0),
)


def quadrilateral_pattern(corners: np.ndarray, gap: float) -> Pattern:
    """A quadrilateral and its copy turned by 180° about the middle of a side."""
    a, b, c, d = corners
    return Pattern.from_polygons([corners, a + b - corners], c - a, d - b, gap=gap)


@FEW
@given(st.lists(COORDINATE, min_size=8, max_size=8), st.floats(0.1, 0.8), OPTIONS)
def test_quadrilaterals(moves: list[float], gap: float, options: MeshOptions) -> None:
    corners = np.array([(0, 0), (10, 0), (10, 10), (0, 10)]) + np.reshape(moves, (4, 2))
    assume(polygon_area(corners) > 30.0)
    pattern = quadrilateral_pattern(corners, gap)
    mesh = build_mesh(pattern, options)  # validates itself
    assert len(pattern.prototiles) == 1
    assert_symmetric(mesh, point_group(0.5 * (corners[0] + corners[1]), 2, False)[1])


@FEW
@given(st.floats(0.05, 5.0), st.floats(0.1, 1.5), OPTIONS)
def test_shifted_rows_of_bricks(shift: float, gap: float, options: MeshOptions) -> None:
    """T-junctions anywhere along an edge, with and without a corner of the outline for each."""
    tile = [(0, 0), (10, 0), (10, 6), (0, 6)]
    mesh = build_mesh(Pattern.from_polygons([tile], (10, 0), (shift, 6), gap=gap), options)
    assert_symmetric(mesh, point_group(np.array([5.0, 3.0]), 2, False)[1])


@pytest.mark.parametrize("family", ["IH20", "IH76"])
@given(OPTIONS, st.floats(0.05, 3.0), st.floats(10.0, 200.0))
@FEW
def test_full_point_group_at_any_size(
    family: str, options: MeshOptions, gap: float, tile_area: float
) -> None:
    mesh = build_mesh(Pattern(Tiling(family), gap=min(gap, 0.2 * tile_area**0.5),
                              tile_area=tile_area), options)  # fmt: skip
    for isometry in point_group(np.zeros(2), 6 if family == "IH20" else 4, True):
        assert_symmetric(mesh, isometry)


def test_another_cell_of_the_lattice_gives_the_same_mesh() -> None:
    """t1, t1 + t2 instead of t1, t2: same triangles, other names of their offsets."""
    tile = [(0, 0), (10, 0), (10, 5), (0, 5)]
    first = build_mesh(Pattern.from_polygons([tile], (10, 0), (5, 5)))
    second = build_mesh(Pattern.from_polygons([tile], (10, 0), (15, 5)))
    assert np.allclose(first.corner_positions(), second.corner_positions(), atol=1e-12)
    assert np.allclose(first.scale_positions, second.scale_positions, atol=1e-12)

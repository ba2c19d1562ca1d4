"""Random patterns give sound meshes with the symmetry of what is drawn."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from flexscale.errors import TilingError
from flexscale.mesh import MeshOptions, build_mesh
from flexscale.patterns import Pattern
from flexscale.patterns.cell import polygon_area
from flexscale.tilings import Tiling
from flexscale.tilings.drawn_symmetry import drawn_symmetry
from tests.mesh.mesh_checks import assert_sound, pattern_if_any
from tests.property.mesh_symmetry import assert_symmetric, point_group
from tests.property.test_tilings_random import tilings

FEW = settings(max_examples=12, deadline=None, suppress_health_check=list(HealthCheck))
#: The same examples every time: the slow test below looks for a thousand new ones.
SOME = settings(FEW, max_examples=8, derandomize=True)
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
    middle = 0.5 * (corners[1] - corners[0])  # the first corner of the first tile is the origin
    assert_symmetric(mesh, point_group(middle, 2, False)[1])


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


def check_tiling(tiling: Tiling, gap: float, options: MeshOptions) -> None:
    """Sound, and symmetric under all that is exact to rounding; or too thin for the gap.

    Shapes are rounded: one that misses a symmetry by less than tolerances tell apart has a mesh
    that misses it as well.
    """
    edges = {letter: curve.round(6) for letter, curve in tiling.edges.items()}
    try:
        rounded = Tiling(tiling.family, np.round(tiling.parameters, 6), edges)
    except TilingError:
        assume(False)
    pattern = pattern_if_any(rounded, gap=gap)
    if pattern is None:
        return
    mesh = build_mesh(pattern, options)
    assert_sound(mesh, pattern)
    for operation in drawn_symmetry(pattern.tiles, pattern.lattice, tolerance=1e-9).operations:
        assert_symmetric(mesh, operation)


LINEAR = MeshOptions(scale_order=1)


@SOME
@given(tilings(curved=False), st.floats(0.1, 0.8))
def test_straight_tilings(tiling: Tiling, gap: float) -> None:
    check_tiling(tiling, gap, LINEAR)


@SOME
@given(tilings(curved=True), st.floats(0.1, 0.8))
def test_curved_tilings(tiling: Tiling, gap: float) -> None:
    check_tiling(tiling, gap, LINEAR)


@settings(SOME, max_examples=4)
@given(st.booleans().flatmap(tilings), st.floats(0.05, 0.8), OPTIONS)
def test_tilings_with_any_element_sizes(tiling: Tiling, gap: float, options: MeshOptions) -> None:
    check_tiling(tiling, gap, options)


@pytest.mark.slow
@settings(FEW, max_examples=1000)
@given(st.booleans().flatmap(tilings), st.floats(0.05, 0.8), st.just(LINEAR) | OPTIONS)
def test_many_tilings(tiling: Tiling, gap: float, options: MeshOptions) -> None:
    check_tiling(tiling, gap, options)


def test_another_cell_of_the_lattice_gives_the_same_mesh() -> None:
    """t1, t1 + t2 instead of t1, t2: same triangles, other names of their offsets."""
    tile = [(0, 0), (10, 0), (10, 5), (0, 5)]
    first = build_mesh(Pattern.from_polygons([tile], (10, 0), (5, 5)))
    second = build_mesh(Pattern.from_polygons([tile], (10, 0), (15, 5)))
    assert np.allclose(first.corner_positions(), second.corner_positions(), atol=1e-12)
    assert np.allclose(first.scale_positions, second.scale_positions, atol=1e-12)

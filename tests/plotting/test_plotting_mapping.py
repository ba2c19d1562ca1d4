"""Curvilinear and world space, and the meshes of a cell."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from flexscale.plotting.both_sides import both_sides
from flexscale.plotting.mapping import (
    bend_points,
    mapping,
    mapping_states,
    scale_strain,
    unbend_points,
)
from flexscale.plotting.meshes import base_outline, conformity
from tests.plotting.plotting_data import bend, prism_shape, two_regime_sweep


@pytest.mark.parametrize(("direction", "curvature"), [(0.0, 0.02), (37.0, -0.03), (90.0, 0.001)])
def test_bending_and_unbending(direction: float, curvature: float) -> None:
    points = np.random.default_rng(3).uniform(-9.0, 9.0, (30, 3))
    world = bend_points(points, direction, curvature)
    np.testing.assert_allclose(world, bend(points, direction, curvature), atol=1e-10)
    np.testing.assert_allclose(unbend_points(world, direction, curvature), points, atol=1e-9)


def prisms(curvature: float) -> xr.Dataset:
    """Undistorted prisms on a bent sheet, with a tetrahedron of each scale's corners."""
    shape = prism_shape(4, [(30.0, curvature)])
    return shape.assign(tets=(("tet", "tet_corner"), np.array([[0, 1, 3, 4]])))


@pytest.mark.parametrize("curvature", [0.02, -0.02])
def test_the_planar_start_strains_scales_and_equilibrium_does_not(curvature: float) -> None:
    planar, at_rest = scale_strain(prisms(curvature))
    assert at_rest < 1e-12, "prisms are rigid"
    assert 0.02 * 4.8 / 4 < planar < 0.02 * 4.8, "strain is about curvature times height"
    start, bent, unbent, world = mapping_states(prisms(curvature), 0)
    assert float(np.abs(start["displacement"]).max()) == 0.0
    assert float(start["sample_curvature"][0]) == float(unbent["sample_curvature"][0]) == 0.0
    assert float(bent["sample_curvature"][0]) == float(world["sample_curvature"][0]) == curvature


def test_the_picture_has_four_panels() -> None:
    assert len(mapping(prisms(0.02)).axes) == 4


def test_contact_is_marked_on_the_curves() -> None:
    sweep = two_regime_sweep(4)
    touching = (sweep["moment"] > 1.1 * sweep["moment"].isel(side=1)).astype(int)
    sweep["contact_pairs"] = touching.transpose("side", "direction", "curvature")
    shape = prism_shape(4, [(0.0, 0.02), (0.0, -0.02)])
    figure = both_sides(sweep, shape, 0.0)
    curve, *pictures = figure.axes
    assert [axes.get_title()[:7] for axes in pictures] == ["closing", "opening"]
    filled = [
        line
        for line in curve.get_lines()
        if line.get_marker() == "o" and line.get_markerfacecolor() != "white"
    ]
    expected = sweep["curvature"].values[touching.sel(side="closing").isel(direction=0) > 0]
    np.testing.assert_array_equal(filled[0].get_xdata(), expected)
    assert len(expected) > 0
    assert len(filled[1].get_xdata()) == 0, "nothing touches when opening"


def square_cell(shift: float) -> xr.Dataset:
    """Two base triangles of a unit square over substrate vertices, one of them moved."""
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    solid = np.column_stack([corners, np.zeros(4)])
    positions = corners.copy()
    positions[2, 0] += shift
    return xr.Dataset(
        {
            "scale_positions": (("scale_vertex", "space"), solid),
            "base_triangles": (("base_triangle", "base_corner"), np.array([[0, 1, 2], [0, 2, 3]])),
            "positions": (("vertex", "plane"), positions),
            "lattice": (("lattice_vector", "plane"), 5.0 * np.eye(2)),
        }
    )


def test_outlines_and_how_far_a_mesh_is_from_conforming() -> None:
    outline = base_outline(square_cell(0.0))
    assert len(outline) == 4, "the diagonal is inside"
    assert np.allclose(np.linalg.norm(outline[:, 1] - outline[:, 0], axis=1), 1.0)
    assert conformity(square_cell(0.0)) == 0.0
    assert conformity(square_cell(0.3)) == pytest.approx(0.3)

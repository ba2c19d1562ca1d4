"""Bonds of sheet points to scale bases."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from flexscale.errors import MeshError
from flexscale.mesh import Bonds, MeshOptions, PeriodicMesh, build_bonds, build_mesh
from tests.patterns.pattern_shapes import SHAPES

RADIUS = 0.4
#: Bonds are of sheet points to the bases of scales: one layer of tets is enough.
FLAT = MeshOptions(scale_layers=1)
COARSE = FLAT.finer(0.5)


@cache
def mesh_of(name: str, order: int = 2, options: MeshOptions = FLAT) -> PeriodicMesh:
    """Mesh of a shape, with the default base if nothing else is said, built once."""
    return build_mesh(SHAPES[name][0], replace(options, scale_order=order))


def outline(mesh: PeriodicMesh) -> np.ndarray:
    return np.flatnonzero((mesh.vertex_kind == 1) | (mesh.vertex_kind == 2))


def apply(bonds: Bonds, field: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values (n,) and gradients (n, 2) of a field on scale vertices."""
    rows = np.repeat(np.arange(len(bonds.indptr) - 1), np.diff(bonds.indptr))
    carried = field[bonds.scale_vertices]
    slopes = [np.bincount(rows, bonds.gradients[:, k] * carried) for k in (0, 1)]
    return np.bincount(rows, bonds.values * carried), np.stack(slopes, axis=1)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("name", list(SHAPES))
def test_linear_fields_are_reproduced(name: str, order: int) -> None:
    """On any mesh, so on a coarse one: the time goes with the points of the sheet."""
    mesh = mesh_of(name, order, COARSE)
    carried = np.flatnonzero(mesh.vertex_scale >= 0)
    points, scales = mesh.positions[carried], mesh.vertex_scale[carried]
    radius = np.where(np.isin(carried, outline(mesh)), RADIUS, 0.0)
    bonds = build_bonds(mesh, points, scales, radius)
    slope = np.array([2.0, -1.5])
    values, slopes = apply(bonds, 0.3 + mesh.scale_positions[:, :2] @ slope)
    assert np.abs(values - (0.3 + points @ slope)).max() < 1e-11
    assert np.abs(slopes - slope).max() < 1e-10
    assert (mesh.scale_positions[bonds.scale_vertices, 2] == 0.0).all()


@pytest.mark.parametrize("order", [1, 2])
def test_gradient_at_a_base_vertex_is_the_mean_over_its_triangles(order: int) -> None:
    mesh = mesh_of("square", order)
    kink = int(
        np.flatnonzero(np.linalg.norm(mesh.scale_positions - [4.8, 4.8, 0], axis=1) < 1e-9)[0]
    )
    around = mesh.base_triangles[(mesh.base_triangles == kink).any(axis=1)]
    assert len(around) >= 2
    bump = np.zeros(mesh.n_scale_vertices)
    bump[kink] = 1.0
    expected = np.mean([_gradient(mesh.scale_positions[t, :2], bump[t]) for t in around], axis=0)
    bonds = build_bonds(mesh, mesh.scale_positions[[kink], :2], np.array([0]))
    slope = 1.0 if order == 1 else 3.0  # of a quadratic shape function at its own corner
    expected *= slope
    assert np.allclose(bonds.gradients[bonds.scale_vertices == kink][0], expected, atol=1e-12)
    assert bonds.values[bonds.scale_vertices == kink] == pytest.approx(1.0)


def _gradient(corners: np.ndarray, values: np.ndarray) -> np.ndarray:
    return np.linalg.solve(np.column_stack([corners[:3], np.ones(3)]), values[:3])[:2]


@pytest.mark.parametrize("order", [1, 2])
def test_small_radius_tends_to_the_point(order: int) -> None:
    mesh = mesh_of("hexagon", order)
    chosen = np.flatnonzero(mesh.vertex_kind == 1)
    corners = mesh.scale_positions[mesh.base_triangles[:, :3], :2].reshape(-1, 2)
    apart = np.linalg.norm(mesh.positions[chosen, None] - corners, axis=2).min(axis=1)
    chosen = chosen[apart > 0.1]  # within one base triangle, where the gradient is unique
    assert len(chosen) > 5
    points, scales = mesh.positions[chosen], mesh.vertex_scale[chosen]
    field = np.random.default_rng(5).normal(size=mesh.n_scale_vertices)
    value, slope = apply(build_bonds(mesh, points, scales), field)
    errors = []
    for radius in (1e-2, 1e-3):
        value_near, slope_near = apply(build_bonds(mesh, points, scales, radius), field)
        errors.append((np.abs(value_near - value).max(), np.abs(slope_near - slope).max()))
    if order == 1:  # within one triangle the base is affine already
        assert max(errors[1]) < 1e-9
    else:
        assert errors[1][0] < 0.011 * errors[0][0]
        assert errors[1][1] < 0.11 * errors[0][1]


def test_fit_of_a_parabola() -> None:
    """Over a whole disc the best plane for x^2 lies b^2 / 8 above it: the weighted mean of x^2."""
    mesh = mesh_of("square")
    point = np.array([0.7, -0.4])
    bonds = build_bonds(mesh, point[None], np.array([0]), RADIUS)
    value, slope = apply(bonds, (mesh.scale_positions[:, 0] - point[0]) ** 2)
    assert value[0] == pytest.approx(RADIUS**2 / 8.0, rel=2e-3)
    assert np.abs(slope).max() < 2e-3 * RADIUS


def test_fit_of_a_parabola_at_a_straight_outline() -> None:
    """Over half a disc, y from the outline inward: moments of the weight in closed form.

    With m_k the integral of w y^k, (X0, G) solve m_0 X0 + m_1 G = m_2, m_1 X0 + m_2 G = m_3.
    """
    mesh = mesh_of("square")
    bonds = build_bonds(mesh, np.array([[-4.8, 1.1]]), np.array([0]), RADIUS)
    value, slope = apply(bonds, (mesh.scale_positions[:, 0] + 4.8) ** 2)
    radial = [1 / (k + 2) - 2 / (k + 4) + 1 / (k + 6) for k in range(4)]
    angular = [np.pi, 2.0, np.pi / 2.0, 4.0 / 3.0]  # integrals of cos^k over the half circle
    m = np.multiply(radial, angular)
    expected = np.linalg.solve([[m[0], m[1]], [m[1], m[2]]], [m[2], m[3]])
    assert value[0] == pytest.approx(expected[0] * RADIUS**2, rel=5e-3)
    assert slope[0, 0] == pytest.approx(expected[1] * RADIUS, rel=2e-3)
    assert abs(slope[0, 1]) < 2e-3 * RADIUS


@pytest.mark.parametrize("name", ["square", "hexagon", "pinwheel 6", "arrowhead"])
def test_spread_bonds_have_the_symmetry_of_the_tile(name: str) -> None:
    """A field carried to the tile by a symmetry has there the value and gradient of its image."""
    pattern = SHAPES[name][0]
    mesh = mesh_of(name, options=COARSE)
    assert np.array_equal(pattern.copies[0].placement.linear, np.eye(2))
    shift = pattern.copies[0].placement.translation
    own = outline(mesh)[mesh.vertex_scale[outline(mesh)] == 0]
    points, scales = mesh.positions[own], np.zeros(len(own), dtype=int)

    def field(places: np.ndarray) -> np.ndarray:
        return np.sin(places @ [1.3, 0.4]) + places[:, 0] * places[:, 1]

    for symmetry in pattern.prototiles[0].stabiliser:
        images = symmetry.apply(points - shift) + shift
        value, slope = apply(
            build_bonds(mesh, images, scales, RADIUS), field(mesh.scale_positions[:, :2] - shift)
        )
        moved = symmetry.apply(mesh.scale_positions[:, :2] - shift)
        value_here, slope_here = apply(build_bonds(mesh, points, scales, RADIUS), field(moved))
        assert np.abs(value_here - value).max() < 1e-12 * np.abs(value).max()
        assert np.abs(slope_here - slope @ symmetry.linear).max() < 1e-12 * np.abs(slope).max()


def test_point_outside_its_scale_is_refused() -> None:
    mesh = mesh_of("square")
    for radius in (0.0, RADIUS):
        with pytest.raises(MeshError, match=r"\(4.9, 0\) mm does not lie under scale 0"):
            build_bonds(mesh, np.array([[4.9, 0.0]]), np.array([0]), radius)


def test_no_points() -> None:
    bonds = build_bonds(mesh_of("square"), np.zeros((0, 2)), np.zeros(0, dtype=int))
    assert bonds.indptr.tolist() == [0]
    assert bonds.gradients.shape == (0, 2)

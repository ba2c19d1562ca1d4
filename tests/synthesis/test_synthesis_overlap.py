"""Overlap of rigid prisms against closed forms, its derivative, and the quadratic program."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

import flexscale as fs
from flexscale.mesh.prism_surface import prism_surface
from flexscale.synthesis.contact_rows import contact_rows
from flexscale.synthesis.convex import convex_parts
from flexscale.synthesis.overlap import close_pairs, measure_overlap
from flexscale.synthesis.placement import Placement
from flexscale.synthesis.prisms import build_parts, moments_of
from flexscale.synthesis.quadratic_program import solve_qp
from flexscale.synthesis.separation import Kept, place_parts, separations

HEIGHT = 4.0


def box(x0: float, y0: float, x1: float, y1: float) -> np.ndarray:
    return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], dtype=float)


def around_y(angle: float) -> np.ndarray:
    """Turns z toward -x."""
    return Rotation.from_rotvec([0.0, -angle, 0.0]).as_matrix()


@pytest.mark.parametrize("angle", [0.05, 0.125, 0.2, 0.5])
@pytest.mark.parametrize("seed", [0, 1])
def test_depth_of_two_hinged_boxes(angle, seed):
    """Two boxes lean toward each other by `angle`, their base edges `gap` apart. The top edges pass
    each other by 2 h sin(angle/2) - gap along the base, and the shortest way out is along a side's
    normal: cos(angle/2) of that."""
    gap, whole = 0.3, Rotation.random(rng=seed)
    left, right = around_y(0.5 * angle), around_y(-0.5 * angle)
    # Sides lean to the middle: the left box turns its top toward +x.
    rotations = whole.as_matrix() @ np.array([right, left])
    shifts = whole.apply([(-0.5 * gap, 1.0, 2.0), (0.5 * gap, 1.0, 2.0)])
    parts = build_parts([box(-9.6, -5.0, 0.0, 5.0), box(0.0, -5.0, 9.6, 5.0)], HEIGHT)
    expected = HEIGHT * np.sin(angle) - gap * np.cos(0.5 * angle)
    overlap = measure_overlap(parts, Placement(rotations, shifts))
    assert overlap.deepest == pytest.approx(max(expected, 0.0), abs=1e-12)
    assert len(overlap.pairs) == (expected > 0.0)


def test_a_tip_in_a_notch_overlaps_only_where_it_touches():
    """The hulls overlap by far, the bodies not at all until the tip reaches the notch's ground."""
    notched = np.array(
        [(0, 0), (10, 0), (10, 10), (6, 10), (6, 4), (4, 4), (4, 10), (0, 10)], float
    )
    for sunk, depth in ((-0.2, 0.0), (0.3, 0.3)):
        tip = box(4.5, 4.0 - sunk, 5.5, 12.0)
        parts = build_parts([notched, tip], HEIGHT)
        still = Placement(np.tile(np.eye(3), (2, 1, 1)), np.zeros((2, 3)))
        assert measure_overlap(parts, still).deepest == pytest.approx(depth, abs=1e-12)


@pytest.mark.parametrize("name", ["arrowhead", "chevron", "pinwheel3", "s_curve", "fish_scale"])
def test_convex_parts_fill_an_outline(name):
    for outline in fs.named_pattern(name).outlines():
        x, y = outline.T
        area = 0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1))
        areas = []
        for part in convex_parts(outline):
            after = np.roll(outline[part], -1, axis=0) - outline[part]
            turns = np.linalg.det(np.stack([after, np.roll(after, -1, axis=0)], axis=1))
            assert turns.min() > -1e-5
            u, v = outline[part].T
            areas.append(0.5 * (u @ np.roll(v, -1) - v @ np.roll(u, -1)))
        assert sum(areas) == pytest.approx(area, rel=1e-12)


def test_moments_and_surface_of_a_box():
    outline = box(2.0, 1.0, 8.0, 4.0)
    moments = moments_of([outline], HEIGHT)
    assert moments.volumes[0] == pytest.approx(72.0)
    np.testing.assert_allclose(moments.centers[0], [5.0, 2.5, 2.0])
    squares = np.array([6.0, 3.0, 4.0]) ** 2 / 12.0
    np.testing.assert_allclose(moments.turning[0], np.diag(squares.sum() - squares), atol=1e-12)
    vertices, triangles = prism_surface(outline, HEIGHT)
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0 == pytest.approx(72.0)


@pytest.mark.parametrize("seed", range(4))
def test_rows_are_derivatives_of_separations(seed):
    """Against differences, for boxes that overlap at random angles; face and edge contacts occur.

    Where boxes are apart, edges may be closest at their ends: then the row is an approximation."""
    random = np.random.default_rng(seed)
    n = 12
    outlines = [box(-3.0, -2.0, 3.0, 2.0)] * n
    centers = random.uniform(-4.0, 4.0, (n, 3))
    start = Placement(Rotation.random(n, rng=random).as_matrix(), centers)
    parts = build_parts(outlines, HEIGHT)
    world = place_parts(parts, start)
    pairs = close_pairs(parts.owner, world, 0.0)
    pairs = pairs[separations(world, pairs).distances < 0.0]
    found = separations(world, pairs)
    rows = contact_rows(world, parts.owner, pairs, found, np.inf)
    assert (found.numbers < 2 * world.n_faces).any()
    assert (found.numbers >= 2 * world.n_faces).any()
    step = 1e-6 * random.normal(size=(n, 6))
    turned = Rotation.from_rotvec(step[:, 3:]).as_matrix() @ start.rotations
    after = place_parts(parts, Placement(turned, centers + step[:, :3]))
    # The same directions again, however good others are by now.
    moved = separations(after, pairs, kept=Kept(found.numbers, np.inf, -np.inf))
    change = rows.matrix(centers) @ step.ravel()
    for pair, (distance, new) in enumerate(zip(found.distances, moved.distances, strict=True)):
        here = (rows.scales == parts.owner[pairs[pair]]).all(axis=1)
        nearest = np.flatnonzero(here)[rows.gaps[here].argmin()]
        assert rows.gaps[nearest] == pytest.approx(distance, abs=1e-9)
        assert change[nearest] == pytest.approx(new - distance, abs=2e-9)


def test_quadratic_program_agrees_with_another_solver():
    random = np.random.default_rng(5)
    root, rows = random.normal(size=(6, 6)), random.normal(size=(14, 6))
    hessian = root @ root.T + np.eye(6)
    bounds = rows @ random.normal(size=6) - random.uniform(0.0, 0.5, 14)
    found = solve_qp(sp.csc_array(hessian), sp.csr_array(rows), bounds, 1e-10)
    reference = minimize(
        lambda x: 0.5 * x @ hessian @ x, np.zeros(6), jac=lambda x: hessian @ x, method="SLSQP",
        constraints={"type": "ineq", "fun": lambda x: rows @ x - bounds, "jac": lambda x: rows},
        options={"ftol": 1e-14},
    )  # fmt: skip
    assert (rows @ found - bounds).min() > -1e-8
    np.testing.assert_allclose(found, reference.x, atol=1e-6)


def test_contradictory_inequalities_are_softened():
    """x >= 1 and -x >= 1: the mean of both, not an error."""
    found = solve_qp(sp.csc_array(np.eye(1)), sp.csr_array([[1.0], [-1.0]]), np.ones(2), 1e-6)
    assert abs(found[0]) < 1e-3

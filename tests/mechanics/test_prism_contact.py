"""Contact of prisms: distances by type against another computation, derivatives, way lengths."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from flexscale.mechanics.jets import jet_length
from flexscale.mechanics.prism_contact import PrismContact, find_prism_rows
from flexscale.mechanics.prism_kernels import (
    N_WORK,
    barrier_jet,
    energy_of,
    free_share_of,
    nearest,
    squared_on_the_way,
)
from tests.derivatives import directional_difference, relative_error
from tests.mechanics.test_jets import hessian_of

N = 12  # coordinates of a candidate
SQUARE = np.array([[-5.0, -5.0], [5.0, -5.0], [5.0, 5.0], [-5.0, 5.0]])


def candidate(seed: int, is_wall: bool) -> np.ndarray:
    """(4, 3) rows: a point near a unit wall, or two edges, some of them almost parallel."""
    generator = np.random.default_rng(seed)
    if is_wall:
        point = [*generator.uniform(-0.5, 1.5, 2), generator.uniform(0.05, 0.3)]
        rows = np.array([point, [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    else:
        rows = 0.5 * generator.normal(size=(4, 3))
        if seed % 3 == 0:
            rows[3] = rows[2] + rows[1] - rows[0] + 0.01 * generator.normal(size=3)
    return rows @ Rotation.random(random_state=seed).as_matrix().T


def squared_distance(is_wall: bool, x: np.ndarray) -> float:
    """The same by a search over the points of both things."""
    first = np.zeros((2, 3)) if is_wall else np.array([x[1] - x[0], np.zeros(3)])
    second = np.array([x[2] - x[1], x[3] - x[1]] if is_wall else [np.zeros(3), x[3] - x[2]])
    rest, ways = x[0] - x[1 if is_wall else 2], first - second

    def squared(p: np.ndarray) -> tuple[float, np.ndarray]:
        arrow = rest + p @ ways
        return float(arrow @ arrow), 2.0 * ways @ arrow

    def search(p: tuple[float, float]) -> float:
        options = {"ftol": 1e-16, "gtol": 1e-14}
        found = minimize(squared, p, jac=True, bounds=[(0.0, 1.0)] * 2, options=options)
        return float(found.fun)

    return min(search(p) for p in ((0.5, 0.5), (0.0, 1.0), (1.0, 0.0)))


@pytest.mark.parametrize("is_wall", [True, False])
def test_distances_are_those_of_the_nearest_points(is_wall: bool) -> None:
    for seed in range(40):
        x = candidate(seed, is_wall)
        found = squared_distance(is_wall, x)
        assert nearest(is_wall, x, np.empty(4))[0] == pytest.approx(found, rel=1e-6)
        assert squared_on_the_way(is_wall, x) == pytest.approx(found, rel=1e-6)


def test_distances_from_sheared_walls_and_of_parallel_edges() -> None:
    """Corners go straight where scales turn, so that walls are no rectangles on the way."""
    for seed in range(40):
        x = candidate(seed, True)
        x[3] += np.random.default_rng(seed).uniform(-0.6, 0.6) * (x[2] - x[1])
        assert squared_on_the_way(True, x) == pytest.approx(squared_distance(True, x), rel=1e-6)
    x = candidate(1, False)
    for slant in (0.0, 1e-9, 1e-6, 1e-5, 1e-4):
        x[2:] = x[:2] + np.array([[0.0, 0.0, 0.1], [0.0, slant, 0.1]])
        x[2:] += 0.5 * (x[1] - x[0])
        assert squared_on_the_way(False, x) == pytest.approx(squared_distance(False, x), rel=1e-6)


@pytest.mark.parametrize("is_wall", [True, False])
def test_barrier_has_exact_derivatives(is_wall: bool) -> None:
    size = jet_length(N, 2)
    work, out = np.empty((N_WORK, size)), np.empty(size)

    def jet(y: np.ndarray, d_hat: float) -> np.ndarray:
        rows = np.zeros((4, 3, size))
        rows[:, :, 0] = y.reshape(4, 3)
        rows[:, :, 1 : 1 + N] = np.eye(N).reshape(4, 3, N)
        assert barrier_jet(is_wall, rows, d_hat, work, out, N, 2)
        return out.copy()

    def check(seed: int) -> int:
        x, generator = candidate(seed, is_wall), np.random.default_rng(seed)
        way, (squared, code) = generator.normal(size=N), nearest(is_wall, x, np.empty(4))
        d_hat, step = 2.0 * squared, 1e-4 * np.sqrt(squared)
        here = jet(x.ravel(), d_hat)
        slope = directional_difference(
            lambda s: energy_of(is_wall, (x.ravel() + s * way).reshape(4, 3), d_hat, np.empty(4)),
            step,
        )
        assert abs(here[1 : 1 + N] @ way - slope) < 1e-6 * np.linalg.norm(here[1 : 1 + N])
        bend = directional_difference(lambda s: jet(x.ravel() + s * way, d_hat)[1 : 1 + N], step)
        product = hessian_of(here, N) @ way
        assert np.linalg.norm(product - bend) < 1e-5 * np.linalg.norm(here[1 + N :])
        return code

    # Every type of nearest points is met.
    assert {check(seed) for seed in range(60)} >= {0, 1, 2 if is_wall else 3}


def test_nothing_passes_through_on_the_free_part_of_a_way() -> None:
    for seed in range(30):
        x = candidate(seed, True)
        end = x.copy()
        normal = np.cross(x[2] - x[1], x[3] - x[1])
        end[0] -= 2.0 * normal * np.sign(normal @ (x[0] - x[1]))  # to the other side of the plane
        share = free_share_of(True, x, end, 0.0, 10_000)
        before = nearest(True, x, np.empty(4))[0]
        along = [nearest(True, x + s * share * (end - x), np.empty(4))[0]
                 for s in np.linspace(0.0, 1.0, 200)]  # fmt: skip
        assert min(along) > 0.0
        inside = nearest(True, x + 1e-9 * (end - x), np.empty(4))[1] == 2
        if inside:  # the corner is before the wall, and would go through it
            assert share < 1.0
            assert along[-1] < 0.5**2 * before


def test_nothing_passes_through_walls_that_turn() -> None:
    """A corner close before a wall that turns about its diagonal, so that it is sheared midway."""
    for seed in range(20):
        generator = np.random.default_rng(seed)
        near = 10.0 ** -generator.uniform(3.0, 5.0)
        rest = np.array([[0.3, 0.4, near], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
        turned = rest @ Rotation.from_rotvec([0.2, 0.2, 0.0]).as_matrix().T
        turned[0] = [0.3, 0.4, turned[0, 2] - 1.5 * near]
        share = free_share_of(True, rest, turned, 0.0, 10_000)

        def height(s: float, x: np.ndarray = rest, end: np.ndarray = turned) -> float:
            y = x + s * (end - x)
            normal = np.cross(y[2] - y[1], y[3] - y[1])
            return float((y[0] - y[1]) @ normal / np.linalg.norm(normal))

        assert height(1.0) < 0.0
        assert min(height(s) for s in np.linspace(0.0, share, 1000)) > 0.0
        assert share > 0.0


def test_what_is_apart_keeps_a_least_distance() -> None:
    """Two rims 18 mm long and almost parallel, as of scales that press, pushed 0.4 mm too far."""
    least = 4e-6
    edges = np.array([[0.0, 0, 0], [18, 0, 0], [0, 1e-4, 1e-4], [18, 2e-4, -1e-4]]) + 90.0
    for _ in range(3):
        end = edges.copy()
        end[2:, 1] -= 0.4
        share = free_share_of(False, edges, end, least, 10_000)
        assert share < 1.0
        edges = edges + share * (end - edges)
        assert squared_on_the_way(False, edges) >= (0.49 * least) ** 2
    far = edges + np.array([[0.0], [0.0], [1.0], [1.0]])
    assert free_share_of(False, far, far, least, 10_000) == 1.0


def build() -> tuple[PrismContact, np.ndarray]:
    """Two squares 0.4 mm apart, and the rows of their corners at rest."""
    way = np.array([[10.4, 0.0]])
    rows = find_prism_rows([SQUARE], [(0, 0, 0)], way, (0.2, 4.2), 2.0, 1)
    table = rows.table
    y = table.rest + np.where(table.second[:, None], [10.4, 0.0, 0.0], 0.0)
    return PrismContact(rows, 0.1, 3.0), y


def test_only_features_within_reach_can_meet() -> None:
    contact, y = build()
    rows = contact.rows.table
    near = np.isin(y[:, 0], (5.0, 5.4))  # on the sides that face one another
    for stencil in rows.stencils:
        assert near[stencil[~rows.second[stencil]]].any()
        assert near[stencil[rows.second[stencil]]].any()
    # Four corners, base and top, before a front and a side wall each.
    assert rows.is_wall.sum() == 16
    assert contact.smallest_distance(y, 1.0) == pytest.approx(0.4)
    assert contact.smallest_distance(y, 0.3) == np.inf
    assert contact.active_pairs(y) == 0
    assert contact.energy_parts(y)[0] == 0.0


def test_the_energy_has_the_mirror_symmetry_of_the_prisms() -> None:
    """Tops that close, the second turned about the joint and a little about the vertical."""
    contact, y = build()
    second = contact.rows.table.second
    energies, forces = [], []
    for sign in (1.0, -1.0):
        moved = y.copy()
        turn = Rotation.from_euler("yz", [-0.082, 2e-4 * sign]).as_matrix()
        center = np.array([5.4, 0.0, 0.2])
        moved[second] = (y[second] - center) @ turn.T + center
        energies.append(contact.energy_parts(moved)[0])
        slope = np.zeros_like(moved)
        contact.add_gradient(moved, slope)
        forces.append(slope[second].sum(axis=0))
    assert energies[0] > 0.0
    assert energies[1] == pytest.approx(energies[0], rel=1e-9)
    assert forces[1] == pytest.approx(forces[0] * [1.0, -1.0, 1.0], rel=1e-6)


def test_gradient_of_all_that_meets() -> None:
    contact, rest = build()
    second = contact.rows.table.second
    turn, shift = np.array([0.3, -1.0, 0.7]), np.array([-0.5, 0.4, 0.9])

    def moved(s: float) -> np.ndarray:
        """The second square at a small distance from the first, on a rigid way."""
        y, angles = rest.copy(), 1e-3 * np.array([1.0, 2.0, 3.0]) + s * turn
        arms = rest[second] - [5.4, 0.0, 0.2]
        rotated = arms @ Rotation.from_rotvec(angles).as_matrix().T
        y[second] = rotated + [5.4 - 0.34, 0.01, 0.203] + s * shift
        return y

    y, way = moved(0.0), directional_difference(moved, 1e-4)
    assert contact.active_pairs(y) > 4
    gradient = np.zeros_like(y)
    contact.add_gradient(y, gradient)
    slope = directional_difference(lambda s: contact.energy_parts(moved(s))[0], 1e-5)
    assert relative_error(np.sum(gradient * way), slope) < 1e-7


def test_presses_are_forces_at_nearest_points_that_make_the_gradient() -> None:
    contact, y = build()
    second = contact.rows.table.second
    turned = (y[second] - [5.4, 0.0, 0.2]) @ Rotation.from_rotvec([0.05, 0.1, 0.15]).as_matrix().T
    turned[:, 0] -= turned[:, 0].min() - 5.03
    turned[:, 2] += 0.2
    y[second] = turned  # no two edges are parallel, so none are faded out
    rows, weights, lengths = contact.presses(y)
    assert len(lengths) == contact.active_pairs(y) > 0
    assert (lengths > 0.0).all()
    np.testing.assert_allclose(weights.sum(axis=2), 1.0, atol=1e-12)
    on_rows = np.zeros_like(y)
    for stencil, (one, other), length in zip(rows, weights, lengths, strict=True):
        assert len(set(second[stencil[one != 0.0]])) == len(set(second[stencil[other != 0.0]])) == 1
        arrow = (one - other) @ y[stencil]
        on_rows[stencil] -= np.outer(one - other, length * arrow / np.linalg.norm(arrow))
    gradient = np.zeros_like(y)
    contact.add_gradient(y, gradient)
    np.testing.assert_allclose(on_rows, gradient, atol=1e-9 * np.abs(gradient).max())


def test_distances_do_not_depend_on_what_was_measured_before() -> None:
    """What is remembered only tells which distances need not be measured."""
    contact, rest = build()
    second = contact.rows.table.second
    generator = np.random.default_rng(5)
    for step in range(200):
        y = rest.copy()
        turn = Rotation.from_rotvec(0.02 * np.sin(0.1 * step) * generator.normal(size=3))
        y[second] = (rest[second] - [5.4, 0.0, 0.2]) @ turn.as_matrix().T + [5.4, 0.0, 0.2]
        y[second] += 0.3 * np.sin(0.07 * step) * generator.normal(size=3)
        fresh, _ = build()
        assert contact.energy_parts(y) == fresh.energy_parts(y)
        assert contact.active_pairs(y) == fresh.active_pairs(y)
        assert contact.smallest_distance(y, 1.0) == fresh.smallest_distance(y, 1.0)
        assert contact.free_share(rest, y) == fresh.free_share(rest, y)

"""Scales kept apart: forces of contact, linear gaps, and what they are for."""

from __future__ import annotations

import numpy as np
import pytest

import flexscale as fs
from flexscale.homogenize.bend_line import Line
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.keep_apart import complementary_forces, keep_apart
from flexscale.homogenize.line import follow_line
from flexscale.solve.newton import solve_equilibrium
from flexscale.solve.solver_options import SolverOptions

COARSE = fs.MeshOptions(along=1.5, corner=0.4, scale_size=4.0, scale_layers=1)
LINE = Line("closing", 0.0, (0.015,))
BEFORE, BEHIND = 0.015, 0.02
RNG = np.random.default_rng(5)


@pytest.fixture(scope="module")
def cell():
    """A cell of chevrons, and its last sample before contact."""
    problem = CellProblem.from_pattern(
        fs.named_pattern("chevron"), fs.NativeModel("shell", mesh=COARSE)
    )
    (sample,) = follow_line(problem, LINE, SolverOptions())
    assert sample["contact_pairs"] == 0
    return problem, sample


def bent(problem, sample):
    """The cell at the sample with its Hessian factorized, and the state predicted far behind."""
    objective = problem.bent(LINE.bend(BEFORE))
    state = objective.evaluate(sample["state"])
    problem.system.factorize(objective.hessian_values(state))
    return state, sample["state"] + (BEHIND - BEFORE) * sample["rate"]


def test_forces_are_where_gaps_are_closed():
    half = RNG.standard_normal((12, 12))
    compliance = half @ half.T
    missing = RNG.standard_normal(12)
    forces = complementary_forces(compliance, missing)
    left = compliance @ forces - missing
    assert forces.min() >= 0.0
    assert left.min() > -1e-6
    assert np.abs(forces * left).max() < 1e-6
    assert 0 < np.count_nonzero(forces) < 12


def test_a_compliance_that_is_not_positive_is_refused():
    with pytest.raises(np.linalg.LinAlgError):
        complementary_forces(np.diag([1.0, -1.0]), np.ones(2))


def test_gaps_are_distances_where_they_are_taken_and_their_rates(cell):
    problem, sample = cell
    y = problem.embedding.world_map.place(sample["state"], LINE.bend(BEFORE)).y
    gaps = problem.contact.gaps(y, problem.model.gap)
    positions = problem.contact.positions(y)
    assert len(gaps) > 20
    assert gaps.at(positions) == pytest.approx(gaps.distances)
    assert gaps.distances.min() == pytest.approx(sample["min_gap"])
    # Along normals alone, a distance changes as its linear function does, to second order.
    moved = y + 1e-5 * RNG.standard_normal(y.shape)
    again = problem.contact.gaps(moved, problem.model.gap)
    linear = gaps.at(problem.contact.positions(moved))
    assert abs(again.distances.min() - linear.min()) < 0.05 * abs(linear.min() - sample["min_gap"])
    entry = int(np.argmin(gaps.distances))
    turn = RNG.standard_normal(positions.shape)
    rate = gaps.at(positions + turn)[entry] - gaps.at(positions)[entry]
    assert np.sum(gaps.forces(entry) * turn) == pytest.approx(rate)


def test_the_push_of_a_pair_is_the_slope_of_the_barrier(cell):
    contact = cell[0].contact
    d_hat = contact.activation_distance
    d = d_hat * np.linspace(0.05, 0.95, 19)
    step = 1e-5 * d_hat

    def barrier(distance):
        return -contact.stiffness * (distance**2 - d_hat**2) ** 2 * np.log((distance / d_hat) ** 2)

    force, growth = contact.push(d)
    assert force == pytest.approx((barrier(d - step) - barrier(d + step)) / (2 * step), rel=1e-6)
    slope = (contact.push(d - step)[0] - contact.push(d + step)[0]) / (2 * step)
    assert growth == pytest.approx(slope, rel=1e-6)
    assert contact.distance_at(force) == pytest.approx(d, abs=1e-3 * d_hat)


def test_scales_that_would_meet_are_kept_apart_near_equilibrium(cell):
    """The way to the plain prediction is blocked; from the new one it takes few iterations."""
    problem, sample = cell
    state, wanted = bent(problem, sample)
    bend = LINE.bend(BEHIND)
    overlapping = problem.embedding.world_map.place(wanted, bend).y
    assert problem.contact.free_share(state.world.y, overlapping) < 1.0
    kept = keep_apart(problem, state.world.y, wanted, bend)
    start = problem.bent(bend).evaluate(kept)
    assert problem.contact.free_share(state.world.y, start.world.y) == 1.0
    assert not problem.contact.intersects(start.world.y)
    solution = solve_equilibrium(problem.bent(bend), kept, SolverOptions())
    assert solution.status == 0
    assert solution.evaluation.energy < start.energy < 1.1 * solution.evaluation.energy
    assert solution.iterations <= 12


def test_what_does_not_overlap_stays(cell):
    problem, sample = cell
    state, _ = bent(problem, sample)
    wanted = sample["state"] + 1e-5 * sample["rate"]
    kept = keep_apart(problem, state.world.y, wanted, LINE.bend(BEFORE + 1e-5))
    assert np.array_equal(kept, wanted)

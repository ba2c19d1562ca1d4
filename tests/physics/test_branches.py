"""The same sample from flat, from its neighbors in curvature, and from those in direction."""

from __future__ import annotations

import pytest

import flexscale as fs
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.line import Line, follow_line
from flexscale.solve.newton import SolverOptions, solve_equilibrium
from tests.physics.cells import square

CURVATURES = (0.004, 0.008, 0.013, 0.015)
DIRECTION = 10.0
OPTIONS = SolverOptions()


@pytest.fixture(scope="module")
def problem():
    mesh = fs.MeshOptions(across=2, corner=0.3, scale_layers=2, scale_strips=1, scale_corner=2.0)
    return CellProblem.from_pattern(square(), mesh)


@pytest.fixture(scope="module")
def samples(problem):
    return list(follow_line(problem, Line("closing", DIRECTION, CURVATURES), OPTIONS))


def energy_from(problem, z, curvature):
    """Energy density of the equilibrium found from a state."""
    cell = problem.bent(Line("closing", DIRECTION, ()).bend(curvature))
    found = solve_equilibrium(cell, z, OPTIONS)
    assert found.status == 0
    return found.evaluation.energy / problem.area


@pytest.mark.parametrize("k", [1, 2])
def test_starts_from_flat_and_from_the_next_find_the_same_state(problem, samples, k):
    """Before (0.008) and in contact (0.013), where no strip buckles."""
    known, curvature = samples[k]["energy_density"], CURVATURES[k]
    assert (samples[k]["contact_pairs"] > 0) == (k == 2)
    (at_once,) = follow_line(problem, Line("closing", DIRECTION, (curvature,)), OPTIONS)
    assert at_once["energy_density"] == pytest.approx(known, rel=1e-9)
    after = samples[k + 1]
    z = after["state"] - (CURVATURES[k + 1] - curvature) * after["rate"]
    bend = Line("closing", DIRECTION, ()).bend(curvature)
    if problem.contact.intersects(problem.embedding.world_map.place(z, bend).y):
        z = after["state"]
    back = energy_from(problem, z, curvature)
    assert back == pytest.approx(known, rel=1e-9)


def test_starts_from_neighboring_directions_find_the_same_state(problem, samples):
    """Before contact; in contact scales may slide along their neighbors to another rest."""
    for turn in (-10.0, 10.0):
        line = Line("closing", DIRECTION + turn, CURVATURES[:2])
        state = list(follow_line(problem, line, OPTIONS))[-1]["state"]
        found = energy_from(problem, state, CURVATURES[1])
        assert found == pytest.approx(samples[1]["energy_density"], rel=1e-9)


def test_first_touch_is_no_branch_point(samples):
    """Contact may make the way unstable for a moment; bent back, the sheet is as it was."""
    assert "moment_returning" not in samples[1]
    assert samples[2]["energy_density_returning"] == pytest.approx(
        samples[1]["energy_density"], rel=1e-9
    )


def test_two_branches_are_told(problem):
    """Squares opened along the diagonal: once buckled, strips stay so at a smaller curvature."""
    line = Line("opening", 45.0, (0.02, 0.025, 0.03))
    samples = list(follow_line(problem, line, OPTIONS))
    assert [sample["status"] for sample in samples] == [0, 0, 0]
    assert "energy_density_returning" not in samples[1]
    assert samples[2]["energy_density_returning"] < 0.95 * samples[1]["energy_density"]
    assert samples[2]["moment_returning"] < 0.9 * samples[1]["moment"]

"""The same sample from flat and from its neighbors; more than one branch is told."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import flexscale as fs
from flexscale.homogenize.bend_line import Line
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.line import follow_line
from flexscale.solve.newton import solve_equilibrium
from flexscale.solve.solver_options import SolverOptions
from tests.physics.cells import square

CURVATURES = (0.004, 0.008, 0.013, 0.015)
DIRECTION = 10.0
OPTIONS = SolverOptions()
MESH = fs.MeshOptions(across=2, corner=0.3, scale_layers=2, scale_strips=1, scale_corner=2.0)


@pytest.fixture(scope="module")
def problem():
    return CellProblem.from_pattern(square(), fs.NativeModel("shell", mesh=MESH))


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
def test_start_from_flat_at_once(problem, samples, k):
    """Before (0.008) and in contact (0.013), where no strip buckles."""
    known, curvature = samples[k]["energy_density"], CURVATURES[k]
    assert (samples[k]["contact_pairs"] > 0) == (k == 2)
    (at_once,) = follow_line(problem, Line("closing", DIRECTION, (curvature,)), OPTIONS)
    assert at_once["energy_density"] == pytest.approx(known, rel=1e-9)


def test_start_from_the_next_in_contact(problem, samples):
    z = samples[3]["state"] - (CURVATURES[3] - CURVATURES[2]) * samples[3]["rate"]
    back = energy_from(problem, z, CURVATURES[2])
    assert back == pytest.approx(samples[2]["energy_density"], rel=1e-9)


def test_first_touch_is_no_branch_point(problem, samples):
    """The way into contact is stable, and bent back from there, the sheet is as it was."""
    assert "moment_returning" not in samples[1]
    assert "moment_returning" not in samples[2]
    z, energy = samples[2]["state"], 0.0
    for curvature in np.linspace(CURVATURES[2], CURVATURES[1], 9)[1:]:
        cell = problem.bent(Line("closing", DIRECTION, ()).bend(float(curvature)))
        found = solve_equilibrium(cell, z, OPTIONS)
        assert found.status == 0
        z, energy = found.z, found.evaluation.energy / problem.area
    assert energy == pytest.approx(samples[1]["energy_density"], rel=1e-9)


def test_two_branches_are_told():
    """Squares opened along the diagonal, with a bending energy apart from the midsurface's.

    Strips then collapse at their ends, and stay so at a smaller curvature.
    """
    substrate = fs.SubstrateOptions(bending_measure="turn")
    problem = CellProblem.from_pattern(
        square(), fs.NativeModel("shell", substrate=substrate, mesh=MESH)
    )
    samples = list(follow_line(problem, Line("opening", 45.0, (0.02, 0.025, 0.03)), OPTIONS))
    assert [sample["status"] for sample in samples] == [0, 0, 0]
    assert "energy_density_returning" not in samples[1]
    assert samples[2]["energy_density_returning"] < 0.95 * samples[1]["energy_density"]
    assert samples[2]["moment_returning"] < 0.9 * samples[1]["moment"]


def test_strips_do_not_collapse():
    """The same with the energy integrated over the thickness: one branch, rising moments."""
    problem = CellProblem.from_pattern(square(), fs.NativeModel("shell", mesh=MESH))
    samples = list(follow_line(problem, Line("opening", 45.0, (0.02, 0.025, 0.03)), OPTIONS))
    moments = [sample["moment"] for sample in samples]
    assert moments == sorted(moments)
    for before, after in itertools.pairwise(samples):
        back = after.get("energy_density_returning", before["energy_density"])
        assert back == pytest.approx(before["energy_density"], rel=1e-9)

"""Every sample has a limit of time, and no sweep of collision detection goes on for ever."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

import flexscale as fs
from flexscale.errors import ConfigError, UnitRangeError
from flexscale.mechanics.contact import ContactSurface, ScaleContact
from flexscale.solve.newton import Solution
from flexscale.status import SolveStatus
from flexscale.steps.experiment import parse_experiment

COARSE = fs.MeshOptions(scale_layers=2, scale_size=6, scale_strips=1, across=2)
PATTERNS = {"patterns": {"square": {"named": "square"}}}


def facing_walls(gap: float, turn: np.ndarray) -> ScaleContact:
    """Two squares of 1 mm that face each other across a gap [mm], turned as one."""
    wall = np.array([(0, 0, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1)], dtype=float)
    points = np.vstack([wall, wall + np.array([gap, 0.0, 0.0])]) @ turn
    surface = ContactSurface(
        rows=np.arange(8),
        weights=sp.csr_array(np.eye(8)),
        vertices=np.arange(8),
        rest=points,
        triangles=np.array([(0, 1, 2), (0, 2, 3), (4, 6, 5), (4, 7, 6)]),
        bodies=np.repeat([0, 1], 4),
        n_home=8,
        neighbors=np.array([[0, 1]]),
    )
    return ScaleContact(surface, 0.01, 1.0)


@pytest.mark.parametrize("gap", [1e-3, 1e-6, 1e-9])
def test_walls_that_slide_along_each_other_are_swept_in_bounded_time(gap: float) -> None:
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    contact = facing_walls(gap, turn)
    start = contact.surface.rest
    end = start + np.repeat([0.0, 1.0], 4)[:, None] * (np.array([0.0, 0.5, 0.05]) @ turn)
    began = time.process_time()
    share = contact.free_share(start, end)
    assert time.process_time() - began < 20.0  # without a bound 1e-9 mm takes minutes
    assert 0.0 <= share <= 1.0
    if gap == 1e-3:
        assert share == 1.0
    crossing = start + np.repeat([0.0, 1.0], 4)[:, None] * (np.array([-1.0, 0.0, 0.0]) @ turn)
    assert contact.free_share(start, crossing) < gap * 1.01


def test_a_sample_out_of_time_is_given_up_and_says_so() -> None:
    pattern = fs.named_pattern("square")
    hasty = fs.SolverOptions(time_limit=1e-3)
    found = fs.sweep(
        pattern,
        [0],
        [0, 0.005, 0.01],
        ["opening"],
        workers=1,
        model=fs.NativeModel("shell", mesh=COARSE, solver=hasty),
    )
    ends = [SolveStatus.converged, SolveStatus.time_limit, SolveStatus.not_run]
    assert found.status.values.ravel().tolist() == ends
    assert np.isnan(found.moment.values.ravel()[1:]).all()
    assert "time_limit" in found.status.attrs["flag_meanings"]
    assert "processor time" in SolveStatus.time_limit.sentence


def test_attempts_that_time_ended_say_so() -> None:
    state = np.zeros(1)
    tried = Solution(state, None, 0.0, SolveStatus.line_search_failed, 3, 1.0, 0)
    assert tried.given_up(fs.SolverOptions()) is tried
    over = replace(fs.SolverOptions(), deadline=(0.0, 0.0))
    assert tried.given_up(over).status == SolveStatus.time_limit


def test_the_time_of_a_sample_runs_from_its_start() -> None:
    options = fs.SolverOptions(time_limit=1000.0)
    assert not options.out_of_time
    assert not options.for_a_sample().out_of_time
    assert replace(options, deadline=(0.0, 0.0)).out_of_time


def test_only_a_limit_of_ones_own_is_part_of_a_recipe() -> None:
    usual, longer = fs.SolverOptions(), fs.SolverOptions(time_limit=7200.0)
    assert "time_limit" not in usual.to_config()
    assert longer.to_config()["time_limit"] == 7200.0
    assert fs.SolverOptions(**longer.to_config()) == longer
    assert longer.for_a_sample().to_config() == longer.to_config()


def test_experiment_files_may_set_the_limit() -> None:
    experiment = parse_experiment(PATTERNS | {"solver": {"time_limit": "2 min"}}, "file.yaml")
    assert experiment.solver.time_limit == 120.0
    with pytest.raises(UnitRangeError, match="time_limit"):
        parse_experiment(PATTERNS | {"solver": {"time_limit": 0}}, "file.yaml")
    with pytest.raises(ConfigError, match="deadline"):
        parse_experiment(PATTERNS | {"solver": {"deadline": 1}}, "file.yaml")

"""Time of jobs to come, judged by records of earlier ones."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import flexscale as fs
from flexscale.cli.run import run_experiment
from flexscale.datasets.store import Store
from flexscale.steps.estimate import estimate_seconds
from flexscale.steps.experiment import parse_experiment
from flexscale.steps.plan import Job, build_plan
from tests.macro.fit_samples import law_sweep

SWEEP: dict[str, Any] = {"directions": [0, 45], "curvatures": [0, 0.001, 0.002]}
PATTERNS = {"square": {"family": "IH76"}, "hexagon": {"family": "IH20"}}


def sweep_jobs(**changes: Any) -> dict[str, Job]:
    """Sweep of each pattern by name; squares and hexagons have 12 samples each to solve."""
    content = {"native": "shell", "patterns": PATTERNS, "sweep": SWEEP} | changes
    plan = build_plan(parse_experiment(content, "file.yaml"))
    return {job.pattern: job for job in plan if job.step == "sweep"}


def keep(root: Path, job: Job, seconds: float, workers: int = 1) -> None:
    record = {"wall_seconds": seconds, "workers": workers}
    Store(root).publish(law_sweep(), "sweep", job.recipe, [], record)


def estimates(root: Path, jobs: dict[str, Job]) -> dict[str, float]:
    found = estimate_seconds(jobs.values(), fs.open_registry(root))
    return {name: found[job.id] for name, job in jobs.items() if job.id in found}


def test_time_grows_with_the_samples_to_solve(tmp_path: Path) -> None:
    jobs = sweep_jobs()
    assert [job.n_samples for job in jobs.values()] == [12, 12]
    keep(tmp_path, jobs["square"], 6.0, workers=2)  # 1 s a sample, on one core
    longer = sweep_jobs(sweep=SWEEP | {"curvatures": [0, 0.001, 0.002, 0.003]})
    assert estimates(tmp_path, longer) == {"square": 16.0, "hexagon": 16.0}
    # Squares repeat after 90 degree, so half of these directions need no solving.
    more = sweep_jobs(sweep=SWEEP | {"directions": [0, 45, 90, 135]})
    assert estimates(tmp_path, more)["square"] == 12.0


def test_the_most_alike_records_count(tmp_path: Path) -> None:
    jobs = sweep_jobs()
    other_mesh = sweep_jobs(mesh={"across": 2})
    keep(tmp_path, other_mesh["square"], 1200.0)
    assert estimates(tmp_path, jobs) == {"square": 1200.0, "hexagon": 1200.0}
    keep(tmp_path, jobs["hexagon"], 120.0)
    assert estimates(tmp_path, jobs) == {"square": 120.0, "hexagon": 120.0}
    keep(tmp_path, jobs["square"], 12.0)
    assert estimates(tmp_path, jobs) == {"square": 12.0, "hexagon": 120.0}


def test_a_busy_machine_does_not_lengthen_estimates(tmp_path: Path) -> None:
    jobs = sweep_jobs()
    record = {"wall_seconds": 60.0, "cpu_seconds": 24.0, "workers": 2}
    Store(tmp_path).publish(law_sweep(), "sweep", jobs["square"].recipe, [], record)
    assert estimates(tmp_path, jobs)["square"] == 24.0


def test_what_went_on_from_a_checkpoint_says_nothing_of_the_whole(tmp_path: Path) -> None:
    jobs = sweep_jobs()
    record = {"wall_seconds": 6.0, "cpu_seconds": 6.0, "workers": 1, "resumed": True}
    Store(tmp_path).publish(law_sweep(), "sweep", jobs["square"].recipe, [], record)
    assert estimates(tmp_path, jobs) == {}


def test_nothing_is_said_without_records(tmp_path: Path) -> None:
    assert estimates(tmp_path, sweep_jobs()) == {}
    Store(tmp_path).publish(law_sweep(), "sweep", sweep_jobs()["square"].recipe)
    assert estimates(tmp_path, sweep_jobs()) == {}, "a dataset that no run has made"


def test_dry_run_tells_samples_and_time(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    keep(tmp_path, sweep_jobs()["square"], 6.0)
    file = tmp_path / "file.yaml"
    directions = {"start": 0, "stop": 180, "step": 22.5}
    content = {
        "native": "shell",
        "patterns": {"square": {"family": "IH76"}},
        "sweep": {"directions": directions, "curvatures": [0, 0.005, 0.01, 0.02]},
        "fit": {},
        "sheet": {"curvatures": [0, 0.01, 0.02]},
    }
    file.write_text(json.dumps(content))
    assert run_experiment(file, 2, tmp_path, dry_run=True) == 0
    said = capsys.readouterr()
    # Of eight directions, squares need 0, 22.5 and 45 degree: 24 samples of half a second.
    lines = {line.split()[0]: line for line in said.out.splitlines()}
    assert lines["sweep"].endswith("to do   24 samples   about 12 s")
    assert lines["sheet"].endswith("to do   6 samples")
    assert (
        "5 of 5 jobs to do, with 30 samples; there is no earlier record of cell, fit, "
        "sheet, tangent, the rest takes about 12 s of one core, 6 s at best on 2." in said.err
    )

"""`flexscale run`: an experiment file to its end, with progress."""

from __future__ import annotations

import os
import sys
from contextlib import closing
from pathlib import Path
from typing import Any

from flexscale.cli.progress import Progress
from flexscale.datasets.registry import Registry, open_registry
from flexscale.datasets.store import Store
from flexscale.steps.catalog import STEPS
from flexscale.steps.engine import finished_jobs, run_plan
from flexscale.steps.estimate import estimate_seconds
from flexscale.steps.experiment import Experiment, ExperimentFile, load_experiment
from flexscale.steps.plan import Job, Plan, build_plan
from flexscale.steps.summary import describe_experiment, outcome

NOT_CONVERGED = 3


def run_experiment(
    file: Path, cores: int | None, results: Path, *, dry_run: bool = False, quiet: bool = False
) -> int:
    """Check the whole file, then run what is not there yet; one line per result on stdout.

    Parameters
    ----------
    file : experiment file.
    cores : processes at once; None for all the machine lends us.
    results : results folder.
    dry_run : only say what would be done.
    quiet : no progress.

    Returns
    -------
    Exit code: 0; 3 when samples did not converge; else that of the first job that failed.

    Raises
    ------
    BadInputError : the file says something that cannot be computed.
    """
    experiment = load_experiment(file)
    plan = build_plan(experiment)
    store = Store(results)
    finished = finished_jobs(plan, store)
    if dry_run:
        _announce(plan, finished, open_registry(results), cores or _all_cores())
        return 0
    errors: dict[str, dict[str, Any]] = {}
    seconds: dict[str, float] = {}
    if len(finished) < len(plan.jobs):
        errors, seconds = _run(plan, experiment, store, cores or _all_cores(), finished, quiet)
    return _report(plan, store, seconds, errors)


def _run(
    plan: Plan,
    experiment: Experiment,
    store: Store,
    cores: int,
    finished: dict[str, str],
    quiet: bool,
) -> tuple[dict[str, dict[str, Any]], dict[str, float]]:
    """Run the unfinished jobs; (errors, seconds) by job id."""
    errors: dict[str, dict[str, Any]] = {}
    seconds: dict[str, float] = {}
    with (
        Progress(plan, finished, quiet=quiet) as progress,
        closing(run_plan(plan, experiment, store, cores)) as events,
    ):
        for event in events:
            progress.show(event)
            if event["event"] == "error":
                errors[event["job"]] = event
            elif event["event"] == "end":
                seconds[event["job"]] = event["seconds"]
    return errors, seconds


def _announce(plan: Plan, finished: dict[str, str], registry: Registry, cores: int) -> None:
    """One line per job on stdout; their number, samples and probable time on stderr."""
    todo = [job for job in plan if job.id not in finished]
    seconds = estimate_seconds(todo, registry)
    for job in plan:
        state = f"reused  {finished[job.id]}" if job.id in finished else "to do"
        if job.id not in finished and job.n_samples:
            state += f"   {job.n_samples} samples"
        if job.id in seconds:
            state += f"   about {_rough(seconds[job.id])}"
        sys.stdout.write(f"{job.label:<32} {state}\n")
    samples = sum(job.n_samples for job in todo)
    text = f"{len(todo)} of {len(plan.jobs)} jobs to do, with {samples} samples"
    new = sorted({job.step for job in todo if job.step in STEPS and job.id not in seconds})
    if new:
        text += f"; there is no earlier record of {', '.join(new)}"
    if seconds:
        total = sum(seconds.values())
        text += f"{', the rest takes' if new else '; judging by earlier records, it takes'} about "
        text += f"{_rough(total)} of one core"
        # Inputs come before results, so that not all cores are always busy.
        text += f", {_rough(total / cores)} at best on {cores}" if cores > 1 else ""
    print(f"{text}.", file=sys.stderr)


def _rough(seconds: float) -> str:
    """A time to two digits: "40 s", "12 min", "3.5 h"."""
    for unit, size in (("h", 3600.0), ("min", 60.0)):
        if seconds >= 1.5 * size:
            return f"{seconds / size:.2g} {unit}"
    return f"{seconds:.2g} s"


def _report(
    plan: Plan,
    store: Store,
    seconds: dict[str, float],
    errors: dict[str, dict[str, Any]],
) -> int:
    """One line per job on stdout, what needs attention on stderr; returns the exit code."""
    finished = finished_jobs(plan, store)
    stored = plan.stored(store)
    unconverged = False
    for job in plan:
        if job.id not in finished:
            sys.stdout.write(f"{job.label:<32} {'failed' if job.id in errors else 'not run'}\n")
            continue
        how = f"{seconds[job.id]:.0f} s" if job.id in seconds else "reused"
        told, failures = outcome(store, stored[job.id]) if job.id in stored else ("", [])
        sys.stdout.write(f"{job.label:<32} {how:<8} {finished[job.id]}{told}\n")
        for line in failures:
            print(f"  {line}", file=sys.stderr)
        unconverged |= bool(failures)
    for job_id, event in errors.items():
        _tell_error(plan[job_id], event)
    if errors:
        return int(next(iter(errors.values()))["exit_code"])
    return NOT_CONVERGED if unconverged else 0


def _tell_error(job: Job, event: dict[str, Any]) -> None:
    print(event.get("trace", ""), end="", file=sys.stderr)
    what = " ".join(job.label.split())
    print(f"flexscale: {what}: {event['message']}", file=sys.stderr)


def _all_cores() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def list_fields() -> str:
    """What an experiment file may contain: key, unit, default, bounds, meaning."""
    return describe_experiment(ExperimentFile)

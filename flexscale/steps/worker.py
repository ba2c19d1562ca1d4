"""One job in a process of its own: load the inputs, call the step, publish what it made."""

from __future__ import annotations

import argparse
import os
import resource
import sys
import time
import traceback
from pathlib import Path
from typing import Any

from flexscale.datasets.store import Entry, Store
from flexscale.errors import FlexScaleError
from flexscale.steps.catalog import STEPS
from flexscale.steps.environment import EVENTS
from flexscale.steps.events import EventWriter
from flexscale.steps.experiment import load_experiment
from flexscale.steps.figures import FIGURE, draw_figure
from flexscale.steps.job_ends import RESUME
from flexscale.steps.native_inputs import inputs_by_step
from flexscale.steps.plan import Job, Plan, build_plan
from flexscale.steps.step import Resources
from flexscale.steps.summary import failed_samples
from flexscale.system_failures import explain


def run_job(plan: Plan, job: Job, store: Store, workers: int, events: EventWriter) -> None:
    """Do one job, unless its result is there already.

    Parameters
    ----------
    plan : the plan the job belongs to; the results of its inputs are stored.
    store : where results are.
    workers : processes the job may use.
    events : told of the start, of every sample, and of the end.
    """
    started = time.monotonic()
    events.write("start", job.id)
    entries = plan.needed_for(job).stored(store)
    inputs = [entries[needed] for needed in job.inputs]
    if job.step == FIGURE:
        path = draw_figure(job.title, job.pattern, inputs, store)
        events.write("end", job.id, result=str(path), seconds=time.monotonic() - started)
        return
    entry = store.lookup(job.step, job.recipe, inputs)
    if entry is None:
        entry = _compute(job, store, inputs, workers, events)
    events.write("end", job.id, result=entry.id, seconds=time.monotonic() - started)


def _compute(
    job: Job, store: Store, inputs: list[Entry], workers: int, events: EventWriter
) -> Entry:
    started, spent = time.monotonic(), _cpu_seconds()
    step = STEPS[job.step]
    task = step.task(job.recipe.parameters)
    datasets = inputs_by_step((entry.kind, store.load(entry)) for entry in inputs)
    checkpoint = store.checkpoint(job.recipe, inputs) if step.resumable else None
    resumed = checkpoint is not None and checkpoint.has_samples
    resources = Resources(
        workers=workers if step.parallel else 1,
        checkpoint=checkpoint,
        on_sample=lambda event: events.write("sample", job.id, **_facts(event)),
    )
    dataset = step.compute(task, datasets, resources)
    usage = [resource.getrusage(who).ru_maxrss for who in _WHO]
    record: dict[str, Any] = {
        "wall_seconds": round(time.monotonic() - started, 3),
        "cpu_seconds": round(_cpu_seconds() - spent, 3),
        "peak_memory_mib": round(max(usage) / 1024.0, 1),
        "workers": resources.workers,
        "resumed": resumed,  # times are then of a part of the samples
        "failed_samples": failed_samples(dataset),
    }
    return store.publish(dataset, job.step, job.recipe, inputs, record)


_WHO = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)


def _cpu_seconds() -> float:
    """Processor time of this process and of those that it started and that have ended, s."""
    usages = [resource.getrusage(who) for who in _WHO]
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


_FACTS = (
    "done", "total", "n_failed", "seconds", "side", "direction", "shape", "curvature", "device",
    "place", "unit",
)  # fmt: skip


def _facts(event: Any) -> dict[str, Any]:
    return {name: getattr(event, name) for name in _FACTS if hasattr(event, name)}


def main(arguments: list[str]) -> int:
    """Run one job; the exit code is that of the error's class, 1 for a bug."""
    parser = argparse.ArgumentParser(prog="python -m flexscale.steps", description=__doc__)
    parser.add_argument("experiment", type=Path)
    parser.add_argument("job")
    parser.add_argument("--results", type=Path, required=True)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--stamp", type=Path, required=True)
    options = parser.parse_args(arguments)
    events = EventWriter(Path(os.environ[EVENTS]) if EVENTS in os.environ else None)
    try:
        plan = build_plan(load_experiment(options.experiment))
        run_job(plan, plan[options.job], Store(options.results), options.workers, events)
        options.stamp.parent.mkdir(parents=True, exist_ok=True)
        options.stamp.touch()
    except Exception as error:
        known = error if isinstance(error, FlexScaleError) else explain(error)
        if known is not None:
            message = " ".join([str(known), *([RESUME] if known is not error else [])])
            events.write("error", options.job, message=message, exit_code=known.exit_code)
            print(f"error: {message}", file=sys.stderr)
            return known.exit_code
        # Reported as a bug, with the trace, by the process that waits.
        trace = traceback.format_exc()
        events.write("error", options.job, message=repr(error), exit_code=1, trace=trace)
        print(trace, file=sys.stderr)
        return 1
    return 0

"""How long jobs will take, judging by the records of earlier runs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from statistics import median
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from flexscale.errors import BadInputError, DatasetError
from flexscale.homogenize.native_model import NAME
from flexscale.steps.catalog import STEPS

if TYPE_CHECKING:
    from flexscale.datasets.registry import Registry
    from flexscale.steps.plan import Job


def estimate_seconds(jobs: Iterable[Job], registry: Registry) -> dict[str, float]:
    """Job id -> seconds of one core; jobs whose step has not been run before are left out.

    Times are per sample, the median over the records that are most like the job: those of its
    pattern and mesh; else of its mesh; else all of its step and native model. Samples of one
    pattern may differ much in time, and machines too.

    Parameters
    ----------
    jobs : with a step of the catalog; figures are left out, as what they take is not recorded.
    """
    known: dict[str, list[tuple[Mapping[str, Any], float]]] = {}
    found = {}
    for job in jobs:
        if job.step not in STEPS:
            continue
        if job.step not in known:
            known[job.step] = _earlier(job.step, registry)
        rates = _most_alike(job.recipe.parameters, known[job.step])
        if rates:
            found[job.id] = median(rates) * max(job.n_samples, 1)
    return found


def _earlier(step: str, registry: Registry) -> list[tuple[Mapping[str, Any], float]]:
    """(parameters, seconds of one core per sample) of every run of a step that was recorded."""
    found = []
    for entry in registry.find(kind=step) if any(e.kind == step for e in registry) else ():
        try:
            record = registry.record(entry)
        except DatasetError:  # damaged since the catalog was written; `data check` names it
            continue
        run, parameters = record["run"], record["recipe"]["parameters"]
        if "wall_seconds" not in run or run.get("resumed"):
            continue
        try:
            task = STEPS[step].task(parameters)
            n_samples = task.block.n_samples(task.pattern)
        except (ValidationError, BadInputError):  # of a version with other parameters
            continue
        # Processor time, where it was recorded, is not lengthened by a busy machine.
        seconds = run.get("cpu_seconds", run["wall_seconds"] * run.get("workers", 1))
        found.append((parameters, seconds / max(n_samples, 1)))
    return found


def _most_alike(
    parameters: Mapping[str, Any], earlier: Iterable[tuple[Mapping[str, Any], float]]
) -> list[float]:
    """Seconds per sample of the runs that share most with these parameters."""
    ranks: dict[int, list[float]] = {}
    for others, rate in earlier:
        if others.get(NAME) != parameters.get(NAME):
            continue  # one native model takes a hundred times as long as another
        same_mesh = others.get("mesh") == parameters.get("mesh")
        same = same_mesh and others["pattern"] == parameters["pattern"]
        ranks.setdefault(same_mesh + same, []).append(rate)
    return ranks[max(ranks)] if ranks else []

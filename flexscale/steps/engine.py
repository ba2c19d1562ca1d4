"""Runs a plan to its end through Snakemake, quietly; progress comes back as events."""

from __future__ import annotations

import errno
import os
import subprocess
import time
from collections.abc import Generator, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexscale.datasets.locks import LockedError, file_lock, working_folder
from flexscale.errors import FlexScaleError, MissingDataError
from flexscale.processes import ProcessEndedError
from flexscale.steps.engine_process import Workplace, describe_engine_end, engine
from flexscale.steps.environment import STAMPS
from flexscale.steps.experiment import Experiment
from flexscale.steps.figures import FIGURE, figure_is_current, figure_path, figures_folder
from flexscale.steps.job_ends import RESUME, JobEnds
from flexscale.steps.plan import Plan
from flexscale.system_failures import SystemFailureError, explain

if TYPE_CHECKING:
    from flexscale.datasets.store import Store

#: Folder below results/local with the lock of the run in work and the log of the last one.
WORKFLOW = ".workflow"
_POLL = 0.2  # s between looks at the events


def finished_jobs(plan: Plan, store: Store) -> dict[str, str]:
    """Job id -> dataset id or picture, for the jobs that need not run.

    Raises
    ------
    IntegrityError : a dataset is there but damaged.
    """
    stored = plan.stored(store)
    results = {job_id: entry.id for job_id, entry in stored.items()}
    for job in plan:
        if job.step != FIGURE or not all(needed in stored for needed in job.inputs):
            continue
        sources = [stored[needed] for needed in job.inputs]
        if figure_is_current(job.title, job.pattern, sources, store):
            results[job.id] = str(figure_path(job.title, job.pattern, sources, store))
    return results


def run_plan(
    plan: Plan, experiment: Experiment, store: Store, cores: int
) -> Generator[dict[str, Any], None, None]:
    """Run every job that is not finished, and yield what happens; close it to stop everything.

    Parameters
    ----------
    plan, experiment : what to do; both come from one file.
    store : results folder.
    cores : processes at once.

    Yields
    ------
    dict with "event": "start", "sample", "end" or "error" of a job, or "tick" about five times
    a second, so that the caller can keep its display alive.

    Raises
    ------
    MissingDataError : another run is working in this folder.
    SystemFailureError : the folder cannot be written; told before anything is computed.
    ProcessEndedError : the engine was ended from outside.
    FlexScaleError : the engine itself failed; its log is named.
    """
    root = store.root.resolve()
    work = root / "local"
    try:
        _require_room(plan, store)
        (work / WORKFLOW).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise _not_writable(work, error) from error
    with _only_run(work), _workplace(work) as place:
        _stamp_finished(plan, store, place.folder)
        place.experiment.write_text(
            experiment.model_dump_json(indent=1, exclude_none=True), encoding="utf-8"
        )
        ends = JobEnds(plan, place)
        with engine(place, root, cores) as process:
            while process.poll() is None:
                time.sleep(_POLL)
                if not place.folder.is_dir():
                    raise SystemFailureError(f"{place.folder} was removed in the run. {RESUME}")
                yield from ends.news()
                yield {"event": "tick"}
        yield from ends.news()
        if process.returncode > 0:
            yield from ends.unexplained()
        if process.returncode < 0 or (process.returncode > 0 and not ends.failed):
            raise _engine_failure(place, process)


def _engine_failure(place: Workplace, process: subprocess.Popen[bytes]) -> FlexScaleError:
    """What is known about the end of an engine whose jobs have not failed."""
    words, from_outside = describe_engine_end(process.returncode, place)
    subject = f"The workflow engine (Snakemake, process {process.pid} on {os.uname().nodename})"
    trouble = place.trouble()
    if trouble is not None:
        return SystemFailureError(f"{subject} {words}. {trouble} {RESUME}")
    if from_outside:
        return ProcessEndedError(f"{subject} {words}. {RESUME}")
    return FlexScaleError(f"{subject} {words}:\n{place.last_words()}")


def _stamp_finished(plan: Plan, store: Store, folder: Path) -> None:
    """Stamps say exactly which jobs are finished."""
    (folder / STAMPS).mkdir()
    for job_id in finished_jobs(plan, store):
        (folder / STAMPS / job_id).touch()


@contextmanager
def _workplace(work: Path) -> Iterator[Workplace]:
    """The engine's folder; its log survives it."""
    with ExitStack() as stack:
        # Only here is it the folder: what the run itself meets is told as what it is.
        try:
            folder = stack.enter_context(working_folder(work))
        except OSError as error:
            raise _not_writable(work, error) from error
        place = Workplace(folder)
        try:
            yield place
        finally:
            with suppress(OSError):
                os.replace(place.log, work / WORKFLOW / place.log.name)


@contextmanager
def _only_run(work: Path) -> Iterator[None]:
    """Hold the folder's lock; it goes with the process, however that ends."""
    try:
        with file_lock(work / WORKFLOW / "lock", 0.0, _tell_other_run):
            yield
    except LockedError as error:
        raise MissingDataError(str(error)) from error


def _tell_other_run(path: Path, owner: str) -> str:
    return (
        f"Another flexscale run ({owner}) is working in {path.parents[1]}: wait for it, or give "
        "this one another folder with --results."
    )


def _require_room(plan: Plan, store: Store) -> None:
    """Refuse folders that could not take the results, before anything is computed."""
    folders = {store.local / job.step / job.family / job.pattern for job in plan}
    for folder in sorted(folders | {store.local, figures_folder(store)}):
        there = folder
        while not there.exists() and there != there.parent:
            there = there.parent
        if not there.is_dir():
            raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(there))
        if not os.access(there, os.W_OK | os.X_OK):
            raise PermissionError(errno.EACCES, "It cannot be written", str(there))


def _not_writable(folder: Path, error: OSError) -> FlexScaleError:
    """The sentence on a folder in which something cannot be written."""
    told = explain(error)
    return told or SystemFailureError(f"{folder} cannot be written: {error.strerror or error}.")

"""Runs a plan to its end through Snakemake, quietly; progress comes back as events."""

from __future__ import annotations

import fcntl
import os
import signal
import subprocess
import sys
import time
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexscale.errors import FlexScaleError, MissingDataError
from flexscale.steps.environment import EVENTS, RUN_PID, single_threaded
from flexscale.steps.events import EventReader
from flexscale.steps.experiment import Experiment
from flexscale.steps.figures import FIGURE, figure_is_current, figure_path
from flexscale.steps.plan import Plan

if TYPE_CHECKING:
    from flexscale.datasets.store import Store

#: Folder of the stamps below results/local; a stamp says that a job has been done.
STAMPS = ".workflow/done"
_GRACE = 5.0  # s that processes get to stop before they are killed
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
    FlexScaleError : the engine itself failed; its log is named.
    """
    work = store.root.resolve() / "local"
    (work / STAMPS).mkdir(parents=True, exist_ok=True)
    with _only_run(work):
        _match_stamps(plan, store, work)
        config = work / ".workflow" / "experiment.json"
        config.write_text(experiment.model_dump_json(indent=1, exclude_none=True))
        log, events = work / ".workflow" / "engine.log", work / ".workflow" / "events.jsonl"
        events.unlink(missing_ok=True)
        reader = EventReader(events)
        failed = False
        with log.open("wb") as output, _engine(work, config, events, cores, output) as process:
            while process.poll() is None:
                time.sleep(_POLL)
                for event in reader.read():
                    failed |= event["event"] == "error"
                    yield event
                yield {"event": "tick"}
        yield from reader.read()
        if process.returncode != 0 and not failed:
            raise FlexScaleError(_engine_failure(log, process.returncode))


def _match_stamps(plan: Plan, store: Store, work: Path) -> None:
    """Stamps say exactly which jobs are finished, whatever happened to the datasets since."""
    finished = finished_jobs(plan, store)
    for job in plan:
        stamp = work / STAMPS / job.id
        if job.id in finished:
            stamp.touch()
        else:
            stamp.unlink(missing_ok=True)


@contextmanager
def _only_run(work: Path) -> Iterator[None]:
    """Hold the folder's lock; it goes with the process, however that ends."""
    with (work / ".workflow" / "lock").open("a+") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            lock.seek(0)
            raise MissingDataError(
                f"Another flexscale run (process {lock.read().strip()}) is working in {work}: wait "
                "for it, or give this one another folder with --results."
            ) from error
        lock.truncate(0)
        lock.write(str(os.getpid()))
        lock.flush()
        yield


@contextmanager
def _engine(
    work: Path, config: Path, events: Path, cores: int, output: Any
) -> Iterator[subprocess.Popen[bytes]]:
    """Snakemake in a process group of its own, which is gone when the block is left."""
    environment = dict(os.environ)
    single_threaded(environment)
    package_root = str(Path(__file__).resolve().parents[2])
    paths = [package_root, *filter(None, [environment.get("PYTHONPATH")])]
    environment |= {
        "PYTHONPATH": os.pathsep.join(paths),
        EVENTS: str(events),
        RUN_PID: str(os.getpid()),
    }
    command = [sys.executable, "-m", "snakemake", "--snakefile", str(snakefile())]
    command += ["--directory", str(work), "--configfile", str(config), "--cores", str(cores)]
    # Whether a job is done is told by its stamp alone; see `_match_stamps`.
    command += ["--nolock", "--rerun-incomplete", "--rerun-triggers", "mtime"]
    command += ["--keep-going", "--quiet", "all"]
    # The shell gets a group of its own, so that Ctrl-C reaches only us and we stop all in order.
    process = subprocess.Popen(
        command,
        cwd=work,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=output,
        stderr=subprocess.STDOUT,
        start_new_session=True,
    )
    try:
        yield process
    finally:
        _stop_group(process)


def _stop_group(process: subprocess.Popen[bytes]) -> None:
    """Stop the process and all its descendants; samples in work are lost, finished ones kept."""
    for sign, patience in ((signal.SIGTERM, _GRACE), (signal.SIGKILL, _GRACE)):
        try:
            os.killpg(process.pid, sign)
        except ProcessLookupError:
            break
        deadline = time.monotonic() + patience
        while time.monotonic() < deadline and _group_lives(process):
            time.sleep(0.05)
    process.wait()


def _group_lives(process: subprocess.Popen[bytes]) -> bool:
    process.poll()
    try:
        os.killpg(process.pid, 0)
    except ProcessLookupError:
        return False
    return True


def snakefile() -> Path:
    """The workflow's rules: beside this file when installed, in workflows/ of a checkout."""
    installed = Path(__file__).with_name("Snakefile")
    return installed if installed.exists() else installed.parents[2] / "workflows" / "Snakefile"


def _engine_failure(log: Path, code: int) -> str:
    tail = log.read_text(errors="replace").strip().splitlines()[-8:]
    return f"The workflow engine stopped with code {code}; the end of {log}:\n" + "\n".join(tail)

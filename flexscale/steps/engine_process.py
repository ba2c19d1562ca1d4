"""Snakemake as a child process that answers to nobody but this run."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

from flexscale.kernel_cache import can_be_written, user_cache
from flexscale.processes import child_environment, describe_end
from flexscale.steps.environment import EVENTS, RUN_PID
from flexscale.system_failures import explain, explain_words

_GRACE = 5.0  # s that processes get to stop before they are killed
_LAST_LINES = 8
_PROBE = bytes(2**16)
#: What Snakemake says when it is asked to end (SIGTERM).
_ASKED_TO_END = "Will exit after finishing currently running jobs"
#: What it says when the shell of a job has failed.
_JOB_FAILED = "At least one job did not complete successfully"


@dataclass(frozen=True)
class Workplace:
    """A fresh folder that the engine works in: nothing that anybody left is read there."""

    folder: Path

    @property
    def experiment(self) -> Path:
        """The experiment, resolved."""
        return self.folder / "experiment.json"

    @property
    def events(self) -> Path:
        """What jobs tell while they run."""
        return self.folder / "events.jsonl"

    @property
    def log(self) -> Path:
        """What the engine and the jobs print."""
        return self.folder / "engine.log"

    def printed(self) -> str:
        """What is in the log."""
        try:
            return self.log.read_text(encoding="utf-8", errors="replace")
        except OSError:
            return ""

    def last_words(self) -> str:
        """The last lines of the log."""
        return "\n".join(self.printed().strip().splitlines()[-_LAST_LINES:])

    def trouble(self) -> str | None:
        """A sentence on what the machine refuses here, None where it is well."""
        try:
            (self.folder / "probe").write_bytes(_PROBE)
        except OSError as error:
            return str(explain(error) or error)
        return explain_words(self.last_words())


@contextmanager
def engine(place: Workplace, results: Path, cores: int) -> Iterator[subprocess.Popen[bytes]]:
    """Snakemake in a process group of its own, which is gone when the block is left."""
    environment = child_environment()
    environment |= {EVENTS: str(place.events), RUN_PID: str(os.getpid())}
    if not can_be_written(user_cache()):  # Snakemake does not start without one
        environment["XDG_CACHE_HOME"] = str(place.folder / "cache")
    # The shell gets a group of its own, so that Ctrl-C reaches only us and we stop all in order.
    with place.log.open("wb") as output:
        process = subprocess.Popen(
            _command(place, results, cores),
            cwd=place.folder,
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


def _command(place: Workplace, results: Path, cores: int) -> list[str]:
    command = [sys.executable, "-P", "-m", "flexscale.steps.watched", "snakemake"]
    command += ["--snakefile", str(snakefile())]
    command += ["--directory", str(place.folder), "--cores", str(cores)]
    # Profiles and configuration files may hold expressions, which Snakemake evaluates.
    command += ["--workflow-profile", "none"]
    command += ["--runtime-source-cache-path", str(place.folder / "sources")]
    facts = {"experiment": place.experiment, "results": results}
    command += ["--config", *(f"{key}={quote(bytes(path))}" for key, path in facts.items())]
    # Whether a job is done is told by its stamp alone.
    command += ["--nolock", "--rerun-triggers", "mtime"]
    return [*command, "--keep-going"]


def snakefile() -> Path:
    """The workflow's rules: beside this file when installed, in workflows/ of a checkout."""
    installed = Path(__file__).with_name("Snakefile")
    return installed if installed.exists() else installed.parents[2] / "workflows" / "Snakefile"


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


def describe_engine_end(code: int, place: Workplace) -> tuple[str, bool]:
    """How the engine ended, to stand behind its name, and whether that came from outside."""
    if code < 0:
        return describe_end(code), True
    if _ASKED_TO_END in place.printed():
        return "was asked to end, from outside", True
    if _JOB_FAILED in place.printed():
        return f"stopped with code {code}, since a job's shell was ended from outside", True
    return f"stopped with code {code}", False

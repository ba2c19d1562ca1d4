"""The engine as a child process: how its end and its jobs' are told, and what reaches it."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path
from typing import Any

import psutil
import pytest

from flexscale.datasets.locks import LockedError
from flexscale.datasets.owner import Owner
from flexscale.datasets.store import Store
from flexscale.errors import FlexScaleError, MissingDataError
from flexscale.processes import ProcessEndedError, child_environment
from flexscale.steps import engine, engine_process
from flexscale.steps.engine import run_plan
from flexscale.steps.experiment import Experiment, parse_experiment
from flexscale.steps.plan import Plan, build_plan
from flexscale.system_failures import SystemFailureError

START = 'printf \'{"event": "start", "job": "%s"}\\n\' "$JOB" >> "$FLEXSCALE_EVENTS"; '
EXIT = (
    'printf \'{"event": "exit", "job": "%s", "exit_code": 137}\\n\' "$JOB" >> "$FLEXSCALE_EVENTS"; '
)


@pytest.fixture(scope="module")
def experiment() -> Experiment:
    return parse_experiment({"patterns": {"square": {"family": "IH76"}}}, "file.yaml")


@pytest.fixture(scope="module")
def plan(experiment: Experiment) -> Plan:
    return build_plan(experiment)


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, plan: Plan, experiment: Experiment) -> Any:
    """Runs a plan of one job with a shell script in place of Snakemake; events without ticks."""
    monkeypatch.setenv("JOB", plan.jobs[0].id)

    def call(script: str, results: Path = tmp_path) -> list[dict[str, Any]]:
        monkeypatch.setattr(engine_process, "_command", lambda *_: ["sh", "-c", script])
        before = psutil.Process().children(recursive=True)
        try:
            events = list(run_plan(plan, experiment, Store(results), 1))
        finally:
            assert psutil.Process().children(recursive=True) == before
        return [event for event in events if event["event"] != "tick"]

    return call


def test_a_killed_engine_is_not_a_bug(run: Any, tmp_path: Path) -> None:
    with pytest.raises(ProcessEndedError) as caught:
        run(START + "kill -9 $$")
    assert "signal 9 (SIGKILL), as systems do when memory is short" in str(caught.value)
    assert "go on with the same command" in str(caught.value)
    assert caught.value.exit_code == 4
    assert list((tmp_path / "local" / ".staging").iterdir()) == []


def test_a_killed_job_is_told_with_its_cause(run: Any, plan: Plan) -> None:
    start, error = run(START + EXIT + "exit 1")
    assert start["event"] == "start"
    assert (error["event"], error["job"]) == ("error", plan.jobs[0].id)
    assert "signal 9 (SIGKILL), as systems do when memory is short" in error["message"]
    assert error["exit_code"] == 4


def test_a_job_killed_with_its_shell_is_told(run: Any) -> None:
    error = run(START + "exit 1")[-1]
    assert "its process was ended from outside" in error["message"]
    assert error["exit_code"] == 4


@pytest.mark.parametrize("begun", [True, False])
def test_a_shell_killed_before_its_job_began_is_told(run: Any, begun: bool) -> None:
    if begun:
        assert (
            "ended from outside" in run(START.replace("start", "begin") + "exit 1")[-1]["message"]
        )
        return
    with pytest.raises(ProcessEndedError, match="a job's shell was ended from outside"):
        run(f"echo '{engine_process._JOB_FAILED}.'; exit 1")


def test_what_a_job_told_itself_is_told_once(run: Any) -> None:
    told = START.replace("start", "error").replace('"}', '", "message": "no", "exit_code": 2}')
    events = run(START + told + EXIT + "exit 1")
    assert [event["event"] for event in events] == ["start", "error"]
    assert events[-1]["message"] == "no"


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ("OSError: [Errno 28] No space left on device", "The disk is full: free some space"),
        ("MemoryError: std::bad_alloc", "There is not enough memory"),
        ("libgmsh.so: failed to map segment from shared object", "not enough memory"),
    ],
)
def test_what_the_machine_refuses_is_told(run: Any, words: str, sentence: str) -> None:
    with pytest.raises(SystemFailureError, match=sentence):
        run(f"echo '{words}'; exit 1")
    assert sentence in run(START + EXIT + f"echo '{words}'; exit 1")[-1]["message"]


def test_a_full_disk_is_told(run: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where nothing can be written, neither jobs nor engine can tell why they failed."""
    write = Path.write_bytes

    def refuse(path: Path, data: bytes) -> int:
        if path.name == "probe":
            raise OSError(28, "No space left on device", str(path))
        return write(path, data)

    monkeypatch.setattr(Path, "write_bytes", refuse)
    assert "No space left on device; free some space" in run(START + "exit 1")[-1]["message"]
    with pytest.raises(SystemFailureError, match="No space left on device; free some space"):
        run("exit 1")


def test_a_log_that_only_speaks_of_memory_hides_no_bug(run: Any) -> None:
    """A user's name in an error's text, or a line of code that is shown with it."""
    said = r"raise ValueError(MemoryError)\nValueError: pattern named out of memory, MemoryError"
    with pytest.raises(FlexScaleError, match="pattern named out of memory") as caught:
        run(f"printf '{said}\\n'; exit 3")
    assert caught.value.exit_code == 1


def test_what_the_run_meets_is_not_told_of_the_folder(
    tmp_path: Path, plan: Plan, experiment: Experiment, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(engine_process, "_command", lambda *_: ["/no/such/program"])
    with pytest.raises(FileNotFoundError, match="/no/such/program"):
        list(run_plan(plan, experiment, Store(tmp_path), 1))
    assert list((tmp_path / "local" / ".staging").iterdir()) == []


def test_a_working_folder_that_cannot_be_made_is_told(run: Any, tmp_path: Path) -> None:
    (tmp_path / "local").mkdir()
    (tmp_path / "local" / ".staging").write_text("in the way")
    with pytest.raises(SystemFailureError, match="local cannot be written: File exists"):
        run("true")


def test_an_engine_asked_to_end_is_not_a_bug(run: Any) -> None:
    said = f"echo '{engine_process._ASKED_TO_END} (scheduler).'; exit 1"
    with pytest.raises(ProcessEndedError, match="was asked to end, from outside"):
        run(said)


def test_an_engine_that_fails_by_itself_is_one(run: Any, tmp_path: Path) -> None:
    with pytest.raises(FlexScaleError, match="stopped with code 3:\nwhat it said last") as caught:
        run("echo what it said last; exit 3")
    assert caught.value.exit_code == 1
    log = tmp_path / "local" / ".workflow" / "engine.log"
    assert log.read_text() == "what it said last\n"


def test_a_folder_removed_in_the_run_ends_it(run: Any) -> None:
    begun = time.monotonic()
    with pytest.raises(SystemFailureError, match="was removed in the run"):
        run('rm -rf "$PWD"; sleep 60')
    assert time.monotonic() - begun < 30.0


def test_a_second_run_waits_for_nothing(
    run: Any, tmp_path: Path, plan: Plan, experiment: Experiment, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(engine_process, "_command", lambda *_: ["sleep", "60"])
    first = run_plan(plan, experiment, Store(tmp_path), 1)
    assert next(first) == {"event": "tick"}
    me = f"process {os.getpid()} on {Owner.of_this_process().host}"
    with pytest.raises(MissingDataError, match=me) as caught:
        next(run_plan(plan, experiment, Store(tmp_path), 1))
    assert isinstance(caught.value.__cause__, LockedError)
    first.close()
    assert run("true") == []


@pytest.mark.parametrize("place", ["local", "local/joint/IH76", "local/figures"])
def test_folders_that_cannot_be_written_are_refused_before_anything_runs(
    run: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, place: str
) -> None:
    closed = tmp_path / place
    closed.mkdir(parents=True)
    allowed = os.access
    monkeypatch.setattr(
        engine.os, "access", lambda path, mode: Path(path) != closed and allowed(path, mode)
    )
    with pytest.raises(SystemFailureError, match=f"{closed}: It cannot be written; choose a"):
        run('echo ran > "$RAN"')
    assert not list(tmp_path.rglob(".workflow"))


def test_a_file_in_the_way_is_refused(run: Any, tmp_path: Path) -> None:
    (tmp_path / "results").write_text("mine")
    with pytest.raises(SystemFailureError, match="Not a directory; choose a folder"):
        run("true", tmp_path / "results")


def test_children_do_not_get_what_is_not_theirs(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SNAKEMAKE_PROFILE", "cluster")
    monkeypatch.setenv("MPLBACKEND", "module://matplotlib_inline.backend_inline")
    monkeypatch.setenv("PYTHONIOENCODING", "latin-1")
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(["", "lib", "/opt/other", ""]))
    environment = child_environment()
    assert "SNAKEMAKE_PROFILE" not in environment
    assert "PYTHONIOENCODING" not in environment
    assert environment["MPLBACKEND"] == "Agg"
    assert environment["PYTHONSAFEPATH"] == "1"
    paths = environment["PYTHONPATH"].split(os.pathsep)
    assert paths[-2:] == [str(tmp_path / "lib"), "/opt/other"]
    assert all(Path(path).is_absolute() for path in paths)
    assert str(tmp_path) not in paths


def test_stopping_a_run_stops_all_of_it(
    tmp_path: Path, plan: Plan, experiment: Experiment, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Even what does not heed SIGTERM."""
    monkeypatch.setattr(engine_process, "_GRACE", 0.2)
    script = "trap '' TERM; sleep 60 & sleep 60"
    monkeypatch.setattr(engine_process, "_command", lambda *_: ["sh", "-c", script])
    events = run_plan(plan, experiment, Store(tmp_path), 1)
    next(events)
    family = psutil.Process().children(recursive=True)
    assert len(family) >= 2
    events.close()
    assert psutil.wait_procs(family, timeout=5)[1] == []
    assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL

"""Processes of a sweep, killed at any moment: the sweep ends at once, and says why."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import psutil
import pytest

import flexscale as fs
from flexscale.datasets.identity import content_digest
from flexscale.datasets.staging import FileCheckpoint
from flexscale.homogenize import line_workers
from flexscale.homogenize.bend_line import Line
from flexscale.homogenize.line_workers import LineWorkers
from flexscale.processes import ProcessEndedError, describe_end

LINES = [Line("closing", direction, (0.0, 0.001)) for direction in (0.0, 30.0, 60.0)]
#: More than a pipe or socket takes before someone reads.
LARGE = bytes(2**23)


def children() -> list[psutil.Process]:
    return psutil.Process().children(recursive=True)


def put_in_place(monkeypatch: pytest.MonkeyPatch, code: str) -> None:
    """Run other code in place of a worker; it is given the number of the socket."""

    def command(module: str, *arguments: str) -> list[str]:
        return [sys.executable, "-c", code, *arguments]

    monkeypatch.setattr(line_workers, "python_command", command)


@pytest.mark.parametrize(
    ("code", "words"),
    [
        ("import os; os.kill(os.getpid(), 9)", "signal 9 .SIGKILL., as systems do when memory"),
        ("import os; os.read(int(__import__('sys').argv[1]), 9); os.abort()", "SIGABRT"),
        ("raise SystemExit(7)", "exit code 7"),
        # Half an answer: its length is told, the rest never comes.
        (
            "import os, sys; n = int(sys.argv[1]); os.write(n, bytes([0, 0, 1, 0, 1]));"
            "os.kill(os.getpid(), 15)",
            "SIGTERM",
        ),
    ],
)
def test_a_worker_that_dies_early_ends_the_sweep(
    monkeypatch: pytest.MonkeyPatch, code: str, words: str
) -> None:
    put_in_place(monkeypatch, code)
    before, start = children(), time.monotonic()
    with (
        pytest.raises(ProcessEndedError, match=words),
        LineWorkers((LARGE,), fs.SolverOptions(), lambda _: [], None) as pool,
    ):
        list(pool.run(LINES, 2))
    assert time.monotonic() - start < 20.0
    assert children() == before


def test_a_worker_that_listens_no_more_is_killed_in_the_end(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    put_in_place(monkeypatch, "import os, sys, time; os.close(int(sys.argv[1])); time.sleep(60)")
    monkeypatch.setattr(line_workers, "_GRACE", 0.1)
    with (
        pytest.raises(ProcessEndedError, match="SIGKILL"),
        LineWorkers((LARGE,), fs.SolverOptions(), lambda _: [], None) as pool,
    ):
        list(pool.run(LINES, 1))


def test_a_sweep_whose_worker_was_killed_goes_on_to_the_same_bits(tmp_path: Path) -> None:
    pattern = fs.Pattern(fs.Tiling("IH76"))
    mesh = fs.MeshOptions(along=4, corner=1, scale_size=10, scale_layers=1, scale_order=1)
    checkpoint = FileCheckpoint(tmp_path)

    def sweep(**options: object) -> object:
        given = ([0.0, 45.0], [0.0, 0.001, 0.002], ["closing"])
        return fs.sweep(pattern, *given, **options, model=fs.NativeModel("shell", mesh=mesh))  # type: ignore[arg-type]

    def kill(event: object) -> None:
        for process in children():
            process.send_signal(signal.SIGKILL)

    with pytest.raises(ProcessEndedError, match="goes on from them"):
        sweep(workers=2, checkpoint=checkpoint, on_sample=kill)
    n_kept = len(list(tmp_path.rglob("*.npz")))
    assert 1 <= n_kept < 6
    seen: list[object] = []
    resumed = sweep(workers=2, checkpoint=checkpoint, on_sample=seen.append)
    assert len(seen) == 6
    assert content_digest(resumed) == content_digest(sweep(workers=1))  # type: ignore[arg-type]


def test_workers_end_with_the_process_that_started_them() -> None:
    code = (
        "import os, time, flexscale as fs\n"
        "from flexscale.homogenize.line_workers import _Worker\n"
        "print(_Worker().process.pid, flush=True)\n"
        "os.kill(os.getpid(), 9)\n"
    )
    read, write = os.pipe()
    pid = os.posix_spawn(
        sys.executable,
        [sys.executable, "-c", code],
        os.environ,
        file_actions=[(os.POSIX_SPAWN_DUP2, write, 1)],
    )
    os.close(write)
    os.waitpid(pid, 0)
    with os.fdopen(read) as out:
        worker = int(out.readline())
    deadline = time.monotonic() + 60.0  # it loads its libraries first
    while psutil.pid_exists(worker) and time.monotonic() < deadline:
        if psutil.Process(worker).status() == psutil.STATUS_ZOMBIE:
            break
        time.sleep(0.1)
    else:
        assert not psutil.pid_exists(worker)


def test_threads_do_not_outlive_a_sweep() -> None:
    assert not [thread for thread in threading.enumerate() if "_serve" in thread.name]


@pytest.mark.parametrize(
    ("code", "words"),
    [(-9, "signal 9 (SIGKILL)"), (137, "signal 9 (SIGKILL)"), (-24, "ulimit -t"), (3, "code 3")],
)
def test_ends_of_processes_have_words(code: int, words: str) -> None:
    assert words in describe_end(code)


def test_a_mesh_leaves_broken_pipes_to_be_caught() -> None:
    """gmsh would have a write to a worker that was killed end this process, by SIGPIPE."""
    code = (
        "import os\n"
        "from flexscale.mesh.prototile import _gmsh_model\n"
        "with _gmsh_model():\n"
        "    pass\n"
        "reading, writing = os.pipe()\n"
        "os.close(reading)\n"
        "try:\n"
        "    os.write(writing, b'x')\n"
        "except BrokenPipeError:\n"
        "    print('caught')\n"
    )
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.stdout, done.returncode) == ("caught\n", 0)

"""Processes of a run end with it, from their first moment on."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

from flexscale.steps.environment import RUN_PID

WAITS = "import time; time.sleep(300)"


def test_a_module_ends_with_the_run_it_belongs_to(tmp_path: Path) -> None:
    (tmp_path / "waits.py").write_text(f"print('here', flush=True); {WAITS}")
    run = subprocess.Popen([sys.executable, "-c", WAITS])
    watched = subprocess.Popen(
        [sys.executable, "-m", "flexscale.steps.watched", "waits", "an argument"],
        env=os.environ | {RUN_PID: str(run.pid), "PYTHONPATH": str(tmp_path)},
        stdout=subprocess.PIPE,
        start_new_session=True,
    )
    assert watched.stdout is not None
    assert watched.stdout.readline() == b"here\n"
    assert watched.poll() is None
    run.kill()
    run.wait()
    watched.stdout.close()
    assert watched.wait(timeout=60.0) == -signal.SIGKILL


def test_it_is_given_its_arguments_and_ends_with_its_code(tmp_path: Path) -> None:
    (tmp_path / "tells.py").write_text("import sys; print(sys.argv[1:]); sys.exit(7)")
    found = subprocess.run(
        [sys.executable, "-m", "flexscale.steps.watched", "tells", "--cores", "2"],
        env=os.environ | {"PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (found.stdout, found.returncode) == ("['--cores', '2']\n", 7)

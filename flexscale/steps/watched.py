"""``python -m flexscale.steps.watched MODULE …``: a module that ends with the run it belongs to.

`flexscale run` may be killed without a chance to clean up; nothing may then keep computing behind
the user's back. Watching begins before the module loads its libraries, which takes seconds.
"""

from __future__ import annotations

import os
import runpy
import signal
import sys
import threading
import time

import psutil

from flexscale.steps.environment import RUN_PID


def watch_run() -> None:
    """Kill this process group as soon as the run that is named in the environment is gone."""
    if RUN_PID not in os.environ:
        return
    pid = int(os.environ[RUN_PID])
    run = psutil.Process(pid) if psutil.pid_exists(pid) else None

    def lives() -> bool:
        try:
            return run is not None and run.is_running() and run.status() != psutil.STATUS_ZOMBIE
        except psutil.NoSuchProcess:
            return False

    def watch() -> None:
        while lives():
            time.sleep(1.0)
        os.killpg(os.getpgrp(), signal.SIGKILL)

    threading.Thread(target=watch, daemon=True).start()


if __name__ == "__main__":
    watch_run()
    del sys.argv[0]
    runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)

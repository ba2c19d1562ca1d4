"""Child processes: what they inherit from this one, and how their end is told."""

from __future__ import annotations

import os
import signal
import site
import sys
from collections.abc import MutableMapping
from pathlib import Path

from flexscale.errors import FlexScaleError

_THREAD_COUNTS = (
    "OMP_NUM_THREADS",
    "MKL_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "NUMBA_NUM_THREADS",
    "NUMEXPR_NUM_THREADS",
)
_NO_MEMORY = "as systems do when memory is short; fewer processes (--cores) need less"
#: Signals by which processes end that nobody meant to end -> what is likely behind them.
_CAUSES = {
    "SIGKILL": _NO_MEMORY,
    "SIGTERM": "from outside, as queueing systems do when a job's time is up",
    "SIGHUP": "from outside, as its terminal was closed",
    "SIGINT": "from outside",
    "SIGXCPU": "as it exceeded its limit of processor time (ulimit -t)",
    "SIGBUS": "as happens where a disk is full or memory is short",
    "SIGSEGV": "a crash in a library, as happens where memory is short",
    "SIGABRT": "a crash in a library, as happens where memory is short",
}


class ProcessEndedError(FlexScaleError):
    """A child process ended before its work was done: killed, crashed, or short of memory."""

    exit_code = 4


def describe_end(code: int) -> str:
    """How a process ended, for a sentence that it begins.

    Parameters
    ----------
    code : its exit code; negative for a signal, as `subprocess` has it, or above 128, as shells.

    Returns
    -------
    For instance "was ended by signal 9 (SIGKILL), as systems do when memory is short; …".
    """
    number = -code if code < 0 else code - 128
    try:
        name = signal.Signals(number).name
    except ValueError:
        return f"ended with exit code {code}"
    cause = _CAUSES.get(name)
    return f"was ended by signal {number} ({name})" + (f", {cause}" if cause else "")


def single_threaded(environment: MutableMapping[str, str]) -> None:
    """One thread in every numerical library: equal bits everywhere, one process per core.

    Must come before numpy is imported in the process it is meant for.
    """
    for name in _THREAD_COUNTS:
        environment[name] = "1"


def child_environment() -> dict[str, str]:
    """Environment of child processes: this one's, without what must not reach them.

    They never import from the folder they work in, whoever filled it; a plotting backend or an
    encoding meant for this process's window is not theirs; nor are settings of the workflow engine.
    """
    environment = {
        name: value for name, value in os.environ.items() if not name.startswith("SNAKEMAKE_")
    }
    single_threaded(environment)
    environment |= {"PYTHONSAFEPATH": "1", "PYTHONUTF8": "1", "MPLBACKEND": "Agg"}
    environment.pop("PYTHONIOENCODING", None)
    paths = [os.path.abspath(path) for path in _python_path()]
    package_root = str(Path(__file__).resolve().parents[1])
    if package_root not in {*site.getsitepackages(), site.getusersitepackages()}:
        paths.insert(0, package_root)
    environment["PYTHONPATH"] = os.pathsep.join(paths)
    return environment


def _python_path() -> list[str]:
    """Entries of PYTHONPATH; an empty one would be whatever folder a child works in."""
    return [path for path in os.environ.get("PYTHONPATH", "").split(os.pathsep) if path]


def python_command(module: str, *arguments: str) -> list[str]:
    """Command that calls `main(arguments)` of a module, found where this process finds modules.

    Ctrl-C is not for the process: whoever started it ends it.
    """
    paths = [path for path in sys.path if os.path.isabs(path)]
    code = (
        "import signal, sys; signal.signal(signal.SIGINT, signal.SIG_IGN); "
        f"sys.path[:] = {paths!r}; from {module} import main; sys.exit(main(sys.argv[1:]))"
    )
    return [sys.executable, "-c", code, *arguments]

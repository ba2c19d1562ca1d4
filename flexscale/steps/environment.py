"""Environment of the job processes."""

from __future__ import annotations

from collections.abc import MutableMapping

#: Environment variables by which `flexscale run` speaks to its job processes.
EVENTS = "FLEXSCALE_EVENTS"
RUN_PID = "FLEXSCALE_RUN_PID"

_THREAD_COUNTS = (
    "OMP_NUM_THREADS",
    "MKL_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "NUMBA_NUM_THREADS",
    "NUMEXPR_NUM_THREADS",
)


def single_threaded(environment: MutableMapping[str, str]) -> None:
    """One thread in every numerical library: equal bits everywhere, one process per core.

    Must come before numpy is imported in the process it is meant for.
    """
    for name in _THREAD_COUNTS:
        environment[name] = "1"

"""Environment variables by which `flexscale run` speaks to its job processes."""

from __future__ import annotations

EVENTS = "FLEXSCALE_EVENTS"
RUN_PID = "FLEXSCALE_RUN_PID"

#: Folder of the stamps below the engine's working folder; a stamp says that a job has been done.
STAMPS = "done"

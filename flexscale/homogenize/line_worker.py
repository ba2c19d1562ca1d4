"""A process that solves lines of a sweep.

It is sent the problem once, then line after line, and answers with samples as they finish; it ends
as soon as the process that started it does.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import select
import threading
import traceback
from multiprocessing.connection import Connection

SAMPLE, DONE, FAILED = "sample", "done", "failed"


def watch(number: int) -> None:
    """End this process when the far end of the socket is closed, whatever it is doing."""

    def wait() -> None:
        poller = select.poll()
        poller.register(number, select.POLLHUP | select.POLLERR)
        poller.poll()
        os._exit(1)

    threading.Thread(target=wait, daemon=True).start()


def serve(connection: Connection) -> None:
    """Answer requests until there are no more."""
    from flexscale.homogenize.line import follow_line

    (build, parts), problem = connection.recv(), None
    while True:
        line, solver, finished = connection.recv()
        try:
            problem = problem or build(*parts)
            for sample in follow_line(problem, line, solver, finished):
                connection.send((SAMPLE, sample))
        except Exception as error:
            connection.send((FAILED, _portable(error)))
        else:
            connection.send((DONE, None))


def _portable(error: Exception) -> Exception:
    """The error with its trace, as one that can be sent."""
    trace = traceback.format_exc()
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        error = RuntimeError(repr(error))
    error.add_note(f"In a process of the sweep:\n{trace}")
    return error


def main(arguments: list[str]) -> None:
    """Serve the process at the other end of the socket whose number is given."""
    number = int(arguments[0])
    watch(number)
    with contextlib.suppress(EOFError, OSError):  # the other end is gone
        serve(Connection(number))

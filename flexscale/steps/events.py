"""What happens during a run, as lines of JSON that the job processes append to one file."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any


class EventWriter:
    """Appends events to a file; several processes may do so at once.

    Parameters
    ----------
    path : file to append to; None drops every event.
    """

    def __init__(self, path: Path | None) -> None:
        self.path = path

    def write(self, event: str, job: str, **facts: Any) -> None:
        """Append one event of a job; `facts` are plain numbers and text.

        A full disk loses the event, never the work that it tells of.
        """
        if self.path is None:
            return
        line = json.dumps({"event": event, "job": job, **facts}) + "\n"
        # One write to a file opened for appending: lines of several processes never mix.
        with suppress(OSError):
            handle = os.open(self.path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o644)
            try:
                os.write(handle, line.encode())
            finally:
                os.close(handle)


class EventReader:
    """Yields the events that were appended since the last look."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.position = 0

    def read(self) -> Iterator[dict[str, Any]]:
        """New events in their order; a line still being written waits for the next look."""
        if not self.path.exists():
            return
        with self.path.open("rb") as file:
            file.seek(self.position)
            for line in file:
                if not line.endswith(b"\n"):
                    return
                self.position += len(line)
                try:
                    event = json.loads(line)
                except ValueError:  # of a process that was killed, or a full disk
                    continue
                yield event

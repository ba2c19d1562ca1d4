"""How the jobs of a run ended, those too that could not tell it themselves."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from flexscale.processes import ProcessEndedError, describe_end
from flexscale.steps.engine_process import Workplace
from flexscale.steps.events import EventReader
from flexscale.steps.plan import Plan

RESUME = "Finished work is kept: go on with the same command."


class JobEnds:
    """Passes on the events of a run, and adds the errors of jobs that were killed.

    Attributes
    ----------
    started, over : ids of jobs.
    failed : whether any job has failed.
    """

    def __init__(self, plan: Plan, place: Workplace) -> None:
        self.plan = plan
        self.place = place
        self.reader = EventReader(place.events)
        self.started: set[str] = set()
        self.over: set[str] = set()
        self.failed = False

    def news(self) -> Iterator[dict[str, Any]]:
        """New events of jobs; what their shells told becomes errors where jobs told none."""
        for event in self.reader.read():
            kind, job_id = event["event"], event["job"]
            if kind == "exit":
                if job_id not in self.over:
                    yield self._error(job_id, describe_end(event["exit_code"]))
                continue
            self.started.add(job_id)
            if kind == "begin":
                continue
            if kind in ("end", "error"):
                self.over.add(job_id)
                self.failed |= kind == "error"
            yield event

    def unexplained(self) -> Iterator[dict[str, Any]]:
        """Errors of the jobs that began and of whose end nothing is known."""
        for job in self.plan:
            if job.id in self.started - self.over:
                yield self._error(job.id, "was ended from outside")

    def _error(self, job_id: str, end: str) -> dict[str, Any]:
        self.over.add(job_id)
        self.failed = True
        trouble = self.place.trouble()
        message = f"its process {end}. {f'{trouble} ' if trouble else ''}{RESUME}"
        code = ProcessEndedError.exit_code
        return {"event": "error", "job": job_id, "message": message, "exit_code": code}

"""Progress of a run: a bar on a terminal, a line now and then elsewhere; always on stderr."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import Any, Self

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    ProgressColumn,
    TextColumn,
    TimeElapsedColumn,
)
from rich.progress import Progress as RichProgress

from flexscale.cli.printable import terminal_stream
from flexscale.steps.catalog import STEPS
from flexscale.steps.plan import Plan

_INTERVAL = 30.0  # s between lines where there is no terminal


class Progress:
    """Shows events of a run; a context manager.

    Parameters
    ----------
    plan : all jobs.
    finished : job id -> result of those that need not run.
    quiet : show nothing.
    """

    def __init__(self, plan: Plan, finished: dict[str, str], *, quiet: bool = False) -> None:
        self.plan = plan
        self.quiet = quiet
        self.started = self.last_line = time.monotonic()
        self.jobs_left = sum(job.id not in finished for job in plan)
        told = {name for name, step in STEPS.items() if step.resumable}
        self.samples = {job.id: 0 for job in plan if job.id not in finished and job.step in told}
        self.total = sum(plan[job_id].n_samples for job_id in self.samples)
        self.n_failed: dict[str, int] = {}
        self.working: dict[str, float] = {}
        self.where = ""
        self.bar: RichProgress | None = None
        if sys.stderr.isatty() and not quiet:
            columns: tuple[ProgressColumn, ...] = (
                TextColumn("{task.description}"),
                BarColumn(),
                MofNCompleteColumn(),
                TextColumn("samples"),
                TimeElapsedColumn(),
            )
            self.bar = RichProgress(
                *columns, console=Console(file=terminal_stream()), transient=True
            )
            self.task = self.bar.add_task("starting", total=max(self.total, 1))

    def __enter__(self) -> Self:
        if self.bar is not None:
            self.bar.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self.bar is not None:
            self.bar.stop()

    def show(self, event: dict[str, Any]) -> None:
        """Take in one event of `engine.run_plan`."""
        kind, job_id = event["event"], event.get("job", "")
        if kind == "start":
            self.working[job_id] = time.monotonic()
        elif kind == "sample":
            # A sweep solves one more, to check symmetry, than the plan counts.
            self.samples[job_id] = min(event["done"], self.plan[job_id].n_samples)
            self.n_failed[job_id] = event["n_failed"]
            self.where = _place(event)
        elif kind in ("end", "error"):
            self.working.pop(job_id, None)
            self.jobs_left -= 1
            outcome = f"{event['seconds']:.0f} s" if kind == "end" else "failed"
            self._say(f"{self.plan[job_id].label:<32} {outcome}")
        self._refresh()

    def _refresh(self) -> None:
        done = sum(self.samples.values())
        if self.bar is not None:
            self.bar.update(self.task, completed=done, description=self._description())
        elif time.monotonic() - self.last_line > _INTERVAL:
            counted = f"{done}/{self.total} samples, " if self.total else ""
            self._say(f"{self._description()}; {counted}{self.jobs_left} jobs to go")

    def _description(self) -> str:
        busy = [" ".join(self.plan[job_id].label.split()) for job_id in self.working]
        failed = sum(self.n_failed.values())
        text = ", ".join(busy) or "starting"
        if self.where and any(job_id in self.samples for job_id in self.working):
            text += f" ({self.where})"
        return text + (f", {failed} not converged" if failed else "")

    def _say(self, line: str) -> None:
        self.last_line = time.monotonic()
        if self.quiet:
            return
        if self.bar is not None:
            self.bar.console.print(line, highlight=False)
        else:
            elapsed = self.last_line - self.started
            print(f"[{elapsed:5.0f} s] {line}", file=sys.stderr, flush=True)


def _place(event: dict[str, Any]) -> str:
    """Which of a job's samples is finished: of a line of bends, or on a device."""
    if "shape" in event:
        place = f"{event['direction']:g}°, shape {event['shape']:g}°, {event['curvature']:g} mm-1"
    elif "curvature" in event:
        place = f"{event['side']} {event['direction']:g}°, {event['curvature']:g} mm-1"
    else:
        place = f"{event['side']} {event['device']}, {event['place']:g} {event['unit']}"
    return place

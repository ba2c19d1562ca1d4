"""Lines of bends, followed one after the other or in processes, with progress and checkpoints."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import NamedTuple

from flexscale.homogenize.bend_line import AnyLine
from flexscale.homogenize.checkpoint import Checkpoint
from flexscale.homogenize.line import follow_line, load_line
from flexscale.homogenize.line_workers import LineWorkers
from flexscale.homogenize.problem import Bendable, Problem
from flexscale.homogenize.sample import Sample
from flexscale.solve.solver_options import SolverOptions
from flexscale.status import SolveStatus


class Counts(NamedTuple):
    """Samples finished, in all, and not converged so far; seconds since the first began."""

    done: int
    total: int
    n_failed: int
    seconds: float


#: Called as samples finish.
Teller = Callable[[AnyLine, Sample, Counts], None]


def run_in_turn(
    problem: Bendable,
    lines: Sequence[AnyLine],
    solver: SolverOptions,
    checkpoint: Checkpoint | None = None,
    tell: Teller[AnyLine] | None = None,
) -> dict[AnyLine, list[Sample]]:
    """Samples of every line, one line after the other in this process."""
    return _collect(_in_turn(problem, lines, solver, checkpoint), lines, tell)


def run_in_processes(
    problem: Problem,
    lines: Sequence[AnyLine],
    solver: SolverOptions,
    checkpoint: Checkpoint | None = None,
    tell: Teller[AnyLine] | None = None,
    *,
    workers: int,
) -> dict[AnyLine, list[Sample]]:
    """Samples of every line, in so many processes; in this one if one is enough.

    Raises
    ------
    ProcessEndedError : a process that solved samples was killed or crashed.
    """
    workers = min(workers, len(lines))
    if workers <= 1:
        return run_in_turn(problem, lines, solver, checkpoint, tell)
    finished = partial(load_line, problem, checkpoint=checkpoint)
    with LineWorkers(problem.parts, solver, finished, checkpoint) as pool:
        return _collect(pool.run(lines, workers), lines, tell)


def _in_turn(
    problem: Bendable,
    lines: Sequence[AnyLine],
    solver: SolverOptions,
    checkpoint: Checkpoint | None,
) -> Iterator[tuple[AnyLine, Sample]]:
    for line in lines:
        finished = load_line(problem, line, checkpoint)
        for sample in finished:
            yield line, sample
        for sample in follow_line(problem, line, solver, finished):
            if checkpoint:
                checkpoint.append(line.key, sample)
            yield line, sample


def _collect(
    results: Iterator[tuple[AnyLine, Sample]],
    lines: Sequence[AnyLine],
    tell: Teller[AnyLine] | None,
) -> dict[AnyLine, list[Sample]]:
    start = time.perf_counter()
    total = sum(len(line.curvatures) for line in lines)
    failed = 0
    samples: dict[AnyLine, list[Sample]] = {line: [] for line in lines}
    for done, (line, sample) in enumerate(results, start=1):
        samples[line].append(sample)
        failed += SolveStatus(sample["status"]) != SolveStatus.converged
        if tell:
            tell(line, sample, Counts(done, total, failed, time.perf_counter() - start))
    return samples

"""Lines of a sweep in processes of their own, any of which may be killed at any moment.

Every worker has a socket of its own to this process, whose far end nobody else holds: when a worker
dies, reading and writing end at once, however much was under way. Queues and locks that several
processes share do not have that property. Workers end with this process in the same way.
"""

from __future__ import annotations

import os
import queue
import socket
import subprocess
from collections.abc import Callable, Iterator, Sequence
from multiprocessing.connection import Connection
from threading import Lock, Thread
from typing import Any, cast

from flexscale.homogenize.bend_line import AnyLine, BendLine
from flexscale.homogenize.checkpoint import STATE, Checkpoint
from flexscale.homogenize.line_worker import DONE, FAILED
from flexscale.homogenize.sample import Sample
from flexscale.processes import ProcessEndedError, child_environment, describe_end, python_command
from flexscale.solve.solver_options import SolverOptions

_WORKER = "flexscale.homogenize.line_worker"
_GRACE = 5.0  # s that a worker whose socket is closed has to end before its code is asked for


class LineWorkers:
    """Solves lines in several processes; a context manager that leaves none behind.

    Parameters
    ----------
    problem : what makes it, and of what, picklable.
    solver : solver options.
    finished : samples of a line that are there already.
    checkpoint : keeps samples as they finish, in this process; None keeps none.
    """

    def __init__(
        self,
        problem: tuple[Any, ...],
        solver: SolverOptions,
        finished: Callable[[BendLine], list[Sample]],
        checkpoint: Checkpoint | None,
    ) -> None:
        self.problem = problem
        self.solver = solver
        self.finished = finished
        self.checkpoint = checkpoint
        self.lock = Lock()  # of the checkpoint and the list of workers
        self.todo: queue.SimpleQueue[BendLine] = queue.SimpleQueue()
        self.results: queue.SimpleQueue[tuple[BendLine, Sample] | BaseException | None]
        self.results = queue.SimpleQueue()
        self.workers: list[_Worker] = []
        self.threads: list[Thread] = []
        self.closed = False

    def run(self, lines: Sequence[AnyLine], workers: int) -> Iterator[tuple[AnyLine, Sample]]:
        """Samples as they finish, each line's in their order, without the states they end in.

        Raises
        ------
        ProcessEndedError : a worker was killed or crashed.
        """
        for line in lines:
            self.todo.put(line)
        self.threads = [Thread(target=self._serve, daemon=True) for _ in range(workers)]
        for thread in self.threads:
            thread.start()
        working = workers
        while working:
            result = self.results.get()
            if isinstance(result, BaseException):
                raise result
            if result is None:
                working -= 1
                continue
            line, sample = cast(tuple[AnyLine, Sample], result)
            kept = {name: value for name, value in sample.items() if name not in STATE}
            yield line, cast(Sample, kept)

    def __enter__(self) -> LineWorkers:
        return self

    def __exit__(self, *error: object) -> None:
        with self.lock:
            self.closed = True
            for worker in self.workers:
                worker.end()
        for thread in self.threads:
            thread.join()
        for worker in self.workers:
            worker.connection.close()

    def _serve(self) -> None:
        """Give lines to one worker until there are none; all that happens goes to `results`."""
        worker: _Worker | None = None
        try:
            while not self.closed:
                try:
                    line = self.todo.get_nowait()
                except queue.Empty:
                    break
                finished = self._finished(line)
                for sample in finished:
                    self.results.put((line, sample))
                if len(finished) < len(line.curvatures):
                    worker = worker or self._start()
                    for sample in worker.follow(line, self.solver, finished):
                        self._keep(line, sample)
                        self.results.put((line, sample))
        except BaseException as error:  # raised again by `run`, in the caller's thread
            self.results.put(error)
        else:
            self.results.put(None)

    def _start(self) -> _Worker:
        with self.lock:
            if self.closed:
                raise ProcessEndedError("The sweep was stopped.")
            worker = _Worker()
            self.workers.append(worker)
        worker.send(self.problem)
        return worker

    def _finished(self, line: BendLine) -> list[Sample]:
        with self.lock:
            return self.finished(line)

    def _keep(self, line: BendLine, sample: Sample) -> None:
        if self.checkpoint is not None:
            with self.lock:
                self.checkpoint.append(line.key, sample)


class _Worker:
    """One process and the socket to it."""

    def __init__(self) -> None:
        ours, theirs = socket.socketpair()
        with theirs:
            number = theirs.fileno()
            self.process = subprocess.Popen(
                python_command(_WORKER, str(number)),
                pass_fds=[number],
                stdin=subprocess.DEVNULL,
                env=child_environment(),
            )
        self.connection = Connection(ours.detach())

    def send(self, message: object) -> None:
        try:
            self.connection.send(message)
        except OSError as error:
            raise self._ended() from error

    def follow(
        self, line: BendLine, solver: SolverOptions, finished: list[Sample]
    ) -> Iterator[Sample]:
        """Samples of a line behind the finished ones, as the worker solves them."""
        self.send((line, solver, finished))
        while True:
            try:
                kind, content = self.connection.recv()
            except (EOFError, OSError) as error:
                raise self._ended() from error
            if kind == DONE:
                return
            if kind == FAILED:
                raise content
            yield content

    def end(self) -> None:
        """Kill the process; whoever waits for its answer hears of it."""
        self.process.kill()
        self.process.wait()

    def _ended(self) -> ProcessEndedError:
        try:
            code = self.process.wait(_GRACE)
        except subprocess.TimeoutExpired:
            self.process.kill()
            code = self.process.wait()
        return ProcessEndedError(
            f"A process that solved samples of the sweep (process {self.process.pid} on "
            f"{os.uname().nodename}) {describe_end(code)}. Run again: a sweep that keeps its "
            "samples goes on from them."
        )

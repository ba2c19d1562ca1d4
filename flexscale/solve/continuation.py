"""Continuation: equilibria along one parameter, from sample to sample in steps that may shrink.

What is followed is a `Path`: the bend of a cell, the shortening of a strip, the load on a sheet. A
step that starts badly, or takes Newton's method too long, is halved; after one that worked out it
grows again.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from flexscale.arrays import FloatArray
from flexscale.solve.newton import Objective, Solution, solve_within
from flexscale.solve.solver_options import SolverOptions
from flexscale.status import SolveStatus


class Point(Protocol):
    """An equilibrium on a path, with what its path needs to know to go on from there."""

    @property
    def parameter(self) -> float:
        """Where on the path it lies."""


P = TypeVar("P", bound=Point)


class Path(Protocol[P]):
    """A family of objectives along a parameter."""

    def objective(self, parameter: float) -> Objective:
        """What an equilibrium at a parameter minimizes."""

    def predict(self, point: P, parameter: float) -> FloatArray | None:
        """A start at a parameter beyond a point; None where a smaller step promises more."""

    def fall_back(self, point: P, parameter: float) -> FloatArray:
        """The start that is left when steps have become too small to predict anything."""

    def next_point(self, before: P | None, parameter: float, solution: Solution) -> P:
        """The point of a solution, reached from another one."""


@dataclass(frozen=True)
class Stepping:
    """How steps shrink and grow; shares are of the way between two samples.

    Attributes
    ----------
    smallest : give up when a step falls below this share.
    cautious : halve a step above this share as soon as it gets hard.
    patience : iterations after which such a step is hard.
    growth : factor of a step after one that converged.
    rest : take what is left in one step if it is less than so many steps.
    """

    smallest: float
    cautious: float = 1.0 / 4.0
    patience: int = 10
    growth: float = 2.0
    rest: float = 1.0


@dataclass
class Effort:
    """What it took to get from one sample to the next."""

    iterations: int = 0
    unstable: int = 0  # of the iterations


@dataclass(frozen=True)
class Arrival(Generic[P]):
    """How far a step from one sample to the next got.

    Attributes
    ----------
    point : the last equilibrium on the way.
    solution : of the last attempt; its status is that of the sample.
    effort : of all attempts.
    """

    point: P
    solution: Solution
    effort: Effort


def advance(
    path: Path[P], point: P, parameter: float, options: SolverOptions, stepping: Stepping
) -> Arrival[P]:
    """Continue from a point to a parameter, in smaller steps where needed."""
    start, span = point.parameter, parameter - point.parameter
    done, share, effort = 0.0, 1.0, Effort()
    while True:
        share = 1.0 - done if stepping.rest * share > 1.0 - done else share
        target = parameter if done + share >= 1.0 else start + (done + share) * span
        predicted = path.predict(point, target)
        if predicted is None:
            share *= 0.5
            if share >= stepping.smallest:
                continue
            predicted = path.fall_back(point, target)
        patience = stepping.patience if share > stepping.cautious else options.max_iterations
        solution = solve_within(path.objective(target), predicted, patience, options)
        effort.iterations += solution.iterations
        effort.unstable += solution.unstable_iterations
        if solution.status == SolveStatus.converged:
            point = path.next_point(point, target, solution)
            done += share
            share *= stepping.growth
            if target == parameter:
                return Arrival(point, solution, effort)
        else:
            share *= 0.5
            if share < stepping.smallest or options.out_of_time:
                return Arrival(point, solution.given_up(options), effort)

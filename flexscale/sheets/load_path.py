"""Load stepping: a sheet followed from one load factor to the next."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.sheets.sheet_problem import SheetProblem, SheetState
from flexscale.solve.continuation import Stepping, advance
from flexscale.solve.newton import Solution
from flexscale.solve.solver_options import SolverOptions
from flexscale.status import SolveStatus

_PROBE = 1e-6  # change of the factor for the tangent
#: Six halvings; a sheet that is near its equilibrium gets all the iterations that it needs.
_STEPPING = Stepping(smallest=1.0 / 64.0, cautious=1.0, growth=1.0, rest=1.5)


@dataclass(frozen=True)
class LoadStep:
    """An equilibrium on a load path, or how far it got.

    Attributes
    ----------
    factor : load factor.
    status : of the last solve; only `converged` states are equilibria.
    state : energy, rows, reactions.
    iterations : of Newton's method, those of cut steps included; each step has one factorization
        more, for the tangent it starts from.
    negative_eigenvalues : of the Hessian; an equilibrium that has some is unstable.
    """

    factor: float
    status: SolveStatus
    state: SheetState
    iterations: int
    negative_eigenvalues: int


def follow_loads(
    problem: SheetProblem,
    factors: Sequence[float],
    options: SolverOptions | None = None,
    z: FloatArray | None = None,
    reached: float = 0.0,
) -> list[LoadStep]:
    """Equilibria at increasing load factors; ends at the first that is not found.

    Each starts from the tangent of the one before. A step that Newton's method does not master is
    halved.

    Parameters
    ----------
    problem : sheet with its conditions; its factor ends at the last one reached.
    factors : increasing, from `reached` on.
    z : equilibrium to start from; rest without.
    reached : load factor of `z`.
    """
    options = options or SolverOptions()
    point, steps = _Reached(reached, problem.rest.copy() if z is None else z.copy()), []
    for factor in factors:
        arrival = advance(_Loading(problem), point, factor, options, _STEPPING)
        point, end = arrival.point, arrival.solution
        steps.append(
            LoadStep(
                point.parameter,
                end.status,
                end.evaluation,
                arrival.effort.iterations,
                end.negative_eigenvalues,
            )
        )
        if end.status != SolveStatus.converged:
            break
    return steps


@dataclass(frozen=True)
class _Reached:
    """An equilibrium on the path."""

    parameter: float
    z: FloatArray


@dataclass(frozen=True)
class _Loading:
    """The load factor of a sheet as a path of the continuation."""

    problem: SheetProblem

    def objective(self, factor: float) -> SheetProblem:
        self.problem.start(factor)
        return self.problem

    def predict(self, point: _Reached, factor: float) -> FloatArray:
        return _predict(self.problem, point.z, point.parameter, factor)

    def fall_back(self, point: _Reached, factor: float) -> FloatArray:
        return self.problem.start(factor, point.z)

    def next_point(self, before: _Reached | None, factor: float, solution: Solution) -> _Reached:
        return _Reached(factor, solution.z)


def _predict(problem: SheetProblem, z: FloatArray, here: float, goal: float) -> FloatArray:
    """State at a factor on the tangent of an equilibrium; the equilibrium moved without, where the
    tangent is not that of a stable one."""
    moved = problem.start(goal, z)
    if goal == here:
        return moved
    # H dz = -(d gradient / d factor): what is held moves, loads grow.
    probe = problem.evaluate(problem.start(here + _PROBE, z))
    base = problem.evaluate(problem.start(here, z))
    rate = (probe.gradient - base.gradient) / _PROBE
    tangent = None
    if np.isfinite(rate).all() and problem.system.factorize(problem.hessian_values(base)) == 0:
        tangent, _ = problem.system.solve(-rate)
    problem.start(goal)
    if tangent is None:
        return moved
    predicted = moved.copy()
    predicted[problem.active] += (goal - here) * tangent
    energies = [problem.evaluate(state).energy for state in (predicted, moved)]
    return predicted if energies[0] <= energies[1] else moved

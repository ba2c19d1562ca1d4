"""Load stepping: a sheet followed from one load factor to the next."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.sheets.sheet_problem import SheetProblem, SheetState
from flexscale.solve.newton import Solution, solve_equilibrium
from flexscale.solve.solver_options import SolverOptions
from flexscale.status import SolveStatus

log = logging.getLogger(__name__)

_PROBE = 1e-6  # change of the factor for the tangent
_MOST_CUTS = 6  # halvings of a step that Newton's method does not master


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
    current = problem.rest.copy() if z is None else z.copy()
    steps = []
    for factor in factors:
        step = _reach(problem, current, reached, factor, options)
        steps.append(step)
        if step.status != SolveStatus.converged:
            break
        current, reached = step.state.z, factor
    return steps


def _reach(
    problem: SheetProblem, z: FloatArray, reached: float, factor: float, options: SolverOptions
) -> LoadStep:
    """One step of the path, in as many parts as it takes."""
    iterations, length, here = 0, factor - reached, reached
    for cut in range(_MOST_CUTS + 1):
        while True:
            goal = factor if here + 1.5 * length > factor else here + length
            start = _predict(problem, z, here, goal)
            solution = solve_equilibrium(problem, start, options)
            iterations += solution.iterations
            if solution.status != SolveStatus.converged:
                break
            z, here = solution.z, goal
            if here == factor:
                return _step(factor, solution, iterations)
        if options.out_of_time:
            break
        length *= 0.5
        log.debug("load step to %g cut to %g after %d", factor, length, cut)
    return _step(here, solution.given_up(options), iterations)


def _step(factor: float, solution: Solution, iterations: int) -> LoadStep:
    return LoadStep(
        factor, solution.status, solution.evaluation, iterations, solution.negative_eigenvalues
    )


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

"""Newton's method with line search for an energy under the mean-offset constraint [Eqs. 8, 9].

Each iteration factorizes the Hessian as it is. Only if it has negative eigenvalues on the
constraint is it changed, for the search direction alone: contact is replaced by its positive part,
and modes that still curve downward are turned over (see `negative_modes`; the inertia tells how
many there are). Where these are too many or not to be found, all elements are replaced by their
positive parts, and damped on the diagonal until positive. A stationary point with negative
eigenvalues is a saddle: it is left along the mode whose eigenvalue is nearest to zero.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.mechanics.energy import ALL, CONTACT, NOTHING
from flexscale.solve.negative_modes import System, negative_modes
from flexscale.solve.solver_options import SolverOptions
from flexscale.status import SolveStatus

_BLOCKED = 0.5  # of a step, beyond which scales would meet, that is turned aside not shortened
NEAR = 1e-3  # Newton decrement, relative to the energy, from which on to go on is best
NEAR_SADDLE = 1e-6  # Newton decrement, relative to the energy, from which a saddle is left
MOST_MODES = 12  # that curve downward and are turned over one by one


class Objective(Protocol):
    """What Newton's method needs; vectors are over the active unknowns unless called full."""

    active: np.ndarray
    shift_mode: FloatArray
    energy_floor: float  # N mm; a Newton decrement below it is rounding

    @property
    def system(self) -> System:
        """Linear systems on the present pattern of nonzeros."""

    def evaluate(self, z: FloatArray) -> Any:
        """What is known at the full state z, with `energy`, N mm, and `gradient`; the energy is
        infinite where z is inadmissible."""

    def hessian_values(self, evaluation: Any, project: str = NOTHING) -> FloatArray:
        """Upper-triangle values at an evaluated state; a grown pattern replaces `system`."""

    def free_share(self, evaluation: Any, trial: Any) -> float:
        """Share of the straight way in the world from one state to another without contact."""

    def keep_apart(self, evaluation: Any, wanted: FloatArray) -> FloatArray | None:
        """State near a wanted one that can be reached, by the matrix factorized last."""


@dataclass(frozen=True)
class Solution:
    """An equilibrium, or how far it got.

    Attributes
    ----------
    z : full state.
    evaluation : at z.
    multiplier : N mm / mm, of the mean offset.
    status : `SolveStatus`.
    iterations : factorizations.
    residual_norm : Euclidean norm of the constrained gradient at z, N.
    negative_eigenvalues : of the unprojected Hessian on the constraint, at the last factorization.
    saddles_left : stationary points with negative eigenvalues that were met and left on the way.
    unstable_iterations : those at which the energy curved downward, and not by contact alone.
    decrement : Newton decrement before the last step, N mm.
    """

    z: FloatArray
    evaluation: Any
    multiplier: float
    status: SolveStatus
    iterations: int
    residual_norm: float
    negative_eigenvalues: int
    saddles_left: int = 0
    unstable_iterations: int = 0
    decrement: float = np.inf

    def given_up(self, options: SolverOptions) -> Solution:
        """The same, with the true reason where time is what ended the attempts to reach it."""
        return replace(self, status=SolveStatus.time_limit) if options.out_of_time else self


def solve_within(
    problem: Objective, z: FloatArray, patience: int, options: SolverOptions
) -> Solution:
    """As `solve_equilibrium`, given up after `patience` iterations unless it is near by then."""
    first = min(patience, options.max_iterations)
    solution = solve_equilibrium(problem, z, replace(options, max_iterations=first))
    more = options.max_iterations - first
    near = solution.decrement <= NEAR * abs(solution.evaluation.energy)
    if solution.status != SolveStatus.max_iterations or not near or more == 0:
        return solution
    rest = solve_equilibrium(problem, solution.z, replace(options, max_iterations=more))
    return replace(
        rest,
        iterations=solution.iterations + rest.iterations,
        saddles_left=solution.saddles_left + rest.saddles_left,
        unstable_iterations=solution.unstable_iterations + rest.unstable_iterations,
    )


def _make_feasible(problem: Objective, z: FloatArray) -> FloatArray:
    z = z.copy()
    c = problem.system.constraint
    z[problem.active] -= (c @ z[problem.active]) * problem.shift_mode
    return z


def solve_equilibrium(problem: Objective, z: FloatArray, options: SolverOptions) -> Solution:
    """Minimize the energy from the full state `z` under the mean-offset constraint."""
    z = _make_feasible(problem, z)
    active = problem.active
    evaluation = problem.evaluate(z)
    multiplier, negative, escapes, unstable = 0.0, 0, 0, 0
    decrement = np.inf

    def result(status: SolveStatus, iterations: int) -> Solution:
        constraint = problem.system.constraint
        residual = float(np.linalg.norm(evaluation.gradient - multiplier * constraint))
        counts = (iterations, residual, negative, escapes, unstable)
        return Solution(z, evaluation, multiplier, status, *counts, decrement)

    if not np.isfinite(evaluation.energy):
        return result(SolveStatus.infeasible_start, 0)
    for iteration in range(1, options.max_iterations + 1):
        offset = float(problem.system.constraint @ z[active])
        step, mu, negative, downward = _direction(problem, evaluation, -offset)
        unstable += downward > 0
        multiplier = -mu
        decrement = -float(evaluation.gradient @ step)
        scale = abs(evaluation.energy)
        small = decrement <= options.tolerance * scale + problem.energy_floor
        if decrement <= NEAR_SADDLE * scale and negative > 0 and escapes < 3:
            escapes += 1
            z, evaluation = _leave_saddle(problem, evaluation, z, scale)
            continue
        if options.out_of_time and not small:
            return result(SolveStatus.time_limit, iteration)
        length, trial, trial_evaluation = _search(
            problem, z, evaluation, step, decrement, settled=small
        )
        if length > 0.0:
            z, evaluation = trial, trial_evaluation
        if small:
            return result(SolveStatus.converged, iteration)
        if length == 0.0:
            stalled = decrement <= 1e-6 * scale
            return result(
                SolveStatus.stalled if stalled else SolveStatus.line_search_failed, iteration
            )
    return result(SolveStatus.max_iterations, options.max_iterations)


def _direction(
    problem: Objective, evaluation: Any, target: float
) -> tuple[FloatArray, float, int, int]:
    """A direction of descent, the change of the multiplier, and what the true Hessian is like.

    Returns
    -------
    step (n_active,), mu, negative eigenvalues of the true Hessian, and with the positive part of
    contact in its place.
    """
    values = problem.hessian_values(evaluation)
    system, gradient = problem.system, evaluation.gradient
    negative = downward = system.factorize(values)
    if negative > 0:
        projected = problem.hessian_values(evaluation, CONTACT)
        if not np.array_equal(projected, values):
            downward = system.factorize(projected)
    if 0 < downward <= MOST_MODES:
        step, mu = system.solve(-gradient, target)
        modes = negative_modes(system, downward)
        if len(modes) == downward:
            return modes.turn_over(step, gradient), mu, negative, downward
    if downward > 0:
        _factorize_positive(problem, evaluation)
    step, mu = system.solve(-gradient, target)
    return step, mu, negative, downward


def _factorize_positive(problem: Objective, evaluation: Any) -> None:
    values = problem.hessian_values(evaluation, ALL)
    damping = 0.0
    while problem.system.factorize(values, damping) > 0 and damping < 1e4:
        damping = max(1e-8, 10.0 * damping)


def _search(
    problem: Objective,
    z: FloatArray,
    evaluation: Any,
    step: FloatArray,
    decrement: float,
    settled: bool,
) -> tuple[float, FloatArray, Any]:
    """Halve the step until the energy falls enough; length 0 if it never does.

    Energies are sums that round at about 1e-13 of themselves; a settled state is judged no finer.
    """
    active, start = problem.active, evaluation.energy
    slack = (1e-9 if settled else 1e-12) * abs(start) + problem.energy_floor
    length = 1.0
    for _ in range(40):
        trial = z.copy()
        trial[active] += length * step
        found = problem.evaluate(trial)
        free = problem.free_share(evaluation, found) if np.isfinite(found.energy) else 0.0
        if free < _BLOCKED and length == 1.0:
            kept = problem.keep_apart(evaluation, trial)
            if kept is not None:
                found = problem.evaluate(kept)
                value = found.energy
                if np.isfinite(value) and value <= start - 1e-4 * decrement:
                    return length, kept, found
        if free < 1.0:
            length *= min(0.9, max(0.1, 0.9 * free))
            continue
        value = found.energy
        if np.isfinite(value) and value <= start - 1e-4 * length * decrement + slack:
            return length, trial, found
        length *= 0.5
    return 0.0, z, evaluation


def _leave_saddle(
    problem: Objective, evaluation: Any, z: FloatArray, scale: float
) -> tuple[FloatArray, Any]:
    """Step along the mode nearest below zero until the energy is lower than at the saddle."""
    problem.system.factorize(problem.hessian_values(evaluation))
    modes = negative_modes(problem.system, 1)
    if not len(modes):
        return z, evaluation
    mode = modes.directions[:, 0] / np.linalg.norm(modes.directions[:, 0])
    stiffness = float(modes.curvatures[0])
    length = np.sqrt(1e-4 * scale / -stiffness)
    best = (z, evaluation)
    for _ in range(12):
        for sign in (1.0, -1.0):
            trial = z.copy()
            trial[problem.active] += sign * length * mode
            found = problem.evaluate(trial)
            lower = found.energy < best[1].energy
            if lower and problem.free_share(evaluation, found) >= 1.0:
                best = (trial, found)
        if best[0] is not z:
            return best
        length *= 0.5
    return best

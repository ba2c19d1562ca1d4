"""Continuation in curvature: one direction, one side, from flat to the last curvature asked for.

Where strips of sheet buckle, several equilibria exist. Samples follow the path of a sheet that is
bent from flat in small steps: a step that takes Newton's method too long is halved, so that one
branch point is passed at a time. Wherever the energy curved downward on the way to a sample, the
sheet is also bent back from there to the sample before: energy and moment met on the way back tell
whether there is more than one branch.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.homogenize.bend_line import BendLine
from flexscale.homogenize.checkpoint import Checkpoint, load_finished
from flexscale.homogenize.problem import Bendable, Bent
from flexscale.homogenize.sample import Sample
from flexscale.solve.continuation import Effort, Stepping, advance
from flexscale.solve.newton import Solution, solve_equilibrium
from flexscale.solve.solver_options import SolverOptions
from flexscale.status import SolveStatus

_STEPPING = Stepping(smallest=1.0 / 256.0)
_EXCESS = 2.0  # reject a start with more than so many times the extrapolated energy
_TIGHT, _STIFFEN = 0.1, 8.0  # multiply the barrier where gaps fall below this share of d_hat
_URGENT = 0.01  # share of d_hat below which that cannot wait for the next sample


@dataclass
class _Point:
    """A converged state on the line, with what is known of the way on from there.

    rate and second_rate are dz/d|kappa| and its change since the state before, per |kappa|; energy
    density in N/mm, moment in N.
    """

    curvature: float
    z: FloatArray
    rate: FloatArray
    second_rate: FloatArray
    energy: float = 0.0
    moment: float = 0.0

    @property
    def parameter(self) -> float:
        """Where on the line it lies."""
        return self.curvature

    def allowed_energy(self, curvature: float) -> float:
        """Energy density that a good start at a curvature beyond this one does not exceed, N/mm.

        A multiple of what a quadratic law, or twice the present moment, lets expect there.
        """
        if self.curvature == 0.0:
            return np.inf
        quadratic = self.energy * (curvature / self.curvature) ** 2
        linear = self.energy + 2.0 * self.moment * (curvature - self.curvature)
        return _EXCESS * max(quadratic, linear)


def _point_of(sample: Sample) -> _Point:
    """Where a line goes on from a sample that a checkpoint kept."""
    return _Point(
        sample["curvature"],
        sample["state"],
        sample["rate"],
        sample["second_rate"],
        sample["energy_density"],
        sample["moment"],
    )


def follow_line(
    problem: Bendable,
    line: BendLine,
    options: SolverOptions,
    finished: Sequence[Sample] = (),
) -> Iterator[Sample]:
    """Yield the line's samples one after the other, those of `finished` left out.

    Each sample is predicted along dz/dkappa, or a parabola, from the one before. A step that fails
    is halved, and so is one that starts too far from equilibrium where scales touch already. A
    sample that cannot be reached keeps its status, and those behind it are `not_run`. Samples carry
    the state that the next one starts from, so a line taken up again goes on bit for bit.

    Yields
    ------
    dict with curvature [mm-1], status and, if converged, the numbers of a sweep's sample, `state`
    and `rate`.
    """
    point = _Point(0.0, problem.embedding.rest, np.zeros(0), np.zeros(0))
    status = SolveStatus.converged
    stiffness = problem.barrier_stiffness
    set_barrier(problem, None)
    for sample in finished:
        status = SolveStatus(sample["status"])
        if status == SolveStatus.converged:
            point = _point_of(sample)
            stiffness = sample.get("barrier_stiffness", 0.0)
            set_barrier(problem, sample)
    for curvature in line.curvatures[len(finished) :]:
        if status != SolveStatus.converged:
            yield {"curvature": curvature, "status": int(SolveStatus.not_run)}
            continue
        options = options.for_a_sample()
        problem.fit_room(point.z, line.bend(point.curvature))
        if not len(point.rate):
            point, solution = _start(problem, line)
        before, effort = point, Effort(0 if curvature > 0.0 else 1)
        if curvature > 0.0:
            path = _Bending(problem, line)
            for target in _stops(point.curvature, curvature, problem.largest_step):
                arrival = advance(path, point, target, options, _STEPPING)
                point, solution = arrival.point, arrival.solution
                if target < curvature:
                    _stiffen_if_tight(problem, solution)
                effort.iterations += arrival.effort.iterations
                effort.unstable += arrival.effort.unstable
                if solution.status != SolveStatus.converged:
                    break
        status = solution.status
        if status == SolveStatus.converged and passed_through(problem, solution):
            status = SolveStatus.infeasible_start
        sample = {
            "curvature": curvature,
            "status": int(status),
            "newton_iterations": effort.iterations,
        }
        if status == SolveStatus.converged:
            sample |= _measure(problem, line, curvature, solution)
            sample |= {"state": point.z, "rate": point.rate, "second_rate": point.second_rate}
            if effort.unstable and before.curvature > 0.0:
                _set_stiffness(problem, stiffness)
                # Whether the way back is found does not depend on how long the way here took.
                whole = options.for_a_sample()
                sample |= _bend_back(problem, line, point, before.curvature, whole)
        yield sample
        if status == SolveStatus.converged:
            stiffness = sample.get("barrier_stiffness", 0.0)
            set_barrier(problem, sample)


def _stops(start: float, end: float, largest: float) -> FloatArray:
    """Curvatures on the way from one to another, the last of them included, in even steps."""
    n = max(1, int(np.ceil((end - start) / largest - 1e-9)))
    stops: FloatArray = np.linspace(start, end, n + 1)[1:]
    return stops


@dataclass(frozen=True)
class _Bending:
    """A line as a path of the continuation, whose parameter is the curvature."""

    problem: Bendable
    line: BendLine

    def objective(self, curvature: float) -> Bent:
        return self.problem.bent(self.line.bend(curvature))

    def predict(self, point: _Point, curvature: float) -> FloatArray | None:
        return _predict(self.problem, self.line, point, curvature)

    def fall_back(self, point: _Point, curvature: float) -> FloatArray:
        return point.z

    def next_point(self, before: _Point | None, curvature: float, solution: Solution) -> _Point:
        return _next_point(self.problem, self.line, before, curvature, solution)


def load_line(problem: Bendable, line: BendLine, checkpoint: Checkpoint | None) -> list[Sample]:
    """Finished samples of a line from which `follow_line` can go on."""
    needed = {"energy_density", "moment", *line.measured}
    if problem.contact is not None:
        needed |= {"min_gap", "barrier_stiffness"}
    axis, size = ("curvature", line.curvatures), len(problem.embedding.rest)
    return cast(list[Sample], load_finished(checkpoint, line.key, axis, size, needed))


def set_barrier(problem: Bendable, sample: Mapping[str, Any] | None) -> None:
    """Stiffness of the barrier for the sample that follows `sample`; None at the start of a line.

    The distance that scales keep must stay well above rounding, however hard they press.
    """
    if problem.contact is None:
        return
    stiffness = problem.barrier_stiffness
    if sample is not None:
        tight = sample["min_gap"] < _TIGHT * problem.contact.activation_distance
        stiffness = sample["barrier_stiffness"] * (_STIFFEN if tight else 1.0)
    _set_stiffness(problem, stiffness)


def _stiffen_if_tight(problem: Bendable, solution: Solution) -> None:
    """The same on the way to a sample, which may be long, where gaps come close to rounding."""
    if problem.contact is None or solution.status != SolveStatus.converged:
        return
    tight = _URGENT * problem.contact.activation_distance
    if problem.contact.smallest_distance(solution.evaluation.world.y, tight) < tight:
        _set_stiffness(problem, _STIFFEN * problem.contact.stiffness)


def passed_through(problem: Bendable, solution: Solution) -> bool:
    """Whether scales are in one another, so that a solution is no state of theirs."""
    contact = problem.contact
    return contact is not None and contact.intersects(solution.evaluation.world.y)


def _set_stiffness(problem: Bendable, stiffness: float) -> None:
    if problem.contact is not None:
        problem.contact.stiffness = stiffness


def _start(problem: Bendable, line: BendLine) -> tuple[_Point, Solution]:
    """The flat state: an equilibrium by construction, so one factorization gives all there is."""
    cell = problem.bent(line.bend(0.0))
    state = cell.evaluate(problem.embedding.rest)
    negative = problem.system.factorize(cell.hessian_values(state))
    residual = float(np.linalg.norm(state.gradient))
    status = SolveStatus.converged
    solution = Solution(problem.embedding.rest, state, 0.0, status, 1, residual, negative)
    return _next_point(problem, line, None, 0.0, solution), solution


def _next_point(
    problem: Bendable, line: BendLine, before: _Point | None, curvature: float, solution: Solution
) -> _Point:
    rate = _rate(problem, line, curvature, solution)
    second = np.zeros_like(rate)
    if before is not None:
        second = (rate - before.rate) / (curvature - before.curvature)
    numbers = _energy_and_moment(problem, line, curvature, solution)
    return _Point(curvature, solution.z, rate, second, *numbers)


def _energy_and_moment(
    problem: Bendable, line: BendLine, curvature: float, solution: Solution
) -> tuple[float, float]:
    """Energy density, and its derivative by the magnitude of the curvature."""
    cell = problem.bent(line.bend(curvature))
    moment = line.sign * cell.moment(solution.evaluation)
    return solution.evaluation.energy / problem.area, moment


def _solve(
    problem: Bendable, line: BendLine, curvature: float, z: FloatArray, options: SolverOptions
) -> Solution:
    return solve_equilibrium(problem.bent(line.bend(curvature)), z, options)


def _rate(problem: Bendable, line: BendLine, curvature: float, solution: Solution) -> FloatArray:
    """dz/d|kappa| along the branch: one back-substitution."""
    cell = problem.bent(line.bend(curvature))
    if solution.negative_eigenvalues > 0:  # the last factorization was not of the true Hessian
        problem.system.factorize(cell.hessian_values(solution.evaluation))
    step, _ = problem.system.solve(-cell.gradient_rate(solution.evaluation))
    rate = np.zeros_like(solution.z)
    rate[problem.active] = line.sign * step
    return rate


def _bend_back(
    problem: Bendable, line: BendLine, point: _Point, curvature: float, options: SolverOptions
) -> Sample:
    """Energy density and moment at a smaller curvature, met from `point`; none if not reached."""
    predicted = _predict(problem, line, point, curvature)
    start = point.z if predicted is None else predicted
    solution = _solve(problem, line, curvature, start, options)
    if solution.status != SolveStatus.converged:
        return {}
    energy, moment = _energy_and_moment(problem, line, curvature, solution)
    return {"energy_density_returning": energy, "moment_returning": moment}


def _predict(problem: Bendable, line: BendLine, point: _Point, target: float) -> FloatArray | None:
    """The better start at `target` of those along dz/dkappa and along its parabola.

    Where scales would meet on the straight way to both, or both have so much energy that Newton may
    wander through buckled states, the one at which scales are kept apart; None if there is none.
    """
    span = target - point.curvature
    straight = point.z + span * point.rate
    best, lowest = None, point.allowed_energy(target)
    for z in (straight, straight + 0.5 * span**2 * point.second_rate):
        state = problem.bent(line.bend(target)).evaluate(z)
        energy = state.energy / problem.area
        if energy <= lowest and _is_free(problem, line, point, state):
            best, lowest = z, energy
    if best is None:
        apart = _keep_apart(problem, line, point, target, straight)
        if apart is not None:
            energy = problem.bent(line.bend(target)).evaluate(apart).energy
            return apart if np.isfinite(energy) else None
    return best


def _keep_apart(
    problem: Bendable, line: BendLine, point: _Point, target: float, wanted: FloatArray
) -> FloatArray | None:
    """As `keep_apart`, from a point on the line."""
    if problem.contact is None:
        return None
    cell = problem.bent(line.bend(point.curvature))
    state = cell.evaluate(point.z)
    if not cell.steady(state):
        return None
    return problem.bent(line.bend(target)).keep_apart(state, wanted)


def _is_free(problem: Bendable, line: BendLine, point: _Point, state: Any) -> bool:
    """Whether no scales meet on the straight way in the world from a point to a state."""
    if problem.contact is None:
        return True
    start = problem.embedding.world_map.place(point.z, line.bend(point.curvature)).y
    return problem.contact.free_share(start, state.world.y) >= 1.0


def _measure(problem: Bendable, line: BendLine, curvature: float, solution: Solution) -> Sample:
    """The numbers of a sample; the moment is the derivative by the magnitude of the curvature."""
    state = solution.evaluation
    energy_density, moment = _energy_and_moment(problem, line, curvature, solution)
    s = solution.z[-3:]
    numbers: Sample = {
        "energy_density": energy_density,
        "moment": moment,
        "stretch": np.array([1.0 + s[0], 1.0 + s[1], s[2]]),
        "residual_norm": solution.residual_norm,
        "mean_offset": float(problem.embedding.mean_offset @ solution.z),
        "negative_eigenvalues": solution.negative_eigenvalues,
        "saddles_left": solution.saddles_left,
    }
    if problem.contact is not None:
        y = state.world.y
        numbers["min_gap"] = problem.contact.smallest_distance(y, 2.0 * problem.gap)
        numbers["contact_pairs"] = problem.contact.active_pairs(y)
        numbers["contact_force"] = problem.contact.force(y)
        numbers["barrier_stiffness"] = problem.contact.stiffness
    named = zip(problem.part_names, state.parts, strict=True)
    parts = {f"energy_density_{name}": float(part) / problem.area for name, part in named}
    own = line.measure(problem.bent(line.bend(curvature)), state)
    return cast(Sample, {**numbers, **problem.facts_of(state), **own, **parts})

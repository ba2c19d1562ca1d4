"""A sheet of scales in the world of which a machine moves one unknown, and the path it takes.

The machine's load p is a length: the shortening of a strip, the indentation of a disc. It moves one
unknown by p to one side; the force that it feels is, at equilibrium, F = dE/dp.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from flexscale.arrays import BoolArray, FloatArray
from flexscale.finite.joint_sheet import FLAT, JointSheet
from flexscale.finite.sheet_scales import SheetScales
from flexscale.homogenize.bent_joints import BentJoints, JointState
from flexscale.homogenize.line import passed_through, set_barrier
from flexscale.homogenize.native_model import NativeModel
from flexscale.mechanics.energy import NOTHING
from flexscale.solve.continuation import Stepping, advance
from flexscale.solve.newton import Solution, solve_equilibrium
from flexscale.solve.solver_options import SolverOptions
from flexscale.status import SolveStatus

_STEPPING = Stepping(smallest=1.0 / 256.0)
_EXCESS = 2.0  # reject a start with more than so many times the extrapolated energy

#: Of a sample: what a `LoadPoint` keeps, in its order.
KEPT = ("load", "state", "rate", "second_rate", "energy", "force")


@dataclass(frozen=True)
class LoadPoint:
    """An equilibrium, and what is known of the way on from there.

    rate is dz/dp and second_rate its change by the way's measure since the point before; energy in
    N mm, force in N.
    """

    load: float
    z: FloatArray
    rate: FloatArray
    second_rate: FloatArray
    energy: float
    force: float

    @property
    def parameter(self) -> float:
        """Where on the path it lies."""
        return self.load

    def allowed_energy(self, load: float) -> float:
        """Energy that a good start at a load beyond this one does not exceed, N mm."""
        if self.load == 0.0:
            return np.inf
        quadratic = self.energy * (load / self.load) ** 2
        return _EXCESS * max(quadratic, self.energy + 2.0 * self.force * (load - self.load))


class DrivenSheet(JointSheet):
    """A sheet in the world, one unknown of which a machine moves.

    Parameters
    ----------
    sheet, native : as of a `JointSheet`.
    free : (n_unknowns,) those that are sought, and those that may be driven.

    Attributes
    ----------
    driven : the unknown that is moved.
    sign : +1 or -1, to which side.
    rooted : whether states grow with the root of the load, as those of a strip that buckles.
    """

    driven: int
    sign: float
    rooted = False

    def __init__(self, sheet: SheetScales, native: NativeModel, free: BoolArray) -> None:
        super().__init__(sheet, native, free, still=True)

    def drive(self, unknown: int, sign: float) -> None:
        """Choose what is moved, and to which side."""
        self.driven, self.sign = unknown, sign
        self.pinned = int(np.searchsorted(self.active, unknown))
        touched = (self.rows == self.pinned) | (self.columns == self.pinned)
        self.coupled = np.flatnonzero(touched)

    def moved(self, z: FloatArray, load: float) -> FloatArray:
        """z with the machine at a load, mm."""
        out = z.copy()
        out[self.driven] = self.sign * load
        return out

    def free_part(self, gradient: FloatArray) -> FloatArray:
        """The gradient by all unknowns but the machine's."""
        gradient[self.driven] = 0.0
        return gradient

    def factorize(self, values: FloatArray) -> int:
        """With the machine's unknown held."""
        self.hold(values)
        return self.system.factorize(values)

    def hold(self, values: FloatArray) -> None:
        """Make the machine's unknown a matter of its own in the Hessian's values."""
        values[self.coupled] = 0.0
        diagonal = self.system.diagonal
        values[diagonal[self.pinned]] = float(np.abs(values[diagonal]).mean())

    def force(self, state: JointState) -> float:
        """F = dE/dp, N."""
        return self.sign * float(state.forces[self.driven])


class Driven(BentJoints):
    """The sheet with its machine at rest somewhere: an `Objective`."""

    problem: DrivenSheet

    def __init__(self, problem: DrivenSheet) -> None:
        super().__init__(problem, FLAT)

    def evaluate(self, z: FloatArray) -> JointState:
        """Energy, and its gradient by what is free to move."""
        state = super().evaluate(z)
        gradient = state.gradient.copy()
        gradient[self.problem.pinned] = 0.0
        return replace(state, gradient=gradient)

    def hessian_values(self, state: JointState, project: str = NOTHING) -> FloatArray:
        """(nnz,) upper triangle; the machine's unknown stays where it is."""
        values = super().hessian_values(state, project)
        self.problem.hold(values)
        return values

    def rate(self, state: JointState) -> FloatArray:
        """(n_unknowns,) dz/dp at an equilibrium: one factorization."""
        problem = self.problem
        direction = np.zeros(problem.embedding.n_unknowns + 1)
        direction[problem.driven] = problem.sign
        push = -self.second_derivatives(state, direction)[problem.active]
        push[problem.pinned] = 0.0
        problem.system.factorize(self.hessian_values(state))
        rate = direction[:-1]
        rate[problem.active] += problem.system.solve(push)[0]
        return rate


@dataclass(frozen=True)
class _Way:
    """The machine's load as a path of the continuation."""

    sheet: DrivenSheet

    def objective(self, load: float) -> Driven:
        return Driven(self.sheet)

    def predict(self, point: LoadPoint, load: float) -> FloatArray | None:
        return _predict(self.sheet, point, load)

    def fall_back(self, point: LoadPoint, load: float) -> FloatArray:
        return self.sheet.moved(point.z, load)

    def next_point(self, before: LoadPoint | None, load: float, solution: Solution) -> LoadPoint:
        return next_point(self.sheet, before, load, solution)


def follow_loads(
    sheet: DrivenSheet,
    loads: Sequence[float],
    options: SolverOptions,
    finished: Sequence[dict[str, Any]] = (),
    start: FloatArray | None = None,
) -> Iterator[dict[str, Any]]:
    """Yield equilibria at one load after the other, those of `finished` left out.

    A step that fails is halved. A sample that cannot be reached keeps its status, and those behind
    it are `not_run`.

    Parameters
    ----------
    loads : mm, increasing from above 0.
    start : (n_unknowns,) near the first equilibrium that is sought, which has the load that it has;
        the flat sheet if not given.

    Yields
    ------
    dict with load [mm], status and, if converged, force [N], energy [N mm], counts, what contact is
    like, `state`, `rate` and `second_rate`.
    """
    point: LoadPoint | None = None
    status = SolveStatus.converged
    set_barrier(sheet, None)
    for sample in finished:
        status = SolveStatus(sample["status"])
        if status == SolveStatus.converged:
            point = LoadPoint(*(sample.get(name, 0) for name in KEPT))
            set_barrier(sheet, sample)
    for load in loads[len(finished) :]:
        sample = {"load": load, "status": int(SolveStatus.not_run)}
        if status == SolveStatus.converged:
            options = options.for_a_sample()
            point, solution, iterations = _reach(sheet, point, load, options, start)
            status = solution.status
            if status == SolveStatus.converged and passed_through(sheet, solution):
                status = SolveStatus.infeasible_start
            sample |= {"status": int(status), "newton_iterations": iterations}
        if status == SolveStatus.converged and point is not None:
            sample |= _measure(sheet, point, solution)
        yield sample
        if status == SolveStatus.converged:
            set_barrier(sheet, sample)


def _reach(
    sheet: DrivenSheet,
    point: LoadPoint | None,
    load: float,
    options: SolverOptions,
    start: FloatArray | None,
) -> tuple[LoadPoint | None, Solution, int]:
    """The point at a load, its solution, and iterations on the way to it."""
    spent = 0
    if point is None:
        z = sheet.moved(sheet.embedding.rest, 0.0) if start is None else start
        first = sheet.sign * float(z[sheet.driven])
        solution = solve_equilibrium(Driven(sheet), z, options)
        spent = solution.iterations
        if solution.status != SolveStatus.converged:
            return None, solution, spent
        point = next_point(sheet, None, first, solution)
        if first == load:
            return point, solution, spent
    arrival = advance(_Way(sheet), point, load, options, _STEPPING)
    return arrival.point, arrival.solution, spent + arrival.effort.iterations


def next_point(
    sheet: DrivenSheet, before: LoadPoint | None, load: float, solution: Solution
) -> LoadPoint:
    """The point of a solution."""
    state = solution.evaluation
    rate = Driven(sheet).rate(state)
    energy = float(state.parts.sum())
    second = np.zeros_like(rate)
    if sheet.rooted:  # by the root of the load, from the flat sheet or the point before
        slope = 2.0 * np.sqrt(load) * rate
        if before is None:
            second = 2.0 * (np.sqrt(load) * slope - (solution.z - sheet.embedding.rest)) / load
        else:
            past = 2.0 * np.sqrt(before.load) * before.rate
            second = (slope - past) / (np.sqrt(load) - np.sqrt(before.load))
    elif before is not None:
        second = (rate - before.rate) / (load - before.load)
    return LoadPoint(load, solution.z, rate, second, energy, sheet.force(state))


def _ahead(sheet: DrivenSheet, point: LoadPoint, load: float) -> list[FloatArray]:
    """Starts beyond a point, the best guess first."""
    span = load - point.load
    straight = point.z + span * point.rate
    if sheet.rooted:
        span = np.sqrt(load) - np.sqrt(point.load)
        curved = point.z + span * 2.0 * np.sqrt(point.load) * point.rate
    else:
        curved = straight
    return [curved + 0.5 * span**2 * point.second_rate, straight]


def _predict(sheet: DrivenSheet, point: LoadPoint, load: float) -> FloatArray | None:
    """The start of least energy at a load; None if scales would meet on the way to all of them and
    cannot be kept apart, or all are so far from equilibrium that a smaller step is faster."""
    driven = Driven(sheet)
    origin = driven.evaluate(point.z)
    best, lowest = None, point.allowed_energy(load)
    ahead = [sheet.moved(z, load) for z in _ahead(sheet, point, load)]
    for z in ahead:
        state = driven.evaluate(z)
        if state.energy <= lowest and driven.free_share(origin, state) >= 1.0:
            best, lowest = z, state.energy
    if best is not None or sheet.contact is None:
        return best
    apart = driven.keep_apart(origin, ahead[-1])
    if apart is not None and driven.evaluate(apart).energy <= lowest:
        return apart
    return None


def _measure(sheet: DrivenSheet, point: LoadPoint, solution: Solution) -> dict[str, Any]:
    """The numbers of a sample, and what the next one starts from."""
    state = solution.evaluation
    values = (point.load, point.z, point.rate, point.second_rate, point.energy, point.force)
    numbers: dict[str, Any] = dict(zip(KEPT, values, strict=True))
    numbers |= {
        "residual_norm": solution.residual_norm,
        "negative_eigenvalues": solution.negative_eigenvalues,
        "contact_pairs": 0,
        **sheet.facts_of(state),
    }
    if sheet.contact is not None:
        y = state.world.y
        numbers["contact_pairs"] = sheet.contact.active_pairs(y)
        numbers["min_gap"] = sheet.contact.smallest_distance(y, 2.0 * sheet.gap)
        numbers["contact_force"] = sheet.contact.force(y)
        numbers["barrier_stiffness"] = sheet.contact.stiffness
    return numbers

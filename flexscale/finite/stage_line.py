"""Continuation in the shortening of a native sheet between hinges, to one side.

The first sample starts from an arc. Deflections grow with the root t of the shortening, so samples
are followed in t: from one, along dz/d(shortening) or a parabola in t, to the next. Scales that
would meet on that way are kept apart.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.finite.native_stage import CarriedSheet, NativeStage
from flexscale.homogenize.line import set_barrier
from flexscale.sides import SIDE_SIGNS
from flexscale.solve.continuation import Stepping, advance
from flexscale.solve.newton import Solution, solve_equilibrium
from flexscale.solve.solver_options import SolverOptions
from flexscale.status import SolveStatus

_STEPPING = Stepping(smallest=1.0 / 64.0, patience=12)
_EXCESS = 2.0  # reject a start with more than so many times the extrapolated energy
_ARCS = 8  # times that the first shortening is quartered until scales are clear of one another

#: Of a sample: what a `_Point` keeps, in its order.
_POINT = ("shortening", "state", "rate", "second_rate", "energy", "force")


@dataclass
class _Point:
    """An equilibrium and what is known of the way on from there.

    rate is dz/d(shortening); second_rate the change of dz/dt per t since the point before, or since
    the flat sheet; energy in N mm, force in N.
    """

    shortening: float
    z: FloatArray
    rate: FloatArray
    second_rate: FloatArray
    energy: float
    force: float

    @property
    def parameter(self) -> float:
        """Where on the path it lies."""
        return self.shortening

    @property
    def root_rate(self) -> FloatArray:
        """dz/dt, t the root of the shortening."""
        return 2.0 * np.sqrt(self.shortening) * self.rate

    def allowed_energy(self, shortening: float) -> float:
        """Energy that a good start at a shortening beyond this one does not exceed, N mm."""
        return _EXCESS * (self.energy + 2.0 * self.force * (shortening - self.shortening))

    def ahead(self, shortening: float) -> list[FloatArray]:
        """Starts beyond this point, the best guess first."""
        straight = self.z + (shortening - self.shortening) * self.rate
        span = np.sqrt(shortening) - np.sqrt(self.shortening)
        return [self.z + span * self.root_rate + 0.5 * span**2 * self.second_rate, straight]


@dataclass(frozen=True)
class _Shortening:
    """The shortening of a strip as a path of the continuation."""

    stage: NativeStage

    def objective(self, shortening: float) -> CarriedSheet:
        return self.stage.carried(shortening, self.stage.hard)

    def predict(self, point: _Point, shortening: float) -> FloatArray | None:
        return _predict(self.stage, point, shortening)

    def fall_back(self, point: _Point, shortening: float) -> FloatArray:
        return self.stage.moved(point.z, shortening)

    def next_point(self, before: _Point | None, shortening: float, solution: Solution) -> _Point:
        return _next_point(self.stage, before, shortening, solution)


def follow_shortenings(
    stage: NativeStage,
    shortenings: Sequence[float],
    side: str,
    options: SolverOptions,
    finished: Sequence[dict[str, Any]] = (),
) -> Iterator[dict[str, Any]]:
    """Yield samples one after the other, those of `finished` left out.

    A step that fails is halved. A sample that cannot be reached keeps its status, and those behind
    it are `not_run`.

    Parameters
    ----------
    shortenings : mm, increasing from above 0.
    side : "closing" or "opening".

    Yields
    ------
    dict with shortening [mm], status and, if converged, force [N], energy [N mm], deflection [mm]
    to the outer side of the arc, counts, what contact is like, `state`, `rate` and `second_rate`.
    """
    sign = SIDE_SIGNS[side]
    point: _Point | None = None
    status = SolveStatus.converged
    set_barrier(stage, None)
    for sample in finished:
        status = SolveStatus(sample["status"])
        if status == SolveStatus.converged:
            point = _Point(*(sample.get(name, 0) for name in _POINT))
            set_barrier(stage, sample)
    for shortening in shortenings[len(finished) :]:
        sample = {"shortening": shortening, "status": int(SolveStatus.not_run)}
        if status == SolveStatus.converged:
            options = options.for_a_sample()
            point, solution, iterations = _reach(stage, point, shortening, sign, options)
            status = solution.status
            sample |= {"status": int(status), "newton_iterations": iterations}
        if status == SolveStatus.converged and point is not None:
            sample |= _measure(stage, point, solution, sign)
        yield sample
        if status == SolveStatus.converged:
            set_barrier(stage, sample)


def _reach(
    stage: NativeStage, point: _Point | None, shortening: float, sign: float, options: SolverOptions
) -> tuple[_Point | None, Solution, int]:
    """The point at a shortening, its solution, and iterations on the way to it."""
    spent = 0
    if point is None:
        first, z = _clear_arc(stage, shortening, sign)
        solution = solve_equilibrium(stage.carried(first, stage.hard), z, options)
        spent = solution.iterations
        if solution.status != SolveStatus.converged:
            return None, solution, spent
        point = _next_point(stage, None, first, solution)
        if first == shortening:
            return point, solution, spent
    arrival = advance(_Shortening(stage), point, shortening, options, _STEPPING)
    return arrival.point, arrival.solution, spent + arrival.effort.iterations


def _clear_arc(stage: NativeStage, shortening: float, sign: float) -> tuple[float, FloatArray]:
    """The asked shortening, or the first of its quarters at which no scales of an arc meet."""
    rate = stage.bend_rate()
    for _ in range(_ARCS):
        z = stage.arc(rate, shortening, sign)
        state = stage.carried(shortening, stage.hard).evaluate(z)
        clear = stage.contact is None or not stage.contact.active_pairs(state.world.y)
        if np.isfinite(state.energy) and clear and not _cut_through(stage, state.world.y):
            break
        shortening *= 0.25
    return shortening, z


def _cut_through(stage: NativeStage, y: FloatArray) -> bool:
    return stage.contact is not None and stage.contact.intersects(y)


def _next_point(
    stage: NativeStage, before: _Point | None, shortening: float, solution: Solution
) -> _Point:
    state = solution.evaluation
    rate = stage.carried(shortening, stage.hard).rate(state)
    energy = float(state.parts.sum())
    point = _Point(shortening, solution.z, rate, np.zeros_like(rate), energy, stage.force(state))
    root, slope = np.sqrt(shortening), point.root_rate
    if before is None:  # the parabola that starts flat
        moved = solution.z - stage.embedding.rest
        point.second_rate = 2.0 * (root * slope - moved) / shortening
    else:
        point.second_rate = (slope - before.root_rate) / (root - np.sqrt(before.shortening))
    return point


def _predict(stage: NativeStage, point: _Point, target: float) -> FloatArray | None:
    """The start of least energy at a target; None if scales would meet on the way to all of them
    and cannot be kept apart, or if all are so far from equilibrium that a smaller step is the
    faster way."""
    carried = stage.carried(target, stage.hard)
    here = stage.carried(point.shortening, stage.hard)
    origin = here.evaluate(point.z)
    best, lowest = None, point.allowed_energy(target)
    for start in point.ahead(target):
        state = carried.evaluate(stage.moved(start, target))
        free = carried.free_share(origin, state) >= 1.0
        if state.energy <= lowest and free:
            best, lowest = state.z, state.energy
    if best is not None or here.system.factorize(here.hessian_values(origin)) > 0:
        return best
    apart = carried.keep_apart(origin, stage.moved(point.ahead(target)[0], target))
    if apart is not None and carried.evaluate(apart).energy <= lowest:
        return apart
    return None


def _measure(stage: NativeStage, point: _Point, solution: Solution, sign: float) -> dict[str, Any]:
    """The numbers of a sample, and what the next one starts from."""
    state = solution.evaluation
    numbers: dict[str, Any] = {
        name: getattr(point, "z" if name == "state" else name) for name in _POINT
    }
    numbers |= {
        "deflection": -sign * stage.deflection(point.z),
        "residual_norm": solution.residual_norm,
        "negative_eigenvalues": solution.negative_eigenvalues,
    }
    numbers["contact_pairs"] = 0
    if stage.contact is not None:
        y = state.world.y
        numbers["contact_pairs"] = stage.contact.active_pairs(y)
        numbers["min_gap"] = stage.contact.smallest_distance(y, 2.0 * stage.model.gap)
        numbers["contact_force"] = stage.contact.force(y)
        numbers["barrier_stiffness"] = stage.contact.stiffness
    for name, part in zip(stage.part_names, state.parts, strict=True):
        numbers[f"energy_{name}"] = float(part)
    return numbers

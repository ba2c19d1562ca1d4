"""Equilibria of a section from pose to pose, by Newton's method along ways of small steps."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.joints.section import Section, State

_TOLERANCE = 1e-10  # Newton decrement, relative to the energy, before the last step
_MOST_ITERATIONS = 40
_PATIENCE = 14  # iterations after which a step that can be halved is given up
_SMALLEST = 1.0 / 64.0  # share of a step between two poses, below which they are given up
_FIRST_DAMPING, _LAST_DAMPING = 1e-4, 1e3  # in means of the diagonal


@dataclass(frozen=True)
class SectionState:
    """An equilibrium of a section.

    Attributes
    ----------
    pose : (4,) q = (u, w, s) in thicknesses, and phi.
    energy : W, E t^2.
    forces : (4,) dW/dq in E t, and E t^2 for phi.
    tangent : (4, 4) d2W/dq2 in the same units per unit of q.
    places : (3 n_nodes,) of all nodes.
    rates : (3 n_nodes, 4) of the places by the pose.
    """

    pose: FloatArray
    energy: float
    forces: FloatArray
    tangent: FloatArray
    places: FloatArray
    rates: FloatArray


def rest_state(section: Section) -> SectionState:
    """The section at rest."""
    return _state(section, section.evaluate(section.rest()), np.zeros(4))


def follow(
    section: Section, start: SectionState, poses: Iterable[FloatArray]
) -> Iterator[SectionState]:
    """States at poses (4,), one after another; it ends early where one cannot be reached."""
    for pose in poses:
        reached = _step(section, start, np.asarray(pose, dtype=float))
        if reached is None:
            return
        yield (start := reached)


def _step(section: Section, start: SectionState, pose: FloatArray) -> SectionState | None:
    done, share, begin = 0.0, 1.0, start.pose
    while done < 1.0:
        share = min(share, 1.0 - done)
        target = begin + (done + share) * (pose - begin)
        places = section.put(start.places + start.rates @ (target - start.pose), target)
        patience = _PATIENCE if share > _SMALLEST else _MOST_ITERATIONS
        found = _equilibrium(section, places, patience)
        if found is None:
            share *= 0.5
            if share < _SMALLEST:
                return None
            continue
        start = _state(section, found, target)
        done += share
        share *= 2.0
    return start


def _state(section: Section, state: State, pose: FloatArray) -> SectionState:
    forces, tangent, rates = section.response(state, pose)
    return SectionState(pose, state.energy, forces, tangent, state.y[:-1].ravel(), rates)


def _equilibrium(section: Section, places: FloatArray, patience: int) -> State | None:
    """Least energy near places whose held nodes stay; None if it is not found, or not stable."""
    state = section.evaluate(places)
    if not np.isfinite(state.energy):
        return None
    damping = 0.0
    for _ in range(patience):
        values, was_damped = section.hessian_values(state), damping
        damping = 0.0 if damping <= _FIRST_DAMPING else 0.1 * damping
        while section.system.factorize(values, damping) > 0:
            damping = max(_FIRST_DAMPING, 10.0 * damping, was_damped)
            if damping > _LAST_DAMPING:
                return None
        step, _ = section.system.solve(-state.gradient)
        decrement = -float(state.gradient @ step)
        settled = damping == 0.0 and decrement <= _TOLERANCE * state.energy
        found = _search(section, state, step, decrement)
        if settled:
            return found or state
        if found is None:
            return None
        state = found
    return None


def _search(section: Section, state: State, step: FloatArray, decrement: float) -> State | None:
    """State at the longest of halved steps at which the energy falls enough."""
    length, places = 1.0, state.y[:-1].ravel()
    slack = 1e-13 * state.energy
    for _ in range(20):
        trial = places.copy()
        trial[section.active] += length * step
        found = section.evaluate(trial)
        if found.energy <= state.energy - 1e-4 * length * decrement + slack:
            return found
        length *= 0.5
    return None

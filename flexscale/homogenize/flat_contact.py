"""Contact of a cell that is bent from flat, to first order: gaps that close, and what holds them.

Distances between scales, here gaps, are linear in the curvature k = (kappa_xx, kappa_yy, 2
kappa_xy) and in the pressures p that hold them open,

    g(k, p) = g + G k + S p >= 0,   p >= 0,   p . g(k, p) = 0,

with G the slopes of the gaps of a cell that is free of forces, S = A J^T H^-1 J from the Hessian H
of the flat cell of area A and the gaps' derivatives J; a pressure is a force between scales over A.
By the energy density that this adds to 1/2 k C k,

    W(k) = max over p >= 0 of  -p . (g + G k) - 1/2 p . S p,

onset and stiffness of contact follow for bending in any direction, to either side, and in two
directions at a time. What is neglected is of second order: gaps that turn as they close.

Of the thousands of distances between primitives, those are taken that are needed to keep all others
open at sample curvatures: one after the other, where scales would overlap most. Where these leave
scales apart, as wide gaps, low scales and the opening side do, more follow at the curvatures at
which scales meet there, up to a ring of two tiles, which no sheet can pass.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass

import numpy as np

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.bends import Bend
from flexscale.homogenize.problem import Contact, FlatBends, Problem
from flexscale.mechanics.contact_gaps import LinearGaps
from flexscale.solve.unilateral import unilateral_forces
from flexscale.units import require_positive

log = logging.getLogger(__name__)

REACH = 1.5  # gaps, in which distances at rest are looked at
OVERLAP = 0.02  # of a gap, by which scales may still overlap at the sample curvatures
MOST = 400  # distances that are taken
_MAGNITUDES = (0.01, 0.03)  # mm-1
_BEYOND = (1.5, 3.0)  # onsets, where scales meet beyond these magnitudes only
_TURNS = 12  # directions of principal curvatures, over 180 degree
_RATIOS = 8  # of the two principal curvatures, around the circle
_STEP = 1e-5  # of the unknowns' rates; what is of third order in it is below rounding


@dataclass(frozen=True)
class FlatContact:
    """Gaps of the flat cell.

    Attributes
    ----------
    distances : (n,) g, mm.
    slopes : (n, 3) G, mm2, by kappa_xx, kappa_yy and 2 kappa_xy in mm-1.
    compliance : (n, n) S, mm3 N-1.
    """

    distances: FloatArray
    slopes: FloatArray
    compliance: FloatArray

    def __len__(self) -> int:
        return len(self.distances)

    def pressures(self, curvature: FloatArray) -> FloatArray:
        """(n,) p that hold the gaps open at k = (kappa_xx, kappa_yy, 2 kappa_xy), N mm-2."""
        active, found = np.empty(len(self), dtype=np.int64), np.empty(len(self))
        missing = -(self.distances + self.slopes @ np.asarray(curvature, dtype=float))
        n = unilateral_forces(self.compliance, missing, active, found)
        out = np.zeros(len(self))
        out[active[:n]] = found[:n]
        return out

    def onset(self, curvature: FloatArray) -> FloatArray:
        """(...) by how much curvatures k (..., 3) may be multiplied until scales meet; or inf.

        Of first order: gaps turn as they close, which this leaves out.
        """
        closing = -np.asarray(curvature, dtype=float) @ self.slopes.T
        with np.errstate(divide="ignore"):
            reached = np.where(closing > 0.0, self.distances / closing, np.inf)
        out: FloatArray = reached.min(axis=-1, initial=np.inf)
        return out


def solve_flat_contact(problem: Problem, overlap: float = OVERLAP) -> FlatContact:
    """Gaps of a cell problem with contact; the system is left factorized at rest.

    Parameters
    ----------
    overlap : of a gap, by which scales may still overlap at the sample curvatures.

    Raises
    ------
    UnitRangeError : overlap not above 0.
    """
    overlap = require_positive(overlap, "overlap", "of a gap")
    if problem.contact is None:
        return FlatContact(np.zeros(0), np.zeros((0, 3)), np.zeros((0, 0)))
    return _Search(problem, problem.contact, overlap * problem.gap).run()


class _Search:
    """Distances taken so far, and all others at the sample curvatures."""

    def __init__(self, problem: Problem, contact: Contact, overlap: float) -> None:
        self.problem, self.contact, self.overlap = problem, contact, overlap
        self.bends: FlatBends = problem.flat_bends()
        self.gaps: LinearGaps = contact.gaps(self.bends.state.world.y, REACH * problem.widest_gap)
        slopes = [
            self._changes(rate) + self._changes(self._push(relaxed))
            for rate, relaxed in zip(self.bends.rates, self.bends.relaxed, strict=True)
        ]
        self.slopes = np.stack(slopes, axis=1) if len(self.gaps) else np.zeros((0, 3))
        self.taken = np.zeros(0, dtype=np.int64)
        #: Changes of all distances by the pressures on those taken.
        self.answers = np.zeros((len(self.gaps), 0))

    def run(self) -> FlatContact:
        samples = sample_curvatures()
        self._keep_open(samples)
        self._keep_open(self._beyond(samples[-_RATIOS * _TURNS :]))
        if len(self.taken) >= MOST:
            log.warning("Contact of the flat cell keeps %d gaps and would need more.", MOST)
        return self._contact()

    def _keep_open(self, samples: FloatArray) -> None:
        """Take distances until no other one closes at curvatures (n, 3)."""
        while len(samples) and len(self.gaps) and len(self.taken) < MOST:
            found = self._contact()
            pressures = np.array([found.pressures(k) for k in samples]).reshape(len(samples), -1)
            left = self.gaps.distances + samples @ self.slopes.T + pressures @ self.answers.T
            left[:, self.taken] = np.inf  # open but for rounding
            if left.min() >= -self.overlap:
                break
            self._take(self._worst(left))

    def _beyond(self, largest: FloatArray) -> FloatArray:
        """(m, 3) curvatures beyond the largest samples (n, 3) that leave scales apart."""
        every = FlatContact(self.gaps.distances, self.slopes, np.zeros((0, 0)))
        onset = every.onset(largest)
        tile = np.sqrt(self.problem.area / self.problem.n_scales)
        apart = (self._contact().onset(largest) > 1.0) & (onset * _MAGNITUDES[-1] < np.pi / tile)
        at_onset = onset[apart, None] * largest[apart]
        return np.concatenate([factor * at_onset for factor in _BEYOND])

    def _worst(self, left: FloatArray) -> IntArray:
        """Of each pair of scales the distance that falls short the most, where it does so most."""
        sample, gap = left.argmin(axis=1), left.min(axis=1)
        short = np.flatnonzero(gap < 0.5 * min(gap.min(), -self.overlap))
        gaps, order = sample[short], np.argsort(gap[short], kind="stable")
        pairs = self.gaps.bodies[gaps][order]
        found: IntArray = gaps[order][np.unique(pairs, return_index=True)[1]]
        return found

    def _take(self, new: IntArray) -> None:
        world_map = self.problem.embedding.world_map
        world, active = self.bends.state.world, self.problem.active
        for entry in new:
            on_rows = self.contact.spread(self.gaps.forces(entry), len(world.y))
            slope = world_map.pull_gradient(world, on_rows)[active]
            answer = self.problem.area * self.problem.system.solve(slope)[0]
            column = self._changes(self._push(answer))
            self.answers = np.column_stack([self.answers, column])
        self.taken = np.concatenate([self.taken, new])

    def _contact(self) -> FlatContact:
        compliance = self.answers[self.taken]
        even = 0.5 * (compliance + compliance.T)
        return FlatContact(self.gaps.distances[self.taken], self.slopes[self.taken], even)

    def _push(self, rate: FloatArray) -> FloatArray:
        """(n_rows, 3) rates of the world vectors for rates (n_active,) of the unknowns."""
        world_map, rest = self.problem.embedding.world_map, self.problem.embedding.rest
        size = float(np.abs(rate).max())
        if size == 0.0:
            return np.zeros_like(self.bends.state.world.y)
        step = np.zeros_like(rest)
        step[self.problem.active] = _STEP / size * rate
        flat = Bend(0.0, 0.0)
        both = [world_map.place(rest + sign * step, flat).y for sign in (1.0, -1.0)]
        found: FloatArray = (both[0] - both[1]) * (0.5 * size / _STEP)
        return found

    def _changes(self, rate: FloatArray) -> FloatArray:
        """(n,) rates of all distances for rates (n_rows, 3) of the world vectors."""
        return self.gaps.at(self.contact.positions(rate))


def sample_curvatures() -> FloatArray:
    """(n, 3) k = (kappa_xx, kappa_yy, 2 kappa_xy) in mm-1: single and double, to both sides."""
    ratios = 2.0 * np.pi * np.arange(_RATIOS) / _RATIOS
    turns = np.pi * np.arange(_TURNS) / _TURNS
    psi, theta = np.meshgrid(ratios, turns, indexing="ij")
    mean = 0.5 * (np.cos(psi) + np.sin(psi))
    apart = 0.5 * (np.cos(psi) - np.sin(psi))
    c, s = np.cos(2.0 * theta), np.sin(2.0 * theta)
    k = np.stack([mean + apart * c, mean - apart * c, 2.0 * apart * s], axis=-1).reshape(-1, 3)
    return np.concatenate([size * k for size in _MAGNITUDES])

"""States of scales on joints at which those that would meet keep apart, however many there are.

As `keep_apart`, of the states near one at which scales overlap the one nearest in energy, but
without a full matrix between gaps: with a stiff spring K in each gap that is shorter than its goal,

    minimize  1/2 (z - w).H (z - w) + K/2 sum of (goal - g(z))+^2

by Newton's method, whose matrices have the pattern of H. Goals follow the forces K (goal - g) to
the distances at which the barrier has them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import scipy.sparse as sp

from flexscale.arrays import BoolArray, FloatArray, IntArray
from flexscale.embedding.curvature_map import Bend, TensorBend
from flexscale.embedding.pair_kernels import add_springs, gap_rates, gap_slopes

if TYPE_CHECKING:
    from flexscale.homogenize.joint_problem import JointProblem

_PASSES = 6  # in which gaps are measured anew where scales met on the way
_ROUNDS = 4  # in which gaps are measured anew, and goals balanced with the forces found
_STEPS = 20  # of Newton's method in each
_SHARE = 0.5  # of the distance at which the barrier acts, first held
_HARD = 100.0  # K, in the barrier's spring there
_MET = 4.0  # d_hat, closer than which gaps are measured where scales met


def keep_many_apart(
    problem: JointProblem, start: FloatArray, wanted: FloatArray, bend: Bend | TensorBend
) -> FloatArray | None:
    """State near a wanted one under `bend`, to which no scales meet on the way.

    Parameters
    ----------
    problem : its system was last factorized with the Hessian to be used.
    start : (n_rows, 3) positions without overlap, where the way begins.
    wanted : (n_unknowns,) state under `bend` at which scales may overlap.

    Returns
    -------
    (n_unknowns,), or None where none was found.
    """
    return None if problem.contact is None else _Search(problem, start, wanted, bend).run()


class _Search:
    """Gaps within reach, linear in positions, and their goals."""

    def __init__(
        self,
        problem: JointProblem,
        start: FloatArray,
        wanted: FloatArray,
        bend: Bend | TensorBend,
    ) -> None:
        assert problem.contact is not None
        self.problem, self.contact = problem, problem.contact
        self.start, self.wanted, self.bend = start, wanted, bend
        n = len(problem.active)
        self.values = problem.system.values.copy()
        upper = sp.coo_array((self.values, (problem.rows, problem.columns)), shape=(n, n)).tocsr()
        self.hessian = upper + sp.triu(upper, 1).T
        reach = self.contact.activation_distance
        self.hard = _HARD * float(self.contact.push(np.array([_SHARE * reach]))[1][0])
        self.found = np.zeros(0, dtype=np.int64)
        self.shares, self.normals = np.zeros((0, 4)), np.zeros((0, 3))
        self.starts, self.goals, self.forces = np.zeros(0), np.zeros(0), np.zeros(0)
        self.pairs = np.zeros(0, dtype=np.int64)
        self._measure(start, problem.gap, at_start=True)
        self._move(wanted)

    def _measure(self, y: FloatArray, reach: float, at_start: bool) -> None:
        found, shares, _ = self.contact.closer(y, reach)
        stencils = self.contact.rows.table.stencils[found]
        arrows = np.einsum("nk,nkc->nc", shares, y[stencils])
        distances = np.linalg.norm(arrows, axis=1)
        d_hat = self.contact.activation_distance
        starts = np.minimum(distances, d_hat) if at_start else np.full(len(found), d_hat)
        self.found = np.concatenate([self.found, found])
        self.shares = np.concatenate([self.shares, shares])
        self.normals = np.concatenate([self.normals, arrows / distances[:, None]])
        self.starts = np.concatenate([self.starts, starts])
        self.goals = np.concatenate([self.goals, _SHARE * starts])
        self.forces = np.concatenate([self.forces, np.zeros(len(found))])
        self.pairs = np.concatenate([self.pairs, self.contact.rows.pair[stencils[:, 0]]])

    def run(self) -> FloatArray | None:
        share = 0.0
        for _ in range(_PASSES):
            for k in range(_ROUNDS):
                near = np.flatnonzero(self._gaps() < self.contact.activation_distance)
                if not len(near):
                    break
                if k > 1:
                    self._balance(near)
                self._settle(near)
            share = self.contact.free_share(self.start, self.world.y)
            if share >= 1.0:
                break
            met = self.start + share * (self.world.y - self.start)
            self._measure(met, _MET * self.contact.activation_distance, at_start=False)
        self.problem.system.factorize(self.values)
        return self.z if share >= 1.0 else None

    def _move(self, z: FloatArray) -> None:
        self.z = z
        self.world = self.problem.embedding.place(z, self.bend)

    def _settle(self, near: IntArray) -> None:
        """The state of least energy with springs in those gaps near the goal, linear in the state.

        Newton's method on a convex function of pieces of parabolas, each step of which goes to the
        minimum on its way.
        """
        problem, active = self.problem, self.problem.active
        cell, table = problem.embedding, self.contact.rows.table
        pairs, of_pair = cell.pairs(self.bend), self.pairs[near]
        slopes = gap_slopes(
            self.world.bending, pairs, self.world.poses, table, self.found[near],
            self.shares[near], self.normals[near],
        )  # fmt: skip
        short = self.goals[near] - self._gaps()[near]
        z = self.z.copy()
        for _ in range(_STEPS):
            acts: BoolArray = short > 0.0
            values, pull = self.values.copy(), np.zeros(cell.n_unknowns + 1)
            add_springs(
                slopes[acts], of_pair[acts], pairs, self.hard, short[acts], problem.slots, values,
                pull,
            )  # fmt: skip
            problem.system.factorize(values)
            away = self.hessian @ (z[active] - self.wanted[active])
            change = np.zeros(cell.n_unknowns + 1)
            change[active], _ = problem.system.solve(pull[active] - away)
            closing = -gap_rates(slopes, of_pair, pairs, change)
            bend = float(change[active] @ (self.hessian @ change[active]))
            length = _least(float(away @ change[active]), bend, short, closing, self.hard)
            z += length * change[:-1]
            short = short + length * closing
            if np.array_equal(short > 0.0, acts) and length > 0.999:
                break
        self._move(z)
        self.forces = np.zeros(len(self.found))
        self.forces[near] = self.hard * np.maximum(short, 0.0)

    def _gaps(self) -> FloatArray:
        """(n,) distances now, negative where scales overlap, mm."""
        corners = self.world.y[self.contact.rows.table.stencils[self.found]]
        gaps: FloatArray = np.einsum("nc,nk,nkc->n", self.normals, self.shares, corners)
        return gaps

    def _balance(self, near: IntArray) -> None:
        """Hold gaps at distances at which the barrier has the forces that springs have.

        The Hessian has the springs of gaps that were closed at the start.
        """
        push, spring = self.contact.push(self.starts[near])
        force = push + spring * (self.starts[near] - self._gaps()[near]) + self.forces[near]
        self.goals[near] = self.contact.distance_at(np.maximum(force, 0.0))


def _least(slope: float, bend: float, short: FloatArray, rate: FloatArray, hard: float) -> float:
    """s >= 0 of the least slope s + bend s^2 / 2 + hard / 2 sum of (short + rate s)+^2."""
    acts = short > 0.0
    changing = np.flatnonzero(acts == (rate < 0.0))  # some time ahead
    changing = changing[rate[changing] != 0.0]
    kinks = -short[changing] / rate[changing]
    order = np.argsort(kinks)
    changing, kinks = changing[order], kinks[order]
    signs = np.where(acts[changing], -hard, hard)
    first = slope + hard * float(short[acts] @ rate[acts])
    second = bend + hard * float(rate[acts] @ rate[acts])
    a = first + np.concatenate([[0.0], np.cumsum(signs * short[changing] * rate[changing])])
    b = second + np.concatenate([[0.0], np.cumsum(signs * rate[changing] ** 2)])
    rising = np.flatnonzero(np.append(a[:-1] + b[:-1] * kinks >= 0.0, True))
    k = int(rising[0])
    return max(-float(a[k]) / float(b[k]), 0.0)

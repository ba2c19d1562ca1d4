"""States of scales on joints at which those that would meet keep apart, however many there are.

From a state at which scales overlap, Newton's method goes to the equilibrium of the joints with a
softer barrier: of distances that are linear in positions, which may be negative, and with the
parabola that touches the barrier at a share of its reach below that. No matrix is full, and that of
each step has the pattern of the Hessian. It starts where scales would meet between two equilibria,
and goes almost to the next one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.bends import Bend, TensorBend
from flexscale.embedding.pair_kernels import LIFT_ALL, add_springs
from flexscale.embedding.pair_rates import gap_slopes
from flexscale.mechanics.barrier import soft_barrier

if TYPE_CHECKING:
    from flexscale.homogenize.joint_problem import JointProblem

_PASSES = 4  # in which gaps are measured anew where scales met on the way
_SOFT = (0.5, 0.15)  # of the barrier's reach, below which it is a parabola: one after the other
_STEPS = 20  # of Newton's method in each
_ENOUGH = 1e-4  # decrement over energy
_SHORTEST = 1e-3  # share of a step
_MET = 4.0  # d_hat, closer than which gaps are measured where scales met


def keep_many_apart(
    problem: JointProblem, start: FloatArray, wanted: FloatArray, bend: Bend | TensorBend
) -> FloatArray | None:
    """State near a wanted one under `bend`, to which no scales meet on the way.

    Parameters
    ----------
    problem : its system is left factorized with another matrix.
    start : (n_rows, 3) positions without overlap, where the way begins.
    wanted : (n_unknowns,) state under `bend` at which scales may overlap.

    Returns
    -------
    (n_unknowns,), or None where none was found.
    """
    if problem.contact is None:
        return None
    search = _Search(problem, start, bend)
    z = wanted
    for _ in range(_PASSES):
        for soft in _SOFT:
            z = search.settle(z, soft * problem.contact.activation_distance)
        y = problem.embedding.place(z, bend).y
        share = problem.contact.free_share(start, y)
        if share >= 1.0:
            return z
        search.measure(start + share * (y - start), _MET * problem.contact.activation_distance)
    return None


class _Softened(NamedTuple):
    """Energy [N mm], gradient (n_unknowns,) and upper triangle (nnz,) of the Hessian."""

    energy: float
    gradient: FloatArray
    values: FloatArray


class _Search:
    """Gaps within reach, linear in positions."""

    def __init__(self, problem: JointProblem, start: FloatArray, bend: Bend | TensorBend) -> None:
        assert problem.contact is not None
        self.problem, self.contact, self.bend = problem, problem.contact, bend
        self.found = np.zeros(0, dtype=np.int64)
        self.shares, self.normals = np.zeros((0, 4)), np.zeros((0, 3))
        self.measure(start, problem.gap)

    def measure(self, y: FloatArray, reach: float) -> None:
        """Add the gaps that are closer than a reach, mm, at positions y."""
        found, shares, _ = self.contact.closer(y, reach)
        arrows = np.einsum("nk,nkc->nc", shares, y[self.contact.rows.table.stencils[found]])
        self.found = np.concatenate([self.found, found])
        self.shares = np.concatenate([self.shares, shares])
        self.normals = np.concatenate(
            [self.normals, arrows / np.linalg.norm(arrows, axis=1)[:, None]]
        )

    def settle(self, z: FloatArray, soft: float) -> FloatArray:
        """Near the equilibrium with the barrier soft below a distance, mm."""
        here = self._evaluate(z, soft)
        for _ in range(_STEPS):
            if self.problem.factorize(here.values) > 0:
                self.problem.factorize(self._evaluate(z, soft, LIFT_ALL).values)
            gradient = here.gradient[self.problem.active]
            step, _ = self.problem.system.solve(-gradient)
            decrement, length = -float(gradient @ step), 1.0
            while length > _SHORTEST:
                trial = z.copy()
                trial[self.problem.active] += length * step
                there = self._evaluate(trial, soft)
                if there.energy <= here.energy - 1e-4 * length * decrement:
                    z, here = trial, there
                    break
                length *= 0.5
            if decrement <= _ENOUGH * abs(here.energy) or length <= _SHORTEST:
                break
        return z

    def _evaluate(self, z: FloatArray, soft: float, lift: int = 0) -> _Softened:
        """Joints, and the barrier that is soft below a distance, mm."""
        problem = self.problem
        world, pairs = problem.embedding.place(z, self.bend), problem.embedding.pairs(self.bend)
        near, gaps = self._near(world.y)
        barrier, push, spring = soft_barrier(
            gaps, self.contact.activation_distance, soft, self.contact.stiffness
        )
        gradient = np.zeros(problem.embedding.n_unknowns + 1)
        values = np.zeros(len(problem.rows))
        energy = problem.joint_energy(world, self.bend, gradient, values, lift)
        table = self.contact.rows.table
        slopes = gap_slopes(
            world.bending, pairs, world.poses, table, self.found[near], self.shares[near],
            self.normals[near],
        )  # fmt: skip
        of_pair = self.contact.rows.pair[table.stencils[self.found[near], 0]]
        add_springs(slopes, of_pair, pairs, spring, -push, problem.slots, values, gradient)
        return _Softened(energy + float(barrier.sum()), problem.free_part(gradient[:-1]), values)

    def _near(self, y: FloatArray) -> tuple[IntArray, FloatArray]:
        """Gaps that the barrier reaches at positions y, and their lengths, mm."""
        corners = y[self.contact.rows.table.stencils[self.found]]
        gaps = np.einsum("nc,nk,nkc->n", self.normals, self.shares, corners)
        near = np.flatnonzero(gaps < self.contact.activation_distance)
        return near, gaps[near]

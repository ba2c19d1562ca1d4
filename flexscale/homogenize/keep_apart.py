"""States at which scales that would meet keep apart.

Of the states near one at which scales overlap, the one sought is nearest in energy: with a Hessian
H and gaps g + J dz linear in the state, it minimizes 1/2 dz.H dz under g + J dz >= goal. Then
dz = H^-1 J^T f, and the forces f >= 0 between scales are those of a problem of non-negative least
squares, small since few pairs of scales meet at a time. At the end, goals are where the barrier has
these forces, so that Newton's method finds contact in balance. It starts there where scales would
meet between two equilibria, and goes there where they would meet early in a step.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.optimize import nnls

from flexscale.arrays import FloatArray, IntArray
from flexscale.embedding.bends import Bend, TensorBend

if TYPE_CHECKING:
    from flexscale.homogenize.problem import Bendable, Contact

_ROUNDS = 8  # in which pairs of scales that still overlap join
_PASSES = 6  # in which gaps are measured anew where scales met on the way
_BALANCES = 3  # of goals with the forces found
_SHARE = 0.5  # of the distance at which the barrier acts, first held
_MET = 4.0  # d_hat, closer than which they are measured there


def keep_apart(
    problem: Bendable, start: FloatArray, wanted: FloatArray, bend: Bend | TensorBend
) -> FloatArray | None:
    """State near a wanted one under `bend`, to which no scales meet on the way.

    Parameters
    ----------
    problem : its system has the Hessian to be used.
    start : (n_rows, 3) world vectors without overlap, where the way begins.
    wanted : (n_unknowns,) state under `bend` at which scales may overlap.

    Returns
    -------
    (n_unknowns,), or None where none was found, as where the Hessian is not positive.
    """
    if problem.contact is None:
        return None
    try:
        return _Search(problem, problem.contact, start, wanted, bend).run()
    except (np.linalg.LinAlgError, RuntimeError):  # the latter of least squares without an end
        return None


class _Search:
    """The working set: gaps that are held, their forces, and the state that follows from these."""

    def __init__(
        self,
        problem: Bendable,
        contact: Contact,
        start: FloatArray,
        wanted: FloatArray,
        bend: Bend | TensorBend,
    ) -> None:
        self.problem, self.contact, self.bend = problem, contact, bend
        self.start = start
        self.gaps = contact.gaps(start, problem.gap)
        self.starts = np.minimum(self.gaps.distances, contact.activation_distance)
        self.goals = _SHARE * self.starts
        self.held = np.zeros(0, dtype=np.int64)
        self.forces = np.zeros(0)
        self.slopes = np.zeros((len(problem.active), 0))
        self.answers = np.zeros((len(problem.active), 0))
        self.wanted = wanted
        self._move()

    def _move(self) -> None:
        self.z = self.wanted.copy()
        self.z[self.problem.active] += self.answers @ self.forces
        self.world: Any = self.problem.embedding.world_map.place(self.z, self.bend)
        self.positions = self.contact.positions(self.world.y)

    def run(self) -> FloatArray | None:
        for _ in range(_PASSES):
            for _ in range(_ROUNDS):
                tight = self._tight()
                if not len(tight):
                    break
                self._hold(tight)
            for _ in range(_BALANCES if len(self.held) else 0):
                self._balance()
                self._hold(self.held)
            share = self.contact.free_share(self.start, self.world.y)
            if share >= 1.0:
                return self.z
            met = self.start + share * (self.world.y - self.start)
            reach = self.contact.activation_distance
            more = self.contact.gaps(met, _MET * reach)
            self.gaps = self.gaps.joined(more)
            self.starts = np.concatenate([self.starts, np.full(len(more), reach)])
            self.goals = np.concatenate([self.goals, np.full(len(more), _SHARE * reach)])
        return None

    def _tight(self) -> IntArray:
        """Of each pair of scales, the gap that falls short the most."""
        gaps = self.gaps.at(self.positions)
        short = np.flatnonzero(gaps < 0.5 * self.goals)
        short = short[np.argsort(gaps[short], kind="stable")]
        return short[np.unique(self.gaps.bodies[short], return_index=True)[1]]

    def _hold(self, tight: IntArray) -> None:
        """Forces that keep these gaps too, and the state under them."""
        new = np.setdiff1d(tight, self.held)
        slopes = np.stack([self._slope(k) for k in new], axis=1) if len(new) else self.slopes[:, :0]
        self.held = np.concatenate([self.held, new])
        self.slopes = np.hstack([self.slopes, slopes])
        if len(new):
            answers = self.problem.system.solve_block(slopes)
            self.answers = np.hstack([self.answers, answers])
        forces = np.concatenate([self.forces, np.zeros(len(new))])
        compliance = self.slopes.T @ self.answers
        held = self.gaps.take(self.held)
        # Gaps are not quite linear in the state: what they are now is kept, less what forces did.
        missing = self.goals[self.held] - held.at(self.positions) + compliance @ forces
        self.forces = complementary_forces(compliance, missing)
        self._move()

    def _slope(self, entry: int) -> FloatArray:
        on_rows = self.contact.spread(self.gaps.forces(entry), len(self.world.y))
        world_map = self.problem.embedding.world_map
        slope: FloatArray = world_map.pull_gradient(self.world, on_rows)[self.problem.active]
        return slope

    def _balance(self) -> None:
        """Hold gaps at distances at which the barrier has the forces that were found.

        Of a pair of scales that meet with their faces, all gaps within the barrier's reach share
        the force.
        """
        held = self.gaps.take(self.held)
        now = self.gaps.at(self.positions)
        reached = self.gaps.bodies[now < self.contact.activation_distance]
        n_sharing = np.array([max(1, np.count_nonzero(reached == pair)) for pair in held.bodies])
        # The Hessian has the springs of gaps that were closed at the start.
        push, spring = self.contact.push(self.starts[self.held])
        force = push + spring * (self.starts[self.held] - now[self.held]) + self.forces / n_sharing
        self.goals[self.held] = self.contact.distance_at(np.maximum(force, 0.0))


def complementary_forces(compliance: FloatArray, missing: FloatArray) -> FloatArray:
    """f >= 0 (n,) with compliance f >= missing, and f = 0 where it is more than that.

    Raises
    ------
    numpy.linalg.LinAlgError : compliance (n, n) is not positive.
    """
    n = len(missing)
    even = 0.5 * (compliance + compliance.T) + 1e-9 * np.trace(compliance) / n * np.eye(n)
    lower = np.linalg.cholesky(even)
    forces: FloatArray = nnls(lower.T, np.linalg.solve(lower, missing), maxiter=50 * n)[0]
    return forces

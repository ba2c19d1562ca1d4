"""Linear systems with the mean-offset constraint c.z = 0 [Eqs. 8, 9].

The bordered system [H c; c^T 0] is indefinite by construction, and at kappa = 0 H itself is
singular: a uniform shift of w3 costs nothing. Both borders are therefore taken out by hand. With e
the unit vector of one w3 and sigma > 0,

    | K   e        c | | dz |   | r |
    | e^T 1/sigma  0 | | t  | = | 0 |       K = H + sigma e e^T
    | c^T 0        0 | | mu |   | s |

is the bordered system: the second row gives t = -sigma e.dz and cancels sigma in the first. Only K
is factorized. By Haynsworth's additivity the inertia of H on {c.dz = 0} follows from that of K and
of the 2x2 Schur complement. (The paper adds 2 rho c c^T by the Sherman-Morrison formula, in a loop
of an augmented Lagrangian: the same states, to 7e-14 mm, in twice as many iterations.)
"""

from __future__ import annotations

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.solve.linear import Factorization

_NOTHING = 1e-9  # of the mean diagonal


class ConstrainedSystem:
    """Factorizes and solves with H on a fixed pattern under one linear constraint.

    Parameters
    ----------
    factorization : backend on the pattern of H.
    diagonal : (n,) slots of the diagonal in the values of H.
    constraint : (n,) c.
    shift_unknown : position of e.
    """

    def __init__(
        self,
        factorization: Factorization,
        diagonal: np.ndarray,
        constraint: FloatArray,
        shift_unknown: int,
    ) -> None:
        self.factorization = factorization
        self.diagonal = diagonal
        self.constraint = constraint
        self.shift_unknown = shift_unknown
        unit = np.zeros_like(constraint)
        unit[shift_unknown] = 1.0
        self._borders = np.stack([unit, constraint], axis=1)

    def factorize(self, values: FloatArray, damping: float = 0.0) -> int:
        """Factorize H + damping * mean(diag H) I; returns the negative eigenvalues of H on c.dz =
        0.

        A singular K counts as one negative eigenvalue more.
        """
        values = values.copy()
        scale = float(np.abs(values[self.diagonal]).mean())
        values[self.diagonal] += damping * scale
        self._sigma = abs(float(values[self.diagonal[self.shift_unknown]]))
        if self._sigma <= _NOTHING * scale:  # a cell of one scale shifts as a whole
            self._sigma = scale
        values[self.diagonal[self.shift_unknown]] += self._sigma
        negative = self.factorization.factorize(values)
        if negative < 0:
            return 1
        self._columns = self.factorization.solve(self._borders)
        schur = -self._borders.T @ self._columns
        schur[0, 0] += 1.0 / self._sigma
        self._schur = 0.5 * (schur + schur.T)
        return negative + int(np.count_nonzero(np.linalg.eigvalsh(self._schur) < 0.0)) - 1

    def solve(self, right_hand_side: FloatArray, target: float = 0.0) -> tuple[FloatArray, float]:
        """Solve H dz + c mu = r, c.dz = target; returns dz (n,) and mu."""
        free = self.factorization.solve(right_hand_side[:, None])[:, 0]
        t, mu = np.linalg.solve(self._schur, np.array([0.0, target]) - self._borders.T @ free)
        return free - self._columns @ np.array([t, mu]), float(mu)

    def solve_block(self, right_hand_sides: FloatArray) -> FloatArray:
        """Solve H dz + c mu = r, c.dz = 0 for (n, k) right-hand sides, without
        iterative refinement; returns dz (n, k)."""
        free = self.factorization.solve(right_hand_sides, refine=False)
        return free - self._columns @ np.linalg.solve(self._schur, -self._borders.T @ free)

"""Linear systems of a problem whose unknowns are under no constraint beyond those left out."""

from __future__ import annotations

import numpy as np

from flexscale.arrays import FloatArray, IntArray
from flexscale.solve.linear import Factorization


class UnconstrainedSystem:
    """Factorizes and solves with H on a fixed pattern.

    It answers as `ConstrainedSystem` does, with a constraint of zeros: the multiplier is 0, and
    the target is of no effect.

    Parameters
    ----------
    factorization : backend on the pattern of H.
    diagonal : (n,) slots of the diagonal in the values of H.
    """

    def __init__(self, factorization: Factorization, diagonal: IntArray) -> None:
        self.factorization = factorization
        self.diagonal = diagonal
        self.constraint: FloatArray = np.zeros(len(diagonal))

    def factorize(self, values: FloatArray, damping: float = 0.0) -> int:
        """Factorize H + damping * mean(diag H) I; returns the negative eigenvalues of H.

        A singular H counts as one negative eigenvalue.
        """
        if damping > 0.0:
            values = values.copy()
            values[self.diagonal] += damping * float(np.abs(values[self.diagonal]).mean())
        negative = self.factorization.factorize(values)
        return 1 if negative < 0 else negative

    def solve(self, right_hand_side: FloatArray, target: float = 0.0) -> tuple[FloatArray, float]:
        """Solve H dz = r; returns dz (n,) and 0, there being no multiplier."""
        return self.factorization.solve(right_hand_side[:, None])[:, 0], 0.0

    def solve_block(self, right_hand_sides: FloatArray) -> FloatArray:
        """(n, k) solutions without iterative refinement."""
        return self.factorization.solve(right_hand_sides, refine=False)

"""Modes along which a constrained energy curves downward, from a factorization of its Hessian."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import scipy.sparse.linalg

from flexscale.mechanics.energy import FloatArray

RESTARTS = 3  # of the Lanczos iteration; more would cost more than another search direction
_ROUNDING = 1e-12  # of the inverse's size: it vanishes, but for rounding, along the constraint


class System(Protocol):
    """Linear systems with the Hessian under c.dz = 0; c = 0 where nothing is constrained."""

    constraint: FloatArray

    def factorize(self, values: FloatArray, damping: float = 0.0) -> int:
        """Factorize; returns the number of negative eigenvalues on the constraint."""

    def solve(
        self, right_hand_side: FloatArray, target: float = 0.0, compliance: float = 0.0
    ) -> tuple[FloatArray, float]:
        """Solution and multiplier."""


def negative_modes(
    system: System, count: int, compliance: float = 0.0
) -> tuple[FloatArray, FloatArray]:
    """The `count` eigenpairs of the factorized H on c.dz = 0 that lie closest below zero.

    Lanczos iteration on the inverse, whose most negative eigenvalues they are.

    Returns
    -------
    curvatures : (k,) negative eigenvalues; k < count if the iteration did not find all of them.
    modes : (n, k), orthonormal.
    """
    n = len(system.constraint)
    inverse = scipy.sparse.linalg.LinearOperator(
        (n, n), matvec=lambda r: system.solve(r, 0.0, compliance)[0]
    )
    start = np.random.default_rng(0).standard_normal(n)
    try:
        values, modes = scipy.sparse.linalg.eigsh(
            inverse, k=count, which="SA", v0=start, tol=1e-3, ncv=4 * count + 16, maxiter=RESTARTS
        )
    except scipy.sparse.linalg.ArpackNoConvergence as error:
        values, modes = error.eigenvalues, error.eigenvectors
    size = np.linalg.norm(inverse.matvec(start)) / np.linalg.norm(start)
    downward = values < -_ROUNDING * size
    return 1.0 / values[downward], modes[:, downward]

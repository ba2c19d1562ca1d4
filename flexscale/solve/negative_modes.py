"""Directions along which a constrained energy curves downward, from a factorization of its Hessian.

With A = H^-1 on the constraint c.dz = 0, the k negative eigenvalues of A are those of H. Let U (n,
k) be any vectors with U^T A U = T negative definite, and W = A U. Then W^T H W = T: on the span of
W the energy curves downward, and since H has no more than k such directions, it curves upward on
all that is H-orthogonal to W. Turning W over,

    |H|^-1 = A - 2 W T^-1 W^T,

makes the inverse positive definite on the constraint, however rough U is. With the eigenvectors of
A it is the saddle-free Newton step of Dauphin et al. (2014); the Ritz vectors of a short block
Krylov iteration on A come close to them, since the eigenvalues of H nearest to zero are the largest
of A.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from flexscale.arrays import FloatArray

MOST_STEPS = 6  # of the block Krylov iteration; more would cost more than another search direction
SPARE = 4  # vectors of a block beyond those sought
SETTLED = 0.05  # relative change of the Ritz values from one step to the next
_ROUNDING = 1e-12  # of the inverse's size: it vanishes, but for rounding, along the constraint


class System(Protocol):
    """Linear systems with the Hessian under c.dz = 0; c = 0 where nothing is constrained."""

    constraint: FloatArray

    def factorize(self, values: FloatArray, damping: float = 0.0) -> int:
        """Factorize; returns the number of negative eigenvalues on the constraint."""

    def solve(self, right_hand_side: FloatArray, target: float = 0.0) -> tuple[FloatArray, float]:
        """Solution and multiplier."""

    def solve_block(self, right_hand_sides: FloatArray) -> FloatArray:
        """(n, k) solutions for target 0, without iterative refinement."""


@dataclass(frozen=True)
class NegativeModes:
    """A subspace on which the energy curves downward.

    Attributes
    ----------
    directions : (n, k) W, each as long as its eigenvalue of A is large.
    values : (k,) diagonal of T, the negative Ritz values of A, most negative first.
    """

    directions: FloatArray
    values: FloatArray

    def __len__(self) -> int:
        return len(self.values)

    @property
    def curvatures(self) -> FloatArray:
        """(k,) estimates of the negative eigenvalues of H, those nearest to zero first."""
        return np.asarray(1.0 / self.values)

    def turn_over(self, step: FloatArray, gradient: FloatArray) -> FloatArray:
        """-|H|^-1 g, given the Newton step -H^-1 g."""
        return step + self.directions @ (2.0 * (self.directions.T @ gradient) / self.values)


def negative_modes(system: System, count: int) -> NegativeModes:
    """The `count` modes of the factorized H on c.dz = 0 whose eigenvalues lie closest below zero.

    Fewer if the iteration does not find all of them. The start is random, but always the same.
    """
    n = len(system.constraint)
    width = min(count + SPARE, n)
    block = np.linalg.qr(np.random.default_rng(0).standard_normal((n, width)))[0]
    basis, images = np.zeros((n, 0)), np.zeros((n, 0))
    before = np.zeros(0)
    for _ in range(MOST_STEPS):
        image = system.solve_block(block)
        basis, images = np.hstack([basis, block]), np.hstack([images, image])
        small = basis.T @ images
        values, vectors = np.linalg.eigh(0.5 * (small + small.T))
        found = values[:count][values[:count] < -_ROUNDING * np.abs(values).max()]
        if len(found) == count == len(before) and np.allclose(
            found, before, rtol=SETTLED, atol=0.0
        ):
            break
        before = found
        for _ in range(2):  # twice is enough (Kahan)
            image = image - basis @ (basis.T @ image)
        block = np.linalg.qr(image)[0]
    return NegativeModes(images @ vectors[:, : len(found)], found)

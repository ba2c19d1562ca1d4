"""Directions and linear parts of isometries at multiples of 15°, without rounding in the angle.

The turns between the edges of Laves tiles are multiples of 15°. Kept as whole numbers, linear parts
can be composed and compared exactly.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from flexscale.arrays import FloatArray

UNIT = 15.0  # degrees
FULL_TURN = 24  # units


def unit_vector(degrees: float) -> FloatArray:
    """(2,) direction at an angle from the x axis; exact at multiples of 90° and 30° from it."""
    return np.array([_cosine(degrees), _cosine(degrees - 90.0)])


def _cosine(degrees: float) -> float:
    folded = abs(math.remainder(degrees, 360.0))
    if folded > 90.0:
        return -_cosine(180.0 - folded)
    exact = {0.0: 1.0, 30.0: 0.5 * math.sqrt(3.0), 45.0: math.sqrt(0.5), 60.0: 0.5, 90.0: 0.0}
    return exact.get(folded, math.cos(math.radians(folded)))


@dataclass(frozen=True)
class LinearPart:
    """Rotation by `turn`, or reflection that carries direction x to direction `turn`.

    Attributes
    ----------
    turn : units of 15°, in [0, 24).
    reverses : whether it is a reflection; its axis lies at half of `turn`.
    """

    turn: int
    reverses: bool

    def __matmul__(self, first: LinearPart) -> LinearPart:
        """`first`, then this one."""
        turn = self.turn - first.turn if self.reverses else self.turn + first.turn
        return LinearPart(turn % FULL_TURN, self.reverses != first.reverses)

    @property
    def inverse(self) -> LinearPart:
        """What undoes it."""
        return self if self.reverses else LinearPart(-self.turn % FULL_TURN, False)

    @property
    def matrix(self) -> FloatArray:
        """(2, 2) orthogonal."""
        x, y = unit_vector(UNIT * self.turn)
        return np.array([[x, y], [y, -x]]) if self.reverses else np.array([[x, -y], [y, x]])


IDENTITY = LinearPart(0, False)

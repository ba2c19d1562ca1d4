"""Isometries of the plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexscale.arrays import FloatArray


@dataclass(frozen=True)
class Isometry:
    """x -> linear @ x + translation.

    Attributes
    ----------
    linear : (2, 2) orthogonal.
    translation : (2,) in the unit of the points.
    """

    linear: FloatArray
    translation: FloatArray

    def apply(self, points: FloatArray) -> FloatArray:
        """Images of points (n, 2)."""
        return points @ self.linear.T + self.translation

    @property
    def reverses(self) -> bool:
        """Whether it turns counterclockwise into clockwise."""
        return bool(np.linalg.det(self.linear) < 0.0)

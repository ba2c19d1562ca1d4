"""How a cell or a sheet is bent: a curvature in a direction, or any curvature tensor."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from flexscale.arrays import FloatArray

_FLAT = np.zeros((2, 2))
_FLAT.setflags(write=False)


@dataclass(frozen=True)
class Bend:
    """Macroscopic curvature [mm-1, positive closes] and its direction [rad from the x axis]."""

    curvature: float
    direction: float

    @cached_property
    def tensor(self) -> FloatArray:
        """(2, 2) curvature tensor of a unit curvature in this direction, n n^T."""
        n = np.array([np.cos(self.direction), np.sin(self.direction)])
        return np.outer(n, n)

    @property
    def base(self) -> FloatArray:
        """(2, 2) zeros: nothing else bends the sheet."""
        return _FLAT


@dataclass(frozen=True)
class TensorBend:
    """Two curvatures at a time: a tensor k = base + curvature [mm-1] times a tensor, each (2, 2).

    Derivatives by the curvature are those by k along the tensor.
    """

    curvature: float
    tensor: FloatArray
    base: FloatArray = field(default_factory=lambda: _FLAT)


#: (3, 2, 2) tensors of unit k_xx, k_yy and 2 k_xy.
UNIT_CURVATURES = np.array(
    [[[1.0, 0.0], [0.0, 0.0]], [[0.0, 0.0], [0.0, 1.0]], [[0.0, 0.5], [0.5, 0.0]]]
)

"""A ray of curvature tensors: one direction, one ratio of principal curvatures, from flat on."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.datasets.kinds.tensor_sweep import unit_tensors
from flexscale.datasets.variables import COMPONENTS
from flexscale.embedding.bends import TensorBend
from flexscale.homogenize.bent_joints import BentJoints, JointState


@dataclass(frozen=True)
class TensorLine:
    """Samples of one direction and shape; see `datasets.kinds.tensor_sweep`.

    Attributes
    ----------
    direction : degree, of the larger principal curvature.
    shape : degree, angle of the principal curvatures.
    curvatures : mm-1, non-negative and increasing.
    """

    direction: float
    shape: float
    curvatures: tuple[float, ...]

    sign = 1.0
    measured = tuple(
        f"{what}_{name}" for what in ("moment", "membrane_force") for name in COMPONENTS
    )

    @property
    def key(self) -> str:
        """Name of the line in a checkpoint."""
        return f"{self.direction!r}-{self.shape!r}"

    @cached_property
    def tensor(self) -> FloatArray:
        """(2, 2) of curvature 1."""
        xx, yy, xy = unit_tensors(self.direction, self.shape)
        return np.array([[xx, xy], [xy, yy]])

    def bend(self, curvature: float) -> TensorBend:
        """The bend of a sample of this line."""
        return TensorBend(curvature, self.tensor)

    def measure(self, cell: BentJoints, state: JointState) -> dict[str, float]:
        """Moments [N] and in-plane forces [N mm-1] of a state by their components."""
        numbers = np.concatenate([cell.tensor_moments(state), cell.membrane_forces(state)])
        return dict(zip(self.measured, numbers.tolist(), strict=True))

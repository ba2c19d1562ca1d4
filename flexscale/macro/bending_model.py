"""What models with a law of any curvature share: energies and moments, of single ones too."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from flexscale.arrays import FloatArray
from flexscale.macro.tensors import evaluate_tensors, uniaxial_tensors, unit_vectors
from flexscale.mechanics.sheet_law import SheetLaw
from flexscale.sides import side_sign


class BendingModel(ABC):
    """Bending response of a scaled sheet to any curvature tensor.

    Attributes
    ----------
    tangent, in_plane : (3, 3) N mm and N mm-1, stiffness of the flat cell.
    largest_curvature : mm-1, up to which the model is known to hold.
    labels : pattern, family, sizes, materials.
    """

    tangent: FloatArray
    in_plane: FloatArray
    largest_curvature: float
    labels: Mapping[str, float | str]

    @abstractmethod
    def sheet_law(self) -> SheetLaw:
        """The law of this model's energy, for sheets of it."""

    @abstractmethod
    def warn_beyond(self, curvature: ArrayLike) -> None:
        """One warning if curvature tensors (..., 2, 2) [mm-1] are beyond the model's data.

        Raises
        ------
        UnitRangeError : not symmetric 2 by 2 matrices of finite numbers.
        """

    def energy(
        self, curvature: ArrayLike, direction: ArrayLike, side: str = "closing"
    ) -> FloatArray:
        """Energy per area [N mm-1]; curvature (mm-1, >= 0) and direction (degree) broadcast."""
        return self.tensor_energy(uniaxial_tensors(curvature, direction, side))

    def moment(
        self, curvature: ArrayLike, direction: ArrayLike, side: str = "closing"
    ) -> FloatArray:
        """Bending moment per width [N] in the direction of the curvature, >= 0."""
        n = unit_vectors(direction)
        tensors = self.tensor_moment(uniaxial_tensors(curvature, direction, side))
        along = np.einsum("...i,...ij,...j->...", n, tensors, n)
        return side_sign(side) * along

    def tensor_energy(self, curvature: ArrayLike) -> FloatArray:
        """Bending energy per area [N mm-1] of curvature tensors (…, 2, 2) in mm-1, closing > 0."""
        self.warn_beyond(curvature)
        return evaluate_tensors(curvature, self.sheet_law())[0]

    def tensor_moment(self, curvature: ArrayLike) -> FloatArray:
        """Moments per width (…, 2, 2) in N: derivative of `tensor_energy` by the tensor."""
        self.warn_beyond(curvature)
        return evaluate_tensors(curvature, self.sheet_law())[1]

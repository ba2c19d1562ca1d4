"""Elastic materials and the two the paper prints with."""

from __future__ import annotations

from dataclasses import dataclass

from flexscale.errors import UnitRangeError
from flexscale.units import require_finite, require_positive


@dataclass(frozen=True)
class NeoHookean:
    """Isotropic Neo-Hookean solid, given by its small-strain constants.

    Parameters
    ----------
    young_modulus : MPa, positive.
    poisson_ratio : 1, above -1 and below 0.5.
    """

    young_modulus: float
    poisson_ratio: float

    def __post_init__(self) -> None:
        modulus = require_positive(self.young_modulus, "Young's modulus", "MPa")
        ratio = require_finite(self.poisson_ratio, "Poisson ratio", "1")
        if not -1.0 < ratio < 0.5:
            raise UnitRangeError(
                f"Poisson ratio is {ratio:g}, but must lie above -1 and below 0.5: "
                "take 0.48 or 0.49 for a nearly incompressible material."
            )
        object.__setattr__(self, "young_modulus", modulus)
        object.__setattr__(self, "poisson_ratio", ratio)

    @property
    def shear_modulus(self) -> float:
        """Shear modulus μ, MPa."""
        return self.young_modulus / (2.0 * (1.0 + self.poisson_ratio))

    @property
    def lame_lambda(self) -> float:
        """First Lamé constant λ, MPa."""
        ratio = self.poisson_ratio
        return self.young_modulus * ratio / ((1.0 + ratio) * (1.0 - 2.0 * ratio))


PETG = NeoHookean(young_modulus=2020.0, poisson_ratio=0.35)
TPU = NeoHookean(young_modulus=26.0, poisson_ratio=0.48)

"""Elastic materials and the two the paper prints with."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from functools import cache

from flexscale.checks import checked, number
from flexscale.units import MODULI, RATIOS

log = logging.getLogger(__name__)


@checked(
    young_modulus=number("MPa", *MODULI, above=0.0, name="Young's modulus"),
    poisson_ratio=number("1", *RATIOS, name="Poisson ratio"),
)
@dataclass(frozen=True)
class NeoHookean:
    """Isotropic Neo-Hookean solid, given by its small-strain constants.

    Parameters
    ----------
    young_modulus : MPa, positive.
    poisson_ratio : 1, within `units.RATIOS`; 0.48 or 0.49 for a nearly incompressible material.

    Raises
    ------
    UnitRangeError : a constant out of range.
    """

    young_modulus: float
    poisson_ratio: float

    @property
    def shear_modulus(self) -> float:
        """Shear modulus μ, MPa."""
        return self.young_modulus / (2.0 * (1.0 + self.poisson_ratio))

    @property
    def is_rigid(self) -> bool:
        """Whether it stands for a body that does not deform: as stiff as a material may be."""
        return self.young_modulus >= MODULI[1]

    @property
    def lame_lambda(self) -> float:
        """First Lamé constant λ, MPa."""
        ratio = self.poisson_ratio
        return self.young_modulus * ratio / ((1.0 + ratio) * (1.0 - 2.0 * ratio))


@cache
def warn_of_soft_scales(scales: NeoHookean, substrate: NeoHookean) -> None:
    """One warning in the log, for each two materials, where scales are softer than the sheet."""
    if scales.young_modulus < substrate.young_modulus:
        log.warning(
            "The scales (%g MPa) are softer than the substrate (%g MPa): were GPa meant?",
            scales.young_modulus,
            substrate.young_modulus,
        )


PETG = NeoHookean(young_modulus=2020.0, poisson_ratio=0.35)
TPU = NeoHookean(young_modulus=26.0, poisson_ratio=0.48)
#: Scales that do not deform at all.
RIGID = NeoHookean(young_modulus=MODULI[1], poisson_ratio=0.35)

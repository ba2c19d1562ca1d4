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
#: NinjaFlex 85A as the paper has it. 26 MPa is its ultimate strength in transcriptions of the data
#: sheet (ASTM D638), which give 12 MPa for its tensile modulus.
TPU = NeoHookean(young_modulus=26.0, poisson_ratio=0.48)
#: NinjaFlex 85A as measured on printed samples, for strains up to some 100 %. Raw data of SoRoForge
#: (doi 10.1089/3dp.2023.0010, eight samples) have a tangent of 14.4 MPa from 2 to 10 % and of 11.7
#: from 0 to 30 %; Neo-Hookean fits up to 31, 63 and 94 % have 14.6, 12.6 and 11.2 MPa. Sheets of
#: 0.8 to 1.3 mm have 8.2 to 11.9 MPa (Int. J. Bioprinting 9(4), p. 314, 2023).
TPU_MEASURED = NeoHookean(young_modulus=12.0, poisson_ratio=0.48)
#: Scales that do not deform at all.
RIGID = NeoHookean(young_modulus=MODULI[1], poisson_ratio=0.35)

#: Young's moduli between which measurements of a material lie, MPa.
_MEASURED = {TPU_MEASURED: (8.0, 16.0)}


def modulus_band(material: NeoHookean) -> tuple[float, float] | None:
    """Least and largest measured Young's modulus, over the material's; None where not known.

    Forces and energies of a sheet of soft joints scale with its modulus, onsets do not.
    """
    if material not in _MEASURED:
        return None
    low, high = _MEASURED[material]
    return low / material.young_modulus, high / material.young_modulus

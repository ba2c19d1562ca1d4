"""From a sweep to the macro model: two-regime laws, circular harmonics, errors of the fit."""

from flexscale.macro.fit import fit as fit
from flexscale.macro.model import MacroModel as MacroModel
from flexscale.macro.uniaxial import UniaxialLaw as UniaxialLaw

"""Response of a sheet whose scales do not touch: the flat cell's stiffness, and its softening.

Bent far in directions in which it is stiff, a sheet without contact softens: strips between scales
that have to twist turn out of it. Native moments of all directions together follow from one number
s: with E = a κ²/2, m = a κ / (1 + s E), the derivative of log(1 + s E)/s. In soft directions, where
E is small, the law stays linear, as native sheets do.

# PAPER: m = a κ before contact, a fitted to all samples. WE: a of the flat cell, and s. WHY: exact
# at small curvature, and good at large ones, where a fitted to both is wrong at both.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.macro.harmonics import Harmonics
from flexscale.macro.samples import Samples
from flexscale.macro.uniaxial import UniaxialLaw

#: Samples softer than this share of their linear law have buckled; they count as if so soft.
_LEAST_SHARE = 0.2


@dataclass(frozen=True)
class FlatResponse:
    """Bending without contact in every direction.

    Attributes
    ----------
    stiffness : a, N mm.
    softening : s, mm N-1.
    """

    stiffness: Harmonics
    softening: float = 0.0

    def law(self, direction: float) -> UniaxialLaw:
        """The response in one direction (degree)."""
        return UniaxialLaw(float(self.stiffness(direction)), np.nan, np.nan, self.softening)


def fit_softening(samples: Samples, stiffness: Harmonics, kappa_0: FloatArray) -> FlatResponse:
    """Softening of the samples before contact: a κ/m − 1 = s E by least squares, s >= 0.

    `kappa_0` (s, d) mm-1 : contact curvature as far as known, nan for none. Samples in which scales
    touch do not count either.
    """
    free = samples.used & ~(samples.curvatures > kappa_0[..., None])
    if samples.touches is not None:
        free &= ~samples.touches
    linear = np.broadcast_to(
        stiffness(samples.directions)[:, None] * samples.curvatures, free.shape
    )
    energy, share = 0.5 * linear * samples.curvatures, np.ones(free.shape)
    np.divide(samples.moment, linear, out=share, where=free)
    lost = 1.0 / np.maximum(share[free], _LEAST_SHARE) - 1.0
    square = float(np.sum(energy[free] ** 2))
    slope = float(np.sum(energy[free] * lost)) / square if square > 0.0 else 0.0
    return FlatResponse(stiffness, max(slope, 0.0))

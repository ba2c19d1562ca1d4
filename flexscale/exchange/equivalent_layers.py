"""Three layers, symmetric, that have a given A and a given D; for solvers that take layers alone.

Two faces of thickness f and plane stiffness Q_f on a core of thickness c and Q_c have

    A = 2 f Q_f + c Q_c,     D = I_f Q_f + I_c Q_c,     I_c = c³/12,  I_f = ((c + 2 f)³ − c³)/12,

which are solved for Q_f and Q_c. Both are stiffnesses (positive) if, for every x,

    c²/12 < x·D x / x·A x < I_f/(2 f) = ((c + 2 f)² + (c + 2 f) c + c²)/12:

the core is thin and the whole is thick enough, whatever A and D are. The layers are not those of
the print, and stresses in them mean nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from flexscale.arrays import FloatArray

#: How far the two bounds stay away from the least and the largest ratio of D to A.
_CORE_SHARE, _WHOLE_SHARE = 0.5, 1.1


@dataclass(frozen=True)
class EquivalentLayers:
    """Faces and core.

    Attributes
    ----------
    face, core : mm, thickness of each face, and of the core.
    face_stiffness, core_stiffness : (3, 3) MPa, plane stress for (E_xx, E_yy, 2 E_xy).
    """

    face: float
    core: float
    face_stiffness: FloatArray
    core_stiffness: FloatArray


def find_layers(a: FloatArray, d: FloatArray) -> EquivalentLayers:
    """Layers of a plate with A (3, 3) N/mm and D (3, 3) N mm, both positive definite."""
    ratios = eigh(d, a, eigvals_only=True)
    core = float(np.sqrt(12.0 * _CORE_SHARE * ratios[0]))
    wanted = 12.0 * _WHOLE_SHARE * float(ratios[-1])  # h² + h c + c²
    whole = 0.5 * (-core + np.sqrt(4.0 * wanted - 3.0 * core**2))
    face = 0.5 * (whole - core)
    of_face, of_core = (whole**3 - core**3) / 12.0, core**3 / 12.0
    face_stiffness = (d - core**2 / 12.0 * a) / (of_face - face * core**2 / 6.0)
    core_stiffness = (of_face * a - 2.0 * face * d) / (of_face * core - 2.0 * face * of_core)
    return EquivalentLayers(face, core, face_stiffness, core_stiffness)

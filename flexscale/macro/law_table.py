"""Tables of numbers for `tensor_law`, from stiffness matrices and polar laws."""

from __future__ import annotations

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.datasets.variables import Variant
from flexscale.macro.directional_law import INVERSE_ONSET, NO_ONSET, ONSET
from flexscale.macro.harmonics import Harmonics
from flexscale.macro.polar import PolarLaw
from flexscale.macro.tensor_law import (
    BIAXIAL,
    CLOSING,
    DELTA2,
    ETA2,
    IN_PLANE,
    LEAST_ONSET,
    N_TABLE,
    OPENING,
    OWN,
    SOFTENING,
    TANGENT,
    A,
)
from flexscale.sides import SIDES

#: η of `principal`: how much the two curvatures may differ, relative to them, before directions
#: count. It moves energies where both curvatures are of a size, by a share of η² in between.
ETA = 0.1
#: δ of `principal` in the energy "paper", mm-1: a thousandth of the least curvature of interest.
#: # PAPER: perturbs flat elements at the start. WE: δ. WHY: derivatives exist at every state.
DELTA = 1e-6

_KINDS = {"kappa_0": ONSET, "1/kappa_0": INVERSE_ONSET, "none": NO_ONSET}
_UPPER = np.triu_indices(3)


def build_law_table(
    polar: PolarLaw,
    *,
    variant: Variant,
    tangent: FloatArray | None,
    in_plane: FloatArray | None,
    w_biaxial: float,
) -> FloatArray:
    """Table (60,) of a macro law.

    Parameters
    ----------
    polar : harmonics of a, b and the onset; a side it does not have never meets contact.
    variant : "tangent" or "paper", see `tensor_law`.
    tangent : (3, 3) N mm, C; needed for "tangent".
    in_plane : (3, 3) N mm-1, A; 0 if not given, for bending alone.
    w_biaxial : N mm3.
    """
    table = np.zeros(N_TABLE)
    if in_plane is not None:
        table[IN_PLANE : IN_PLANE + 6] = in_plane[_UPPER]
    if variant == "tangent":
        assert tangent is not None  # a model of this variant has one
        table[TANGENT : TANGENT + 6] = tangent[_UPPER]
        table[ETA2] = ETA**2
        table[SOFTENING] = polar.softening
    else:
        table[OWN] = 1.0
        table[DELTA2] = DELTA**2
    table[BIAXIAL] = w_biaxial
    _write(table, A, polar.a)
    table[LEAST_ONSET] = least_onset(polar)
    for side, at in zip(SIDES, (CLOSING, OPENING), strict=True):
        table[at + 8] = NO_ONSET
        if side in polar.sides:
            index = polar.sides.index(side)
            _write(table, at, polar.b[index])
            table[at + 8] = _KINDS[polar.onset_quantity[index]]
            _write(table, at + 9, polar.onset[index])
    return table


def build_rest_table(
    tangent: FloatArray, in_plane: FloatArray, w_biaxial: float, softening: float
) -> FloatArray:
    """Table (60,) of a sheet whose scales never touch.

    Parameters
    ----------
    tangent, in_plane : (3, 3) C in N mm, A in N mm-1.
    w_biaxial : N mm3.
    softening : s, mm N-1.
    """
    table = np.zeros(N_TABLE)
    table[IN_PLANE : IN_PLANE + 6] = in_plane[_UPPER]
    table[TANGENT : TANGENT + 6] = tangent[_UPPER]
    table[BIAXIAL], table[SOFTENING], table[LEAST_ONSET] = w_biaxial, softening, np.inf
    table[CLOSING + 8] = table[OPENING + 8] = NO_ONSET
    return table


def least_onset(polar: PolarLaw) -> float:
    """Least κ0 of all sides at all angles, mm-1; inf without contact."""
    found = [np.inf]
    for harmonics, quantity in zip(polar.onset, polar.onset_quantity, strict=True):
        if quantity == "kappa_0":
            found.append(harmonics.least())
        elif quantity == "1/kappa_0":
            most = -Harmonics(-harmonics.cosine, -harmonics.sine).least()
            found.append(1.0 / most if most > 0.0 else np.inf)
    return min(found)


def _write(table: FloatArray, at: int, harmonics: Harmonics) -> None:
    table[at : at + len(harmonics.cosine)] = harmonics.cosine
    table[at + 4 : at + 4 + len(harmonics.sine)] = harmonics.sine

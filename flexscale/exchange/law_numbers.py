"""The numbers of a law in closed form, for those who write it as code."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from flexscale.errors import BadInputError
from flexscale.exchange.bending import bending_law
from flexscale.macro.model import MacroModel
from flexscale.macro.tensor_law import (
    BIAXIAL,
    CLOSING,
    DELTA2,
    ETA2,
    LEAST_ONSET,
    OPENING,
    OWN,
    SOFTENING,
    TANGENT,
    A,
)

if TYPE_CHECKING:
    from flexscale.exchange.subject import Subject

#: Energies of a curvature tensor that are a closed form of the numbers below.
CLOSED = ("tangent", "paper")
_HARMONICS, _KIND, _OF_ONSET = 8, 8, 9  # of one side's numbers: b, what onset is of, its harmonics


@dataclass(frozen=True)
class LawNumbers:
    """Numbers of `macro.tensor_law` without its membrane; harmonics as c_0 … c_3, s_0 … s_3.

    Attributes
    ----------
    tangent : (6,) N mm, C as 11, 12, 13, 22, 23, 33 for (k_xx, k_yy, 2 k_xy).
    biaxial : N mm3, w.
    softening : mm N-1, s.
    own : 1 where a is not counted in C, else 0.
    eta2, delta2 : 1, mm-2: see `macro.principal`.
    least_onset : mm-1, at any angle.
    a : (8,) harmonics, N mm.
    b : two of (8,), closing and opening, N mm.
    onset_kind : closing, opening: 0 for harmonics of κ0 in mm-1, 1 for those of 1/κ0, 2 for none.
    onset : two of (8,).
    """

    tangent: tuple[float, ...]
    biaxial: float
    softening: float
    own: float
    eta2: float
    delta2: float
    least_onset: float
    a: tuple[float, ...]
    b: tuple[tuple[float, ...], tuple[float, ...]]
    onset_kind: tuple[int, int]
    onset: tuple[tuple[float, ...], tuple[float, ...]]


def read_law_numbers(subject: Subject, what: str) -> tuple[MacroModel, LawNumbers]:
    """A fitted model, and the numbers of its law.

    Raises
    ------
    BadInputError : no law, or one that is no closed form.
    """
    model = subject.require_model(what)
    if not isinstance(model, MacroModel):
        raise BadInputError(
            f"{what} needs a law in closed form, and {subject.source} finds the forces of its gaps "
            "by an optimization: export it as table-netcdf or table-csv, or export a fit."
        )
    if model.variant not in CLOSED:
        raise BadInputError(
            f"{what} needs a law in closed form, which the energy {model.variant!r} of "
            f"{subject.source} is not: export it as table-netcdf or table-csv."
        )
    table = [float(value) for value in bending_law(model).parameters]

    def row(at: int) -> tuple[float, ...]:
        return tuple(table[at : at + _HARMONICS])

    numbers = LawNumbers(
        tangent=tuple(table[TANGENT : TANGENT + 6]),
        biaxial=table[BIAXIAL],
        softening=table[SOFTENING],
        own=table[OWN],
        eta2=table[ETA2],
        delta2=table[DELTA2],
        least_onset=table[LEAST_ONSET],
        a=row(A),
        b=(row(CLOSING), row(OPENING)),
        onset_kind=(int(table[CLOSING + _KIND]), int(table[OPENING + _KIND])),
        onset=(row(CLOSING + _OF_ONSET), row(OPENING + _OF_ONSET)),
    )
    return model, numbers

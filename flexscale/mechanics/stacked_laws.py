"""Laws of joints of several gaps, stacked as kernels take them: a station has its law's number."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit

from flexscale.arrays import FloatArray, IntArray
from flexscale.mechanics.joint_law import JointLaw, LawTable


class LawTables(NamedTuple):
    """Laws of one sheet, one after the other; runs of law k are those from `starts[k]` on.

    Their terms are numbered through; `LawTable` tells what the others are, one row a law.
    """

    starts: IntArray
    runs: IntArray
    coefficients: FloatArray
    most: IntArray
    at_rest: FloatArray
    thickness: float
    modulus: float
    bounds: FloatArray


@njit(cache=True)
def one_law(laws: LawTables, k: int) -> LawTable:
    """Law k of several."""
    return LawTable(
        laws.runs[laws.starts[k] : laws.starts[k + 1]],
        laws.coefficients,
        laws.most[k],
        laws.at_rest[k],
        laws.thickness,
        laws.modulus,
        laws.bounds[k],
    )


def as_laws(given: JointLaw | Sequence[JointLaw]) -> tuple[JointLaw, ...]:
    """One law, or several in a row, as several."""
    return (given,) if isinstance(given, JointLaw) else tuple(given)


def stack_laws(laws: Sequence[JointLaw]) -> LawTables:
    """What kernels take of laws of one sheet."""
    tables = [law.table for law in laws]
    terms = np.cumsum([0, *(len(table.coefficients) for table in tables)])
    of_terms = np.array([0, 0, 0, 0, 1, 1])  # columns that number terms
    return LawTables(
        np.cumsum([0, *(len(table.runs) for table in tables)]),
        np.concatenate(
            [table.runs + first * of_terms for table, first in zip(tables, terms, strict=False)]
        ),
        np.concatenate([table.coefficients for table in tables]),
        np.stack([table.most for table in tables]),
        np.stack([table.at_rest for table in tables]),
        tables[0].thickness,
        tables[0].modulus,
        np.stack([table.bounds for table in tables]),
    )


def digest_of(laws: Sequence[JointLaw]) -> str:
    """What stands for one law, or for several."""
    return "+".join(law.digest for law in laws)

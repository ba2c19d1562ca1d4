"""Format abaqus: *SHELL GENERAL SECTION of the sheet at rest."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.exchange.laminate import CONVENTIONS
from flexscale.exchange.subject import Subject

_PER_LINE = 8
#: Direction 1 of the section is the pattern's x axis; on curved surfaces its projection.
AXES = (
    "*ORIENTATION, NAME=FLEXSCALE_AXES",
    "1., 0., 0., 0., 1., 0.",
)


def write_abaqus(subject: Subject, path: Path) -> None:
    """Write the 21 entries of the section's stiffness, and the axes that they refer to."""
    laminate = subject.require_laminate("A shell section")
    comments = [
        subject.title(),
        "units mm, N, MPa; for the elements of the set FLEXSCALE, with normals to the scales' side",
        *CONVENTIONS,
        laminate.d_meaning,
        "the sheet at rest: contact of scales is not in it",
        "where the solver wants a transverse shear stiffness, give one of your own",
    ]
    lines = [
        *(f"** {line}" for line in comments),
        *AXES,
        "3, 0.",
        "*SHELL GENERAL SECTION, ELSET=FLEXSCALE, ORIENTATION=FLEXSCALE_AXES",
        *card_lines(symmetric_entries(laminate.matrix)),
    ]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def symmetric_entries(matrix: FloatArray) -> FloatArray:
    """(n (n + 1)/2,) D11, D12, D22, D13, D23, D33, …: the upper half, column by column."""
    return np.concatenate([matrix[: column + 1, column] for column in range(len(matrix))])


def card_lines(values: FloatArray) -> list[str]:
    """Numbers of a card, eight in a line."""
    texts = [f"{value:.12e}" for value in values]  # CalculiX reads 20 characters of a number
    return [", ".join(texts[at : at + _PER_LINE]) for at in range(0, len(texts), _PER_LINE)]

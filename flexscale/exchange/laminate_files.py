"""Formats laminate-json and laminate-csv: A, B and D of the sheet at rest."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

from flexscale.exchange.laminate import CONVENTIONS, ORDER
from flexscale.exchange.subject import Subject

_UNITS = {"A": "N/mm", "B": "N", "D": "N mm"}


def write_json(subject: Subject, path: Path) -> None:
    """Write A, B (null where it is not known) and D, with labels and conventions, as JSON."""
    laminate = subject.require_laminate("A laminate")
    content = {
        "format": "flexscale laminate 1",
        "source": subject.source,
        "sheet": dict(subject.labels),
        "conventions": [*CONVENTIONS, laminate.d_meaning],
        "order": list(ORDER),
        "units": {**_UNITS, "thickness": "mm"},
        "thickness": subject.thickness,
        "A": laminate.a.tolist(),
        "B": None if laminate.b is None else laminate.b.tolist(),
        "D": laminate.d.tolist(),
        "transverse_shear": None,
    }
    path.write_text(json.dumps(content, indent=1, allow_nan=False) + "\n", encoding="utf-8")


def write_csv(subject: Subject, path: Path) -> None:
    """Write one row an entry, matrix, row, column, value, unit, below comments behind #.

    What is not known has no row.
    """
    laminate = subject.require_laminate("A laminate")
    thickness = subject.thickness
    told = "not known" if thickness is None else f"{thickness!r} mm"
    lines = [
        subject.title(),
        f"thickness of the soft sheet, without scales: {told}",
        *CONVENTIONS,
        laminate.d_meaning,
    ]
    text = io.StringIO()
    text.writelines(f"# {line}\n" for line in lines)
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(("matrix", "row", "column", "value", "unit"))
    for name, matrix in (("A", laminate.a), ("B", laminate.b), ("D", laminate.d)):
        if matrix is None:
            continue
        for row, values in zip(ORDER, matrix.tolist(), strict=True):
            for column, value in zip(ORDER, values, strict=True):
                writer.writerow((name, row, column, repr(value), _UNITS[name]))
    path.write_text(text.getvalue(), encoding="utf-8")

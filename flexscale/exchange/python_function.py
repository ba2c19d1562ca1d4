"""Format python-function: the law as a Python file that needs NumPy alone."""

from __future__ import annotations

import pprint
from dataclasses import asdict
from pathlib import Path

from flexscale.exchange import bending_function
from flexscale.exchange.bending import CONVENTIONS, data_sentence, principal_bounds
from flexscale.exchange.law_numbers import read_law_numbers
from flexscale.exchange.subject import Subject

_MARK = "# --- what follows is the same"


def write_python_function(subject: Subject, path: Path) -> None:
    """Write the numbers of the law above the source of `bending_function`."""
    model, numbers = read_law_numbers(subject, "A Python function")
    source = Path(bending_function.__file__).read_text(encoding="utf-8")
    law = {**asdict(numbers), "principal_bounds": principal_bounds(model)}
    told = [f"{line}." for line in (*CONVENTIONS, data_sentence(model))]
    head = [
        f'"""Bending law of a scaled sheet, {subject.title()}.',
        "",
        *told,
        "Takes numbers, NumPy arrays and JAX arrays (with jax_enable_x64, or digits are lost).",
        '"""',
        "",
        "from __future__ import annotations",
        "",
        "from typing import Any",
        "",
        "import numpy as np",
        "",
        "inf = float('inf')",
        "",
        f"LAW: dict[str, Any] = {pprint.pformat(law, sort_dicts=False, width=96)}",
        "",
        "",
    ]
    rest = source[source.index(_MARK) :]
    path.write_text("\n".join(head) + rest, encoding="utf-8")

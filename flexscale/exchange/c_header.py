"""Format c-header: the law as one header of C99 or C++, that needs the math library alone."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from flexscale.exchange.bending import CONVENTIONS, data_sentence, principal_bounds
from flexscale.exchange.law_numbers import LawNumbers, read_law_numbers
from flexscale.exchange.subject import Subject

_CODE = Path(__file__).with_name("bending.h.txt")


def write_c_header(subject: Subject, path: Path) -> None:
    """Write the numbers of the law, and the functions NAME_energy and NAME_within_data."""
    model, numbers = read_law_numbers(subject, "A C header")
    name = subject.name
    told = [subject.title(), *CONVENTIONS, data_sentence(model)]
    told += [
        f"double {name}_energy(const double k[3], double *gradient, double *hessian)",
        f"int {name}_within_data(const double k[3])",
    ]
    comment = "/* Bending law of a scaled sheet.\n\n" + "".join(f"   {line}\n" for line in told)
    declared = "\n".join(_declarations(name, numbers, principal_bounds(model)))
    text = _CODE.read_text(encoding="utf-8")
    for mark, value in (("@GUARD@", f"{name.upper()}_H"), ("@NUMBERS@", declared), ("@N@", name)):
        text = text.replace(mark, value)
    path.write_text(f"{comment}*/\n{text}", encoding="utf-8")


def _declarations(name: str, numbers: LawNumbers, bounds: tuple[float, float]) -> list[str]:
    one = ("biaxial", "softening", "own", "eta2", "delta2", "least_onset")
    lines = [f"static const double {name}_{key} = {_text(getattr(numbers, key))};" for key in one]
    for key, values in (("data", bounds), ("tangent", numbers.tangent), ("a", numbers.a)):
        lines.append(f"static const double {name}_{key}[{len(values)}] = {_row(values)};")
    kinds = ", ".join(map(str, numbers.onset_kind))
    lines.append(f"static const int {name}_onset_kind[2] = {{{kinds}}};")
    for key, rows in (("b", numbers.b), ("onset", numbers.onset)):
        inner = ",\n    ".join(_row(values) for values in rows)
        lines.append(f"static const double {name}_{key}[2][8] = {{\n    {inner}}};")
    return lines


def _row(values: Sequence[float]) -> str:
    return "{" + ", ".join(map(_text, values)) + "}"


def _text(value: float) -> str:
    """A number with all its digits."""
    return "HUGE_VAL" if math.isinf(value) else repr(float(value))

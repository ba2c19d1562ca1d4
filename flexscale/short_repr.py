"""Results as a few lines: what they are, and each attribute's value or size, and its meaning.

Meanings, with their units, are those of the class's docstring, which is the one place that has
them.
"""

from __future__ import annotations

import dataclasses
import inspect
import re
from typing import Any

import numpy as np

WIDTH = 100  # columns
MOST = 17  # attributes that are told


class ShortRepr:
    """A dataclass (with repr=False) whose repr is a few lines however large its arrays are."""

    def __repr__(self) -> str:
        meanings = _meanings(type(self))
        names = [field.name for field in dataclasses.fields(self)]  # type: ignore[arg-type]
        rows = [(name, _told(getattr(self, name)), meanings.get(name, "")) for name in names[:MOST]]
        left, middle = (max(len(row[column]) for row in rows) for column in (0, 1))
        lines = [f"{type(self).__name__}: {_summary(type(self))}"]
        lines += [f"  {name:<{left}}  {value:<{middle}}  {what}" for name, value, what in rows]
        if len(names) > MOST:
            lines.append(f"  and {len(names) - MOST} more: {', '.join(names[MOST:])}")
        return "\n".join(map(_cut, lines))


def _cut(line: str) -> str:
    line = line.rstrip()
    return line if len(line) <= WIDTH else f"{line[: WIDTH - 2].rstrip()} …"


def _told(value: Any) -> str:
    """A value of few characters, or what it is and how large."""
    if isinstance(value, np.ndarray) and value.size > 1:
        return f"array {value.shape}"
    if isinstance(value, (float, np.floating)):
        return f"{value:.6g}"
    if isinstance(value, (str, bool, int, np.generic, type(None))):
        return str(value)
    if isinstance(value, np.ndarray):
        return f"{value.item():.6g}" if value.size else f"array {value.shape}"
    if isinstance(value, (tuple, list, dict)):
        return f"{len(value)} of {type(value).__name__}"
    return type(value).__name__


def _summary(kind: type) -> str:
    return " ".join((inspect.getdoc(kind) or "").split("\n\n")[0].split())


def _meanings(kind: type) -> dict[str, str]:
    """Meaning of each attribute, from the docstring's lines "name, other : meaning"."""
    found: dict[str, str] = {}
    names: list[str] = []
    for line in (inspect.getdoc(kind) or "").partition("Attributes\n")[2].splitlines():
        entry = re.match(r"(\w+(?:, \w+)*) : (.*)", line)
        if entry:
            names = entry[1].split(", ")
            found |= dict.fromkeys(names, entry[2])
        elif line.startswith(" ") and names:
            found |= {name: f"{found[name]} {line.strip()}" for name in names}
    return found

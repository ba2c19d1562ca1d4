"""One tree of exceptions; each class knows the exit code of the command line.

Exit codes: 1 bug, 2 bad input, 4 data or a part of the system missing (a library, room on a disk,
memory, a process that was killed). A message is one clear sentence: what failed, the value with its
unit, where, and what to do about it.
"""

from __future__ import annotations

import builtins
import difflib
import reprlib
from collections.abc import Iterable
from typing import Any

LONGEST_LINE = 1000  # characters of a message's line; what is longer loses its middle
_LONGEST_VALUE = 60  # characters of a value that a message shows


class FlexScaleError(Exception):
    """Base of everything FlexScale raises on purpose.

    Whatever went into its message, it can be printed: no control characters, and no line of more
    than `LONGEST_LINE` characters.
    """

    exit_code: int = 1

    def __init__(self, *parts: object) -> None:
        super().__init__(*(_printable(item) if isinstance(item, str) else item for item in parts))


class BadInputError(FlexScaleError):
    """Something the user gave cannot be used; nothing was computed or written."""

    exit_code = 2


class PatternError(BadInputError):
    """Polygons, gap, sizes or materials do not make a scale pattern."""


class TilingError(BadInputError):
    """A tiling family, its shape parameters or its edge curves are not usable."""


class MeshError(BadInputError):
    """A mesh cannot be built with these options, or an invariant of a mesh is broken."""


class FabricationError(BadInputError):
    """A sheet cannot be printed with these sizes, grooves or printer limits."""


class UnitRangeError(BadInputError):
    """A physical value is not finite or lies outside its allowed range."""


class ConfigError(BadInputError):
    """An experiment file or an option contradicts its declaration."""


class UnknownNameError(BadInputError):
    """A name is not among the known ones; the message offers the closest."""


class MissingDataError(FlexScaleError):
    """No dataset answers the question."""

    exit_code = 4


class MissingSystemPartError(FlexScaleError):
    """A library or program outside Python is missing; the message names the remedy."""

    exit_code = 4


class DatasetError(FlexScaleError):
    """A stored dataset cannot be used."""

    exit_code = 4


class IntegrityError(DatasetError):
    """Stored bytes do not agree with their recorded digests, or cannot be read."""


class NonReproducibleError(DatasetError):
    """The same recipe gave different numbers than the stored dataset."""


class SchemaError(DatasetError):
    """A dataset does not have the variables, units or values its kind promises."""


def suggest(name: object, choices: Iterable[object], *, limit: int = 12) -> str:
    """Did-you-mean sentence for an unknown name.

    Parameters
    ----------
    name : what was asked for.
    choices : the known names, in any order.
    limit : number of names listed at most.

    Returns
    -------
    For instance ``"Did you mean 'hexagon'? Known: 'hexagon', 'square'."``
    """
    known = sorted({str(choice) for choice in choices})
    if not known:
        return "Nothing is known here yet."
    lower = {item.lower(): item for item in reversed(known)}
    asked = name[:_LONGEST_VALUE].lower() if isinstance(name, str) else shown(name)
    close = difflib.get_close_matches(asked, lower, n=3, cutoff=0.6)
    listed = ", ".join(repr(item) for item in known[:limit])
    if len(known) > limit:
        listed += f", … ({len(known)} in all)"
    if not close:
        return f"Known: {listed}."
    return f"Did you mean {' or '.join(repr(lower[item]) for item in close)}? Known: {listed}."


def shown(value: object) -> str:
    """A value as messages show it: on one line, and cut to a few words.

    Returns
    -------
    For instance ``"'closing'"``, ``"[0, 1, 2, 3, 4, 5, ...]"`` or ``"a number of 5000 digits"``.
    """
    return " ".join(_SHORT.repr(value).split())


class _Short(reprlib.Repr):
    """Short texts of anything, also of what has no text or an endless one."""

    def __init__(self) -> None:
        super().__init__()
        self.maxstring = self.maxother = self.maxlong = _LONGEST_VALUE
        self.maxdict = self.maxset = self.maxfrozenset = 4
        self.maxlevel = 3

    def repr_int(self, number: int, level: int) -> str:
        """Python itself refuses to write numbers of more than 4300 digits."""
        if abs(number) < 10**20:
            return builtins.repr(number)
        return f"a number of {int(number.bit_length() * 0.30103) + 1} digits"

    def repr_ndarray(self, array: Any, level: int) -> str:
        """Small arrays as lists, large ones by their shape."""
        if array.size > self.maxlist or array.dtype.names is not None:
            return f"an array of shape {array.shape}"
        return self.repr1(array.tolist(), level)

    def repr_Dataset(self, dataset: Any, level: int) -> str:
        """Datasets have long texts."""
        return "a dataset"

    def repr_DataArray(self, array: Any, level: int) -> str:
        """As what is in them."""
        return self.repr_ndarray(array.values, level)


_SHORT = _Short()


def _printable(text: str) -> str:
    """A message without control characters and without endless lines."""
    if not text.isprintable():
        text = "".join(c if c.isprintable() or c == "\n" else ascii(c)[1:-1] for c in text)
    if len(text) <= LONGEST_LINE:
        return text
    return "\n".join(map(_cut, text.split("\n")))


def _cut(line: str) -> str:
    if len(line) <= LONGEST_LINE:
        return line
    half = LONGEST_LINE // 2
    return f"{line[: half - 2]} … {line[1 - half :]}"

"""One tree of exceptions; each class knows the exit code of the command line.

Exit codes: 1 bug, 2 bad input, 4 data or a part of the system missing. A message is one clear
sentence: what failed, the value with its unit, where, and what to do about it.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class FlexScaleError(Exception):
    """Base of everything FlexScale raises on purpose."""

    exit_code: int = 1


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
    close = difflib.get_close_matches(str(name).lower(), lower, n=3, cutoff=0.6)
    listed = ", ".join(repr(item) for item in known[:limit])
    if len(known) > limit:
        listed += f", … ({len(known)} in all)"
    if not close:
        return f"Known: {listed}."
    return f"Did you mean {' or '.join(repr(lower[item]) for item in close)}? Known: {listed}."

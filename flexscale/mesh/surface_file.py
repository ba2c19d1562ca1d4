"""Surfaces of scales as files of other programs: which endings there are, and what goes wrong."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from flexscale.errors import BadInputError, suggest

SUFFIXES = (".obj", ".vtu")


@contextmanager
def surface_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """The path to write to, once it can be one; what the system refuses is told in a sentence.

    Raises
    ------
    BadInputError : another ending than .obj or .vtu, a folder that does not exist, or a file that
        cannot be written.
    """
    target = Path(path)
    if target.suffix not in SUFFIXES:
        raise BadInputError(
            f"The name of the file {target} must end in .obj or .vtu. "
            f"{suggest(target.suffix, SUFFIXES)}"
        )
    if not target.parent.is_dir():
        raise BadInputError(f"There is no folder {target.parent}: create it, or name another one.")
    try:
        yield target
    except OSError as error:
        raise BadInputError(f"{target} cannot be written: {error.strerror}.") from error

"""Files that somebody else may have made: read whole, without waiting, following or trusting."""

from __future__ import annotations

import errno
import json
import os
import stat
from pathlib import Path
from typing import Any, NoReturn

from flexscale.errors import IntegrityError

#: Levels that JSON of ours never reaches; Python's own functions give up at some 300 to 1000.
JSON_DEPTH = 50


def read_regular(path: Path, limit: int) -> bytes:
    """Contents of an ordinary file.

    Symbolic links are not followed, and pipes and devices not waited for: a folder from somebody
    else may hold them, and they lead outside of it or never end.

    Parameters
    ----------
    limit : largest size, bytes.

    Raises
    ------
    FileNotFoundError : there is nothing.
    IntegrityError : it is no ordinary file, too large, or cannot be read.
    """
    try:
        handle = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    except FileNotFoundError:
        raise
    except OSError as error:
        if error.errno == errno.ELOOP:
            raise IntegrityError(
                f"{path} is a symbolic link, which may lead anywhere: put the file itself there."
            ) from error
        raise IntegrityError(f"{path} cannot be read: {error.strerror}.") from error
    try:
        facts = os.fstat(handle)
        if not stat.S_ISREG(facts.st_mode):
            raise IntegrityError(f"{path} is no ordinary file, but a folder, a pipe or a device.")
        if facts.st_size > limit:
            raise IntegrityError(f"{path} has {facts.st_size} bytes; {limit} are the most.")
        with os.fdopen(handle, "rb", closefd=False) as file:
            return file.read(limit)
    except OSError as error:
        raise IntegrityError(f"{path} cannot be read: {error.strerror}.") from error
    finally:
        os.close(handle)


def parse_json(text: str | bytes, *, finite: bool = True) -> Any:
    """Data of JSON text.

    Parameters
    ----------
    finite : refuse NaN and Infinity, which JSON does not know.

    Raises
    ------
    ValueError : not UTF-8, not JSON, deeper than JSON_DEPTH, or with numbers that are not finite.
    """
    try:
        data = json.loads(text, parse_constant=_refuse if finite else None)
    except RecursionError:
        raise ValueError("it is nested too deep") from None
    level = [data]
    for _ in range(JSON_DEPTH):
        level = [
            item
            for outer in level
            if isinstance(outer, list | dict)
            for item in (outer.values() if isinstance(outer, dict) else outer)
        ]
        if not level:
            return data
    raise ValueError("it is nested too deep")


def _refuse(name: str) -> NoReturn:
    raise ValueError(f"it holds {name}, which is no number")

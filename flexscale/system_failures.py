"""What the machine refuses (disk full, folder not writable, no memory), as sentences."""

from __future__ import annotations

import errno
import os
import re

from flexscale.errors import FlexScaleError

_ANOTHER_DISK = "free some space there, or choose another disk with --results"
_ANOTHER_FOLDER = "choose a folder that can be written, with --results or --out"
_LESS = "give it fewer processes (--cores), a coarser mesh, or more memory"
_DISK_FAILS = "look after that disk, or choose another one with --results"
#: Errors that are the machine's, not ours -> what to do.
_REMEDIES = {
    errno.ENOSPC: _ANOTHER_DISK,
    errno.EDQUOT: _ANOTHER_DISK,
    errno.EFBIG: "files may not become that large (ulimit -f): raise the limit",
    errno.EROFS: _ANOTHER_FOLDER,
    errno.EACCES: _ANOTHER_FOLDER,
    errno.EPERM: _ANOTHER_FOLDER,
    errno.ENOTDIR: _ANOTHER_FOLDER,
    errno.ELOOP: _ANOTHER_FOLDER,
    errno.ENAMETOOLONG: "choose a shorter one",
    errno.ENOMEM: _LESS,
    errno.EAGAIN: "raise the limit of processes (ulimit -u)",
    errno.EMFILE: "raise the limit of open files (ulimit -n)",
    errno.ENFILE: "end what holds so many files open",
    errno.EIO: _DISK_FAILS,
    errno.ESTALE: _DISK_FAILS,
    errno.ETIMEDOUT: _DISK_FAILS,
}


class SystemFailureError(FlexScaleError):
    """The machine refuses something: a disk is full, a folder not writable, memory short."""

    exit_code = 4


def require_memory(needed: float, what: str, remedy: str) -> None:
    """Refuse what takes more memory than is free.

    Parameters
    ----------
    needed : GB, by estimate.
    what, remedy : beginning and end of the sentence.

    Raises
    ------
    SystemFailureError : with both numbers.
    """
    # Loaded when it is asked for, so that asking for help stays quick.
    import psutil

    free = psutil.virtual_memory().available / 1e9
    if needed > free:
        raise SystemFailureError(
            f"{what} would take about {needed:.2g} GB of memory, but {free:.2g} GB are free: "
            f"{remedy}."
        )


#: Errors by which libraries tell what the machine refuses; the text of others may be a user's.
_TELLING = (OSError, RuntimeError, ImportError, SystemError)
#: What they say, in lower case, where memory is short.
_NO_MEMORY_WORDS = (
    "bad_alloc",
    "cannot allocate memory",
    "can't start new thread",
    "failed to map segment",
    "out of memory",
)
_NO_MEMORY = f"There is not enough memory: {_LESS}."
#: How the line of a log begins that tells of an exception: its name, with its modules.
_EXCEPTION = re.compile(r"(?:\w+\.)*(\w*(?:Error|Exception))(?=:|$)")


def explain(error: BaseException) -> SystemFailureError | None:
    """The error as a sentence on the machine, None where it is no such error."""
    if isinstance(error, OSError) and error.errno in _REMEDIES:
        where = f"{error.filename}: " if error.filename else ""
        return SystemFailureError(f"{where}{error.strerror}; {_REMEDIES[error.errno]}.")
    if isinstance(error, MemoryError):
        return SystemFailureError(_NO_MEMORY)
    # The text of an error with a number holds the file's name too.
    words = getattr(error, "strerror", None) or str(error)
    told = _explain_line(words) if isinstance(error, _TELLING) else None
    return SystemFailureError(told) if told else None


def explain_words(text: str) -> str | None:
    """A sentence on the machine for the last lines of a log, None where they tell no such thing."""
    names = {kind.__name__ for kind in _TELLING}
    for line in map(str.strip, text.splitlines()):
        exception = _EXCEPTION.match(line)
        if exception and exception[1].endswith("MemoryError"):
            return _NO_MEMORY
        if exception is None or exception[1] in names:
            told = _explain_line(line)
            if told:
                return told
    return None


def _explain_line(line: str) -> str | None:
    """The sentence for what a library or the system said, None where it is nothing known."""
    if any(words in line.lower() for words in _NO_MEMORY_WORDS):
        return _NO_MEMORY
    if "no locator available for file" in line:
        return (
            "There is no folder for compiled kernels that can be written: name one by the "
            "environment variable NUMBA_CACHE_DIR."
        )
    if os.strerror(errno.ENOSPC).lower() in line.lower():
        return f"The disk is full: {_ANOTHER_DISK}."
    return None

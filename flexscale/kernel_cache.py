"""Where numba keeps compiled kernels: one folder for each state of what they are compiled from.

Of a kernel on disk numba checks the one file that defines it. A kernel is also made of those that
it calls and of the types that it takes, in other files: after a change of those it would be
outdated, and numba cannot even read an index that names a type which has moved.
"""

from __future__ import annotations

import hashlib
import os
import stat
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path

_VARIABLE = "NUMBA_CACHE_DIR"
_PREFIX = "kernels-"
#: Rooms with kernels. With the modules of floor 0 they hold all that kernels are compiled from.
KERNEL_ROOMS = ("embedding", "macro", "mechanics", "solve")
_COMPILERS = ("numba", "llvmlite", "numpy")
_KEPT_SECONDS = 24 * 3600.0  # s for which kernels of other sources stay after their last use


def provide_kernel_cache() -> None:
    """Name this state's folder to numba, and remove folders that are out of use.

    It is in NUMBA_CACHE_DIR, else beside the sources, else in the user's cache folder. A machine
    may let us write to none of them (an installation of somebody else's, and no home), where numba
    would refuse to load kernels: then it is in a private temporary folder.
    """
    place = next((folder for folder in _places() if can_be_written(folder)), None)
    try:
        place = place or _private_folder()
    except OSError:  # numba says so when it loads; see `system_failures`
        return
    folder = place / f"{_PREFIX}{kernel_state(Path(__file__).parent)}"
    os.environ[_VARIABLE] = str(folder)
    if "numba" in sys.modules:  # which has read its settings already
        sys.modules["numba"].config.CACHE_DIR = str(folder)
    if folder.is_dir():
        with suppress(OSError):
            os.utime(folder)
    else:
        _remove_unused(place)


def kernel_sources(package: Path) -> list[Path]:
    """Files of the package that kernels are compiled from, sorted."""
    rooms = (package, *(package / room for room in KERNEL_ROOMS))
    return sorted(path for room in rooms for path in room.glob("*.py"))


def kernel_state(package: Path) -> str:
    """Digest of all that kernels are compiled from, and of the installation that compiles them."""
    state = hashlib.blake2b(digest_size=6)
    for source in kernel_sources(package):
        state.update(f"{source.relative_to(package)}\n".encode())
        state.update(source.read_bytes())
    for name in _COMPILERS:  # versions from their metadata would take ten times as long
        found = find_spec(name)
        if found is not None and found.origin is not None:
            facts = os.stat(found.origin)
            state.update(f"{name} {facts.st_mtime_ns} {facts.st_size}\n".encode())
    return state.hexdigest()


def _places() -> Iterator[Path]:
    """Where kernels may be kept, the first choice first."""
    if os.environ.get(_VARIABLE):
        given = Path(os.environ[_VARIABLE])
        # A parent process has named its own folder for us already.
        yield given.parent if given.name.startswith(_PREFIX) else given
    yield Path(__file__).parent / "__pycache__"
    yield user_cache() / "flexscale"


def _remove_unused(place: Path) -> None:
    """Remove kernels of other sources, but for those that another process may still run."""
    import shutil  # costs more time than all of this module

    with suppress(OSError):
        for folder in place.glob(f"{_PREFIX}*"):
            if time.time() - folder.stat().st_mtime > _KEPT_SECONDS:
                shutil.rmtree(folder, ignore_errors=True)


def user_cache() -> Path:
    """The user's folder for what programs can make again, whether or not it can be written."""
    return Path(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"))


def can_be_written(folder: Path) -> bool:
    """Whether files can be put into a folder, which may have to be made."""
    # Without a home "~" stays "~", which would be a folder in whatever place we are called from.
    there = folder
    try:
        while not there.exists() and there != there.parent:
            there = there.parent
        return folder.is_absolute() and there.is_dir() and os.access(there, os.W_OK | os.X_OK)
    except OSError:
        return False


def _private_folder() -> Path:
    """Ours alone: whoever could write there could have us run what they like."""
    import tempfile  # which loads much that reading a dataset does not need

    folder = Path(tempfile.gettempdir()) / f"flexscale-kernels-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    facts = folder.lstat()
    if stat.S_ISDIR(facts.st_mode) and facts.st_uid == os.getuid() and not facts.st_mode & 0o077:
        return folder
    return Path(tempfile.mkdtemp(prefix="flexscale-kernels-"))

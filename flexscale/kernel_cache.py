"""A place for compiled kernels, without which numba refuses to load them."""

from __future__ import annotations

import os
import stat
import tempfile
from pathlib import Path

_VARIABLE = "NUMBA_CACHE_DIR"


def provide_kernel_cache() -> None:
    """Name a private folder for kernels where numba would find none; before numba is imported.

    It looks in NUMBA_CACHE_DIR, beside the sources, and in the user's cache folder. A machine may
    let us write to none of them: an installation of somebody else's, and no home.
    """
    if any(can_be_written(folder) for folder in _where_numba_looks()):
        return
    try:
        os.environ[_VARIABLE] = str(_private_folder())
    except OSError:  # numba says so when it loads; see `system_failures`
        return


def _where_numba_looks() -> list[Path]:
    folders = [Path(__file__).parent / "mechanics" / "__pycache__"]
    if os.environ.get(_VARIABLE):
        folders.append(Path(os.environ[_VARIABLE]))
    return [*folders, user_cache()]


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
    folder = Path(tempfile.gettempdir()) / f"flexscale-kernels-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    facts = folder.lstat()
    if stat.S_ISDIR(facts.st_mode) and facts.st_uid == os.getuid() and not facts.st_mode & 0o077:
        return folder
    return Path(tempfile.mkdtemp(prefix="flexscale-kernels-"))

"""Locks that die with their process, and working folders that outlive it only as garbage.

A lock is `flock`. Some shared disks of clusters have none; there it is a folder that holds one
file named by its owner: moving a folder onto another succeeds for one process only, and only while
there is none or an empty one. What a killed process leaves is taken over where that process is
provably gone, on the same machine, and otherwise named together with who left it.
"""

from __future__ import annotations

import errno
import fcntl
import os
import shutil
import time
import uuid
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from flexscale.datasets.owner import Owner
from flexscale.errors import DatasetError

STAGING = ".staging"
_OWNED = "write-"
_WAIT_SECONDS = 60.0
#: How disks say that they have no `flock`.
_NO_FLOCK = {errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP, errno.ENOTSUP, errno.EINVAL}


class LockedError(DatasetError):
    """Another process has the lock."""


@contextmanager
def layer_lock(layer: Path) -> Iterator[None]:
    """Exclusive access to the shared files of a results layer; held for moments only.

    Raises
    ------
    LockedError : another process held it for a minute.
    """
    layer.mkdir(parents=True, exist_ok=True)
    with file_lock(layer / ".lock", _WAIT_SECONDS, _tell_locked):
        yield


def _tell_locked(path: Path, owner: str) -> str:
    return (
        f"{path} has been locked by {owner} for {_WAIT_SECONDS:.0f} s: end that process (it may be "
        "stopped), then run again."
    )


@contextmanager
def file_lock(path: Path, patience: float, tell: Callable[[Path, str], str]) -> Iterator[None]:
    """Hold the lock of a path, whose folder exists.

    Parameters
    ----------
    path : its file; on disks without `flock`, the lock is the folder `path` + ".owner".
    patience : seconds to wait for it.
    tell : sentence for the path and who holds it, such as "process 12 on host".

    Raises
    ------
    LockedError : another process held it all the time.
    """
    handle = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666)
    me, deadline = Owner.of_this_process(), time.monotonic() + patience
    try:
        while (holder := _take(handle, path, me)) is not None:
            if time.monotonic() >= deadline:
                raise LockedError(tell(*holder))
            time.sleep(0.01)
        with suppress(OSError):  # a full disk: only the name of the holder is lost
            os.truncate(handle, 0)
            os.pwrite(handle, me.token.encode(), 0)
        try:
            yield
        finally:
            with suppress(OSError):  # not there where the disk has `flock`
                (_folder(path) / me.token).unlink()
                _folder(path).rmdir()
    finally:
        os.close(handle)  # releases the lock


def _folder(path: Path) -> Path:
    """What is the lock on disks without `flock`."""
    return path.with_name(f"{path.name}.owner")


def _take(handle: int, path: Path, me: Owner) -> tuple[Path, str] | None:
    """None when the lock is ours; else where it is and who holds it."""
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        token = os.pread(handle, 200, 0).decode(errors="replace")
        return path, str(Owner.parse(token) or "another process")
    except OSError as error:
        if error.errno not in _NO_FLOCK:
            raise
        return _take_folder(_folder(path), me)
    # Another machine may see the same disk without `flock`.
    holder = _live_holder(_folder(path))
    if holder is not None:
        fcntl.flock(handle, fcntl.LOCK_UN)
    return holder


def _take_folder(folder: Path, me: Owner) -> tuple[Path, str] | None:
    """As `_take`, where there is no `flock`."""
    for _ in range(2):  # a second time where the first removed what a killed process left
        if _moved_into_place(folder, me):
            # Of those killed before they could move theirs.
            _remove_abandoned(folder.parent, f"{folder.name}.")
            return None
        if (holder := _live_holder(folder)) is not None:
            return holder
    return folder, "a process that has just ended"


def _moved_into_place(folder: Path, me: Owner) -> bool:
    """Whether our folder is now the one; not while another is there with its owner's file."""
    private = folder.with_name(f"{folder.name}.{me.token}~{uuid.uuid4().hex}")
    private.mkdir()
    (private / me.token).touch()
    try:
        os.rename(private, folder)
    except OSError as error:
        shutil.rmtree(private, ignore_errors=True)
        if error.errno not in (errno.EEXIST, errno.ENOTEMPTY):
            raise
        return False
    return True


def _live_holder(folder: Path) -> tuple[Path, str] | None:
    """Who is in the folder, None after removing those that are provably gone."""
    try:
        tokens = os.listdir(folder)
    except FileNotFoundError:
        return None
    for token in tokens:
        owner = Owner.parse(token)
        if owner is None or not owner.is_gone:
            return folder, f"{owner or 'an unknown process'} (if it is gone, remove {folder.name})"
        # The file of this one owner: nobody else's claim can be lost.
        with suppress(FileNotFoundError):
            (folder / token).unlink()
    return None


@contextmanager
def working_folder(layer: Path) -> Iterator[Path]:
    """Fresh folder on the layer's disk, removed at the end.

    What a killed process leaves is removed by the next one on the same machine: the folder's name
    says whose it is.
    """
    with layer_lock(layer):
        staging = layer / STAGING
        staging.mkdir(exist_ok=True)
        _remove_abandoned(staging, _OWNED)
        folder = staging / f"{_OWNED}{Owner.of_this_process().token}~{uuid.uuid4().hex[:8]}"
        folder.mkdir()
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _remove_abandoned(parent: Path, prefix: str) -> None:
    """Delete folders named by owners that are provably gone."""
    for folder in parent.glob(f"{prefix}*~*"):
        owner = Owner.parse(folder.name.removeprefix(prefix).partition("~")[0])
        if owner is not None and owner.is_gone:
            shutil.rmtree(folder, ignore_errors=True)

"""Locks that die with their process, and working folders that outlive it only as garbage."""

from __future__ import annotations

import fcntl
import os
import shutil
import time
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from flexscale.errors import DatasetError

STAGING = ".staging"
_OWNED = "write-"
_WAIT_SECONDS = 60.0


@contextmanager
def layer_lock(layer: Path) -> Iterator[None]:
    """Exclusive access to the shared files of a results layer; held for moments only.

    Raises
    ------
    DatasetError : another process held it for a minute.
    """
    layer.mkdir(parents=True, exist_ok=True)
    path = layer / ".lock"
    handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
    try:
        deadline = time.monotonic() + _WAIT_SECONDS
        while not _try_lock(handle):
            if time.monotonic() > deadline:
                raise DatasetError(
                    f"{path} has been locked by another process for {_WAIT_SECONDS:.0f} s: "
                    "end that process (it may be stopped), then run again."
                )
            time.sleep(0.01)
        yield
    finally:
        os.close(handle)  # releases the lock


def _try_lock(handle: int) -> bool:
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


@contextmanager
def working_folder(layer: Path) -> Iterator[Path]:
    """Fresh folder on the layer's disk, removed at the end.

    What a killed process leaves is removed by the next one: every working folder holds a file
    that its owner keeps locked, and creation and clean-up exclude each other.
    """
    with layer_lock(layer):
        staging = layer / STAGING
        staging.mkdir(exist_ok=True)
        remove_abandoned(staging)
        folder = staging / f"{_OWNED}{uuid.uuid4().hex}"
        folder.mkdir()
        handle = os.open(folder / "owner", os.O_RDWR | os.O_CREAT, 0o666)
        fcntl.flock(handle, fcntl.LOCK_EX)
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        os.close(handle)


def remove_abandoned(staging: Path) -> None:
    """Delete working folders whose owner is gone; call it under `layer_lock`."""
    for folder in staging.glob(f"{_OWNED}*"):
        try:
            handle = os.open(folder / "owner", os.O_RDWR)
        except FileNotFoundError:
            shutil.rmtree(folder, ignore_errors=True)  # killed between creation and locking
            continue
        try:
            if _try_lock(handle):
                shutil.rmtree(folder, ignore_errors=True)
        finally:
            os.close(handle)

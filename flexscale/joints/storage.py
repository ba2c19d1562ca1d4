"""Solved joints as small files: those that ship with the package, and those kept on this machine.

A file appears whole or not at all. One that cannot be read, or is of another key, is as none.
"""

from __future__ import annotations

import json
import logging
import os
import tempfile
import zipfile
import zlib
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from flexscale.errors import BadInputError
from flexscale.joints.compute import SolvedJoint
from flexscale.joints.key import JointKey
from flexscale.kernel_cache import can_be_written, user_cache

log = logging.getLogger(__name__)

#: What numpy and zlib raise of files that are damaged, or are something else.
_DAMAGE = (OSError, ValueError, KeyError, EOFError, TypeError, AttributeError, zlib.error,
           zipfile.BadZipFile, BadInputError)  # fmt: skip
SHIPPED = Path(__file__).with_name("data")
#: States are for figures, and kept in single precision; the law itself is kept in double.
_TYPES = {
    "exponents": "int8", "coefficients": "float64", "errors": "float64", "mesh_errors": "float64",
    "poses": "float32", "energies": "float32", "forces": "float32", "held_out": "bool",
    "n_missing": "int64",
}  # fmt: skip
_LOADED = {"int8": "int64", "float32": "float64"}


def kept_folder() -> Path:
    """The user's folder of joints that were computed here."""
    return user_cache() / "flexscale" / "joints"


def load_joint(key: JointKey) -> SolvedJoint | None:
    """A joint that ships with the package or was computed here; None if there is none."""
    for folder in (SHIPPED, kept_folder()):
        path = folder / _file_name(key)
        try:
            found = _read(path, key)
        except FileNotFoundError:
            continue
        except _DAMAGE as error:
            log.warning("%s cannot be read and is made again: %s", path, error)
            continue
        if found is not None:
            return found
        log.warning("%s is of another joint and is made again", path)
    return None


def keep_joint(joint: SolvedJoint) -> None:
    """Keep a joint for the next time, where the user's folder can be written."""
    folder = kept_folder()
    if not can_be_written(folder):
        log.warning("%s cannot be written: the joint is computed again next time.", folder)
        return
    try:
        write_joint(joint, folder)
    except OSError as error:
        log.warning("%s cannot be written (%s): the joint is computed again.", folder, error)


def write_joint(joint: SolvedJoint, folder: Path) -> Path:
    """Write a joint's file into a folder, which is made."""
    folder.mkdir(parents=True, exist_ok=True)
    arrays: dict[str, Any] = {
        name: np.asarray(getattr(joint, name), dtype=kind) for name, kind in _TYPES.items()
    }
    path = folder / _file_name(joint.key)
    descriptor, unfinished = tempfile.mkstemp(prefix=".joint-", suffix=".npz", dir=folder)
    try:
        with os.fdopen(descriptor, "wb") as file:
            np.savez_compressed(file, key=json.dumps(asdict(joint.key)), **arrays)
        os.chmod(unfinished, 0o644)
        os.replace(unfinished, path)
    except BaseException:
        Path(unfinished).unlink(missing_ok=True)
        raise
    return path


def _file_name(key: JointKey) -> str:
    return f"joint_{key.digest}.npz"


def _read(path: Path, key: JointKey) -> SolvedJoint | None:
    with np.load(path, allow_pickle=False) as file:
        if str(file["key"]) != json.dumps(asdict(key)):
            return None
        arrays = {name: file[name].astype(_LOADED.get(kind, kind)) for name, kind in _TYPES.items()}
    n_missing = int(arrays.pop("n_missing"))
    found = SolvedJoint(key=key, n_missing=n_missing, **arrays)
    found.law(1.0, 1.0)  # checks its arrays
    return found

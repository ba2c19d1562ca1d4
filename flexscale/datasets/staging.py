"""Unfinished work on disk: sample-by-sample checkpoints, and files that appear whole or not."""

from __future__ import annotations

import io
import json
import logging
import os
import shutil
import struct
import uuid
import zipfile
import zlib
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np

from flexscale.datasets.untrusted import parse_json, read_regular
from flexscale.errors import BadInputError, IntegrityError

logger = logging.getLogger(__name__)

_LARGEST_SAMPLE = 2**30  # bytes
#: What zip files, numpy's arrays and JSON raise when they are not what they should be.
_DAMAGE = (
    *(IntegrityError, OSError, RuntimeError, ValueError, TypeError, AttributeError, LookupError),
    *(EOFError, MemoryError, ArithmeticError, SyntaxError, zipfile.BadZipFile, zlib.error),
    struct.error,
)


class FileCheckpoint:
    """Finished samples of a sweep, one file each, below `folder/<line>/`.

    Picklable. A line is one (side, direction); its samples are numbered in the order in which
    they were appended. One process works on a line at a time; should two do, they write the same
    numbers to the same files. Get one from `Store.checkpoint`.
    """

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        self._counts: dict[str, int] = {}

    def load(
        self, line_key: str, fits: Callable[[int, dict[str, Any]], bool] = lambda *_: True
    ) -> list[dict[str, Any]]:
        """Samples of the line in their order, bit for bit as appended; [] when there are none.

        What a kill left half written, or does not fit its number, is removed with all that
        follows it, which went on from there.
        """
        samples: list[dict[str, Any]] = []
        while (sample := _read_sample(self._path(line_key, len(samples)))) is not None:
            if not fits(len(samples), sample):
                path = self._path(line_key, len(samples))
                logger.warning("%s is of something else: it and what follows are redone", path)
                break
            samples.append(sample)
        self._counts[line_key] = len(samples)
        self._forget_behind(line_key)
        return samples

    def _forget_behind(self, line_key: str) -> None:
        first = self._path(line_key, self._counts[line_key])
        for path in first.parent.glob("*.npz"):
            if path.name >= first.name:
                shutil.rmtree(path) if path.is_dir() else path.unlink(missing_ok=True)

    def append(self, line_key: str, sample: Mapping[str, Any]) -> None:
        """Store one more sample of the line, atomically.

        `sample` may hold numbers, text, bool, None, numpy arrays, and lists or dicts of them.
        """
        data = _pack(sample)
        if line_key not in self._counts:
            self.load(line_key)
        path = self._path(line_key, self._counts[line_key])
        path.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(path, lambda file: file.write_bytes(data))
        self._counts[line_key] += 1

    @property
    def has_samples(self) -> bool:
        """Whether samples of any line are there."""
        return any(self.folder.rglob("*"))

    def clear(self) -> None:
        """Forget every sample (called when the finished dataset is published)."""
        shutil.rmtree(self.folder, ignore_errors=True)
        self._counts.clear()

    def _path(self, line_key: str, index: int) -> Path:
        # The prefix keeps keys such as ".." from being paths.
        return self.folder / f"line-{quote(line_key, safe='')}" / f"{index:06d}.npz"


def _pack(sample: Mapping[str, Any]) -> bytes:
    """Bytes of a sample: structure as JSON, arrays beside it; each zip member has a checksum."""
    arrays: dict[str, np.ndarray] = {}
    text = json.dumps(_split(dict(sample), arrays))
    buffer = io.BytesIO()
    np.savez(buffer, allow_pickle=False, structure=np.frombuffer(text.encode(), np.uint8), **arrays)
    return buffer.getvalue()


def _split(value: Any, arrays: dict[str, np.ndarray]) -> Any:
    """JSON-able copy in which arrays are replaced by their names; floats survive exactly."""
    if isinstance(value, np.ndarray):
        if value.dtype.kind not in "biufcU":
            raise BadInputError(f"A sample cannot hold an array of type {value.dtype}.")
        name = f"array{len(arrays)}"
        arrays[name] = value
        return {"array": name}
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, dict):
        return {"dict": [[str(key), _split(item, arrays)] for key, item in value.items()]}
    if isinstance(value, list | tuple):
        return [_split(item, arrays) for item in value]
    if value is None or isinstance(value, bool | int | float | str):
        return value
    raise BadInputError(f"A sample cannot hold a {type(value).__name__} ({value!r}).")


def _join(value: Any, arrays: Any) -> Any:
    if isinstance(value, dict):
        if "array" in value:
            return arrays[value["array"]]
        return {key: _join(item, arrays) for key, item in value["dict"]}
    if isinstance(value, list):
        return [_join(item, arrays) for item in value]
    return value


def _read_sample(path: Path) -> dict[str, Any] | None:
    """Sample in a file, None when the file is missing or damaged."""
    try:
        return _unpack(read_regular(path, _LARGEST_SAMPLE))
    except FileNotFoundError:
        return None
    except _DAMAGE as error:
        logger.warning("%s is damaged (%.100s): it and what follows are computed anew", path, error)
        return None


def _unpack(data: bytes) -> dict[str, Any]:
    """Inverse of `_pack`; nothing is unpickled, and nothing grows beyond the size of its file."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        for member in archive.infolist():
            if member.compress_type != zipfile.ZIP_STORED or member.file_size > len(data):
                raise ValueError("it holds compressed data, which are never written")
    with np.load(io.BytesIO(data), allow_pickle=False) as stored:
        structure = parse_json(stored["structure"].tobytes(), finite=False)
        sample = _join(structure, stored)
    if not isinstance(sample, dict):
        raise ValueError("it holds no sample")
    return sample


def require_free(paths: Iterable[Path], replace: bool) -> None:
    """Refuse to write over files that a user may still want; ask before the work begins.

    All commands that write files where a user says treat what is there in this one way.

    Parameters
    ----------
    replace : whether the user said that they may be replaced.

    Raises
    ------
    BadInputError : one of them is there and may not be replaced.
    """
    present = [path for path in paths if os.path.lexists(path)]
    if present and not replace:
        others = f", and {len(present) - 1} more that would be written" if present[1:] else ""
        raise BadInputError(
            f"{present[0]} is there already{others}: name another place to write to, "
            "or replace what is there by --force (replace=True in Python)."
        )


def write_atomically(path: Path, write: Callable[[Path], object]) -> None:
    """Let `write` fill a new file, then move it onto `path`, safe against power loss."""
    temporary = path.with_name(f".{path.name}.{uuid.uuid4().hex}.part")
    try:
        write(temporary)
        sync(temporary)
        os.replace(temporary, path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
    sync(path.parent)


def sync(path: Path) -> None:
    """Wait until a file's contents, or a folder's names, are on the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)

"""catalog.csv: a cache of all record.json files of a layer, so that queries open no file.

Deleting it loses nothing. On opening, the folders on disk are listed (names only) and compared
with it; records that it lacks are read, rows without a folder are dropped.
"""

from __future__ import annotations

import csv
import io
import logging
import os
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from flexscale.datasets.entry import COLUMNS, Entry, is_sound_row, row_of_record
from flexscale.datasets.identity import SHORT_DIGEST
from flexscale.datasets.locks import layer_lock
from flexscale.datasets.record import read_record
from flexscale.datasets.schema import SCHEMAS
from flexscale.datasets.staging import write_atomically
from flexscale.datasets.untrusted import read_regular
from flexscale.errors import BadInputError, DatasetError, IntegrityError

logger = logging.getLogger(__name__)

CATALOG_FILE = "catalog.csv"
_LARGEST_CATALOG = 2**30  # bytes


@dataclass(frozen=True)
class Catalog:
    """Datasets of one layer, sorted by path, and sentences on folders that cannot be read."""

    entries: tuple[Entry, ...]
    damaged: tuple[str, ...]


def results_folder(root: str | Path) -> Path:
    """`root` as a path, if it can be a results folder.

    Raises
    ------
    BadInputError : it is a layer of one; the message names the folder to give.
    """
    path = Path(root)
    if (path / CATALOG_FILE).is_file() or list_folders(path):
        parent = path.parent if path.name not in ("", "..") else path.resolve().parent
        raise BadInputError(
            f"{path} holds datasets itself: it is one layer of a results folder, such as "
            f"'reference' or 'local'. Give the folder around it, {parent}."
        )
    return path


def read_catalog(layer: Path) -> Catalog:
    """Datasets of a layer, from its catalog as far as that is right; writes nothing."""
    rows, damaged, _ = _reconciled(layer, changed=())
    entries = tuple(Entry.from_row(row, layer) for _, row in sorted(rows.items()))
    return Catalog(entries, tuple(damaged))


def update_catalog(layer: Path, changed: Collection[str] = (), *, rebuild: bool = False) -> None:
    """Bring catalog.csv up to date, if that is possible.

    Parameters
    ----------
    layer : the folder that holds it.
    changed : paths (from the layer) of datasets whose rows must be read again.
    rebuild : read every record again.

    A cache that cannot be written (read-only disk, lock held) is only worth a log message.
    """
    try:
        with layer_lock(layer):
            rows, _, stale = _reconciled(layer, changed=changed, rebuild=rebuild)
            if stale:
                path = layer / CATALOG_FILE
                for abandoned in layer.glob(f".{CATALOG_FILE}.*"):
                    abandoned.unlink()  # of a killed process: only holders of the lock make them
                write_atomically(path, lambda file: _write_rows(file, rows))
    except (OSError, DatasetError) as error:
        logger.warning("%s was not updated: %s", layer / CATALOG_FILE, error)


def list_folders(layer: Path) -> list[str]:
    """Paths kind/family/pattern/digest below the layer, with slashes; opens no file.

    Symbolic links are left out: they may lead anywhere.
    """
    found = [kind for kind in _subfolders(layer) if kind in SCHEMAS]
    for _ in range(3):
        found = [f"{parent}/{name}" for parent in found for name in _subfolders(layer / parent)]
    return sorted(path for path in found if len(path.rsplit("/", 1)[1]) == SHORT_DIGEST)


def linked_folders(layer: Path) -> list[str]:
    """Paths of the symbolic links that stand where folders of datasets, or their parents, would."""
    found, parents = [], [""]
    for depth in range(4):
        below = []
        for parent in parents:
            names = sorted(path.name for path in (layer / parent).glob("*") if path.is_symlink())
            found += [f"{parent}{name}" for name in names if depth or name in SCHEMAS]
            below += [f"{parent}{name}/" for name in _subfolders(layer / parent)]
        parents = below if depth else [path for path in below if path[:-1] in SCHEMAS]
    return found


def lies_within(folder: Path, layer: Path) -> bool:
    """Whether no symbolic link leads from the layer to the folder."""
    return folder.resolve() == layer.resolve() / folder.relative_to(layer)


def _subfolders(folder: Path) -> list[str]:
    try:
        with os.scandir(folder) as items:
            return [
                item.name
                for item in items
                if item.is_dir(follow_symlinks=False) and item.name[0] != "."
            ]
    except OSError:  # not there, removed by someone else meanwhile, or not for us
        return []


def _reconciled(
    layer: Path, *, changed: Collection[str], rebuild: bool = False
) -> tuple[dict[str, dict[str, Any]], list[str], bool]:
    """Rows by path, sentences on damaged folders, and whether catalog.csv differs from them."""
    stored = {} if rebuild else _read_rows(layer / CATALOG_FILE)
    folders = list_folders(layer)
    rows: dict[str, dict[str, Any]] = {}
    damaged: list[str] = []
    fresh = rebuild
    for path in folders:
        if path in stored and path not in changed:
            rows[path] = stored[path]
            continue
        fresh = True
        try:
            rows[path] = row_of_record(read_record(layer / path), path)
        except DatasetError as error:
            if (layer / path).is_dir():
                damaged.append(str(error))
    return rows, damaged, fresh or rows.keys() != stored.keys()


def _read_rows(path: Path) -> dict[str, dict[str, Any]]:
    """Rows of a catalog by path, as far as they can be true; {} when it has other columns."""
    convert = [(name, _CONVERTERS[kind]) for name, (kind, _) in COLUMNS.items()]
    rows = {}
    try:
        text = read_regular(path, _LARGEST_CATALOG).decode("utf-8")
        reader = csv.reader(io.StringIO(text, newline=""))
        if next(reader, None) != _header():
            return {}
        for line in reader:
            row = {name: to(text) for (name, to), text in zip(convert, line, strict=True)}
            if is_sound_row(row):
                rows[row["path"]] = row
    except (OSError, IntegrityError, ValueError, csv.Error):
        return {}
    return rows


def _header() -> list[str]:
    return [f"{name} [{unit}]" if unit else name for name, (_, unit) in COLUMNS.items()]


def _number(text: str) -> float | None:
    return float(text) if text else None


def _count(text: str) -> int | None:
    return int(text) if text else None


_CONVERTERS: Mapping[type, Any] = {str: str, float: _number, int: _count}


def _write_rows(path: Path, rows: Mapping[str, Mapping[str, Any]]) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(_header())
        for _, row in sorted(rows.items()):
            writer.writerow(["" if row[name] is None else row[name] for name in COLUMNS])

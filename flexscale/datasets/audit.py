"""Is everything below the results folder what it claims to be?"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from flexscale.datasets.catalog import linked_folders, list_folders
from flexscale.datasets.entry import Entry
from flexscale.datasets.files import entry_of_folder, load_entry
from flexscale.datasets.identity import Recipe, content_digest
from flexscale.datasets.locks import STAGING
from flexscale.datasets.record import read_record
from flexscale.datasets.registry import open_registry
from flexscale.errors import DatasetError, IntegrityError


@dataclass(frozen=True)
class Finding:
    """One sentence on one thing; `level` is "ok", "note" or "problem"."""

    level: str
    subject: str
    message: str


def check_results(root: str | Path = "results") -> Iterator[Finding]:
    """Verify every dataset below `root` anew, yielding findings as they come.

    Problems: missing or damaged files, digests that do not agree, a broken schema, an input whose
    content changed. Notes: inputs that are not here, results of uncommitted code, unfinished work.
    """
    registry = open_registry(root)
    published = {entry.id: entry for entry in registry}
    for layer in (registry.root / "local", registry.root / "reference"):
        for path in list_folders(layer):
            folder = layer / path
            try:
                entry, record = entry_of_folder(folder, layer), read_record(folder)
                _verify(entry, record)
            except DatasetError as error:
                yield Finding("problem", path, str(error))
                continue
            yield from _findings(entry, record, published)
        for path in linked_folders(layer):
            yield Finding(
                "problem", path, f"{layer / path} is a symbolic link: put the folder itself there."
            )
        yield from _unfinished(layer / STAGING)


def _verify(entry: Entry, record: dict[str, Any]) -> None:
    dataset = load_entry(entry)
    if content_digest(dataset) != entry.content_digest:
        raise IntegrityError(f"{entry.folder}: the content does not have its recorded digest.")
    inputs = (item["content_digest"] for item in record["inputs"])
    if Recipe.from_dict(record["recipe"]).digest(inputs) != entry.recipe_digest:
        raise IntegrityError(f"{entry.folder}: the recipe does not have its recorded digest.")
    if dataset.attrs["flexscale_recipe_digest"] != entry.recipe_digest:
        raise IntegrityError(f"{entry.folder}: data.nc and record.json name different recipes.")


def _findings(
    entry: Entry, record: dict[str, Any], published: dict[str, Entry]
) -> Iterator[Finding]:
    for item in record["inputs"]:
        source = published.get(item["id"])
        if source is None:
            yield Finding("note", entry.id, f"Its input {item['id']} is not in this folder.")
        elif source.content_digest != item["content_digest"]:
            yield Finding(
                "problem", entry.id, f"It is stale: its input {item['id']} has other content now."
            )
    cached = published.get(entry.id)
    if cached is not None and cached.folder == entry.folder and cached.row != entry.row:
        yield Finding(
            "problem", entry.id, "catalog.csv says something else than record.json: delete it."
        )
    if record["code"]["dirty"]:
        yield Finding("note", entry.id, "It was made by code with uncommitted changes.")
    if record["failed"]:
        yield Finding(
            "note", entry.id, f"{record['failed']} of {record['samples']} samples did not converge."
        )
    yield Finding("ok", entry.id, "Files, digests and schema agree.")


def _unfinished(staging: Path) -> Iterator[Finding]:
    for folder in sorted(staging.glob("*")):
        samples = len(list(folder.glob("line-*/*.npz")))
        if samples:
            yield Finding(
                "note",
                str(folder),
                f"Unfinished work with {samples} samples; running its experiment again resumes it.",
            )

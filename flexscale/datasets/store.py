"""Datasets on disk: atomic, verified, addressed by their recipe."""

from __future__ import annotations

import errno
import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import xarray as xr

from flexscale.datasets.build import global_attributes
from flexscale.datasets.catalog import lies_within, results_folder, update_catalog
from flexscale.datasets.checks import check_dataset
from flexscale.datasets.entry import LOCAL, REFERENCE, Entry
from flexscale.datasets.files import (
    entry_of_folder,
    first_difference,
    load_entry,
    verified_content,
    write_payload,
)
from flexscale.datasets.identity import SHORT_DIGEST, Recipe, content_digest, plain
from flexscale.datasets.labels import labels_of
from flexscale.datasets.locks import STAGING, working_folder
from flexscale.datasets.provenance import environment
from flexscale.datasets.record import RECORD_FILE, read_record
from flexscale.datasets.schema import schema_of
from flexscale.datasets.staging import FileCheckpoint, sync
from flexscale.errors import DatasetError, IntegrityError, NonReproducibleError
from flexscale.names import require_name

__all__ = ["Entry", "Store"]


class Store:
    """Results below `root`: `root/local` is written, `root/reference` only read.

    Parameters
    ----------
    root : results folder; nothing is created before the first write.

    Raises
    ------
    BadInputError : `root` is itself a layer, such as `results/reference`.
    """

    def __init__(self, root: str | Path = "results") -> None:
        self.root = results_folder(root)
        self.local = self.root / LOCAL
        self.reference = self.root / REFERENCE

    def lookup(self, kind: str, recipe: Recipe, inputs: Sequence[Entry] = ()) -> Entry | None:
        """The verified dataset of this recipe (local before reference), or None.

        A step calls it first: not None means there is nothing to do.

        Raises
        ------
        IntegrityError : it is there, but damaged.
        """
        schema_of(kind)
        digest = _digest(recipe, inputs)
        for layer in (self.local, self.reference):
            for folder in sorted(layer.glob(f"{kind}/*/*/{digest[:SHORT_DIGEST]}")):
                if not lies_within(folder, layer):
                    continue
                entry = entry_of_folder(folder, layer)
                if entry.recipe_digest == digest:
                    verified_content(entry.folder, read_record(folder))
                    # Samples are left when a kill came between publishing and clearing them.
                    self.checkpoint(recipe, inputs).clear()
                    return entry
        return None

    def checkpoint(self, recipe: Recipe, inputs: Sequence[Entry] = ()) -> FileCheckpoint:
        """Where unfinished samples of this recipe live, `root/local/.staging/<recipe digest>`.

        `publish` clears it.
        """
        return FileCheckpoint(self.local / STAGING / _digest(recipe, inputs))

    def publish(
        self,
        dataset: xr.Dataset,
        kind: str,
        recipe: Recipe,
        inputs: Sequence[Entry] = (),
        record: Mapping[str, Any] | None = None,
    ) -> Entry:
        """Check, write, verify and move a dataset to its place, all or nothing.

        Global attributes (recipe, digest, inputs, versions) are set here, on a copy. Publishing
        equal content again is fine and changes nothing.

        Parameters
        ----------
        dataset : follows the schema of `kind`.
        kind : a kind of `schema.SCHEMAS`.
        recipe, inputs : what it was made from; they name it.
        record : JSON-able facts of this run that are not part of the result (wall time, memory,
            sentences on failed samples), kept in record.json under "run".

        Raises
        ------
        SchemaError : the dataset is not a valid one of its kind.
        NonReproducibleError : the same recipe was published with other numbers.
        DatasetError : the disk is full, or the folder not writable.
        """
        complete = _with_attributes(dataset, kind, recipe, inputs)
        check_dataset(complete, kind)
        facts = _record_of(complete, inputs, record or {})
        path = _place(facts)
        target = self.local / path
        try:
            self._move_into_place(complete, kind, facts, target)
        except OSError as error:
            raise DatasetError(
                f"{target} cannot be written: {error.strerror or error}. "
                "Check the disk's free space and your permissions; nothing was left there."
            ) from error
        update_catalog(self.local, changed=[path])
        self.checkpoint(recipe, inputs).clear()
        return entry_of_folder(target, self.local)

    def _move_into_place(
        self, dataset: xr.Dataset, kind: str, facts: dict[str, Any], target: Path
    ) -> None:
        """Write beside, verify, rename; equal content that is there already stays."""
        with working_folder(self.local) as work:
            payload = work / target.name
            payload.mkdir()
            write_payload(payload, dataset, kind, facts)
            if not lies_within(target.parent, self.local):
                raise IntegrityError(
                    f"{target.parent} or a folder above it is a symbolic link, which may lead "
                    "anywhere: put the folder itself there."
                )
            target.parent.mkdir(parents=True, exist_ok=True)
            try:
                os.rename(payload, target)
            except OSError as error:
                if error.errno not in (errno.ENOTEMPTY, errno.EEXIST):
                    raise
                existing = entry_of_folder(target, self.local)
                _require_equal(dataset, facts["content_digest"], existing)
            sync(target.parent)

    def load(self, entry: Entry) -> xr.Dataset:
        """The dataset in memory, its file verified; no file stays open.

        Raises
        ------
        IntegrityError : the file is missing, unreadable or changed.
        """
        return load_entry(entry)

    def record(self, entry: Entry) -> dict[str, Any]:
        """Contents of record.json: recipe, digests, inputs, environment and "run"."""
        return read_record(entry.folder)


def _digest(recipe: Recipe, inputs: Sequence[Entry]) -> str:
    return recipe.digest(entry.content_digest for entry in inputs)


def _with_attributes(
    dataset: xr.Dataset, kind: str, recipe: Recipe, inputs: Sequence[Entry]
) -> xr.Dataset:
    """Copy with the global attributes of this recipe; the configuration in it is kept."""
    config = json.loads(dataset.attrs.get("flexscale_config", "null"))
    if config is None:
        config = recipe.parameters
    listed = [{"id": entry.id, "content_digest": entry.content_digest} for entry in inputs]
    complete = dataset.copy(deep=False)
    own = {name: text for name, text in dataset.attrs.items() if not name.startswith("flexscale_")}
    complete.attrs = own | global_attributes(schema_of(kind), recipe, listed, config)
    return complete


def _record_of(
    dataset: xr.Dataset, inputs: Sequence[Entry], run: Mapping[str, Any]
) -> dict[str, Any]:
    return labels_of(dataset) | {
        "content_digest": content_digest(dataset),
        "inputs": [{"id": entry.id, "content_digest": entry.content_digest} for entry in inputs],
        "environment": environment(),
        "run": plain(run, "record", null_for_nan=True),
    }


def _place(facts: Mapping[str, Any]) -> str:
    """Path kind/family/pattern/digest below the layer."""
    scalars = facts["scalars"]
    names = [require_name(scalars[key], key) for key in ("family", "pattern")]
    return "/".join([facts["kind"], *names, facts["recipe_digest"][:SHORT_DIGEST]])


def _require_equal(dataset: xr.Dataset, digest: str, existing: Entry) -> None:
    """NonReproducibleError when the published dataset of the same recipe has other content."""
    stored = load_entry(existing)
    if existing.content_digest != digest:
        raise NonReproducibleError(
            f"The recipe of {existing.id} gave other numbers than the stored dataset: "
            f"{first_difference(dataset, stored)}. Raise the step's version if its numbers "
            f"changed on purpose; else compare versions in {existing.folder / RECORD_FILE}."
        )

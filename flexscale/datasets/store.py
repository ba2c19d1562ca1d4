"""Datasets on disk: atomic, verified, addressed by their recipe."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexscale.datasets.identity import SHORT_DIGEST, Recipe
from flexscale.datasets.staging import FileCheckpoint

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Entry:
    """One published dataset: what the catalog knows, without opening its file."""

    kind: str
    recipe_digest: str
    content_digest: str
    folder: Path
    row: Mapping[str, Any]

    @property
    def id(self) -> str:
        """For instance "sweep:3f9c2e71b0aa"."""
        return f"{self.kind}:{self.recipe_digest[:SHORT_DIGEST]}"


class Store:
    """Results below `root`: `root/local` is written, `root/reference` only read.

    Parameters
    ----------
    root : results folder; nothing is created before the first write.
    """

    def __init__(self, root: str | Path = "results") -> None:
        self.root = Path(root)

    def lookup(self, kind: str, recipe: Recipe, inputs: Sequence[Entry] = ()) -> Entry | None:
        """The verified dataset of this recipe (local before reference), or None.

        A step calls it first: not None means there is nothing to do.

        Raises
        ------
        IntegrityError : it is there, but damaged.
        """
        raise NotImplementedError

    def checkpoint(self, recipe: Recipe, inputs: Sequence[Entry] = ()) -> FileCheckpoint:
        """Where unfinished samples of this recipe live, `root/local/.staging/<recipe digest>`.

        `publish` clears it.
        """
        raise NotImplementedError

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
        kind : "cell", "sweep", "tangent" or "shape".
        recipe, inputs : what it was made from; they name it.
        record : JSON-able facts of this run that are not part of the result (wall time, memory,
            sentences on failed samples), kept in record.json under "run".

        Raises
        ------
        SchemaError : the dataset is not a valid one of its kind.
        NonReproducibleError : the same recipe was published with other numbers.
        """
        raise NotImplementedError

    def load(self, entry: Entry) -> xr.Dataset:
        """The dataset in memory, its file verified; no file stays open.

        Raises
        ------
        IntegrityError : the file is missing, unreadable or changed.
        """
        raise NotImplementedError

    def record(self, entry: Entry) -> dict[str, Any]:
        """Contents of record.json: recipe, digests, inputs, environment and "run"."""
        raise NotImplementedError

"""One published dataset as its folder tells it: record.json, and the catalog row made from it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from flexscale.datasets.identity import SHORT_DIGEST
from flexscale.datasets.variables import SCALARS
from flexscale.errors import IntegrityError

DATA_FILE = "data.nc"
RECORD_FILE = "record.json"
_KEYS = (
    *("kind", "schema", "recipe", "recipe_digest", "content_digest", "inputs", "scalars"),
    *("sizes", "samples", "failed", "code", "environment", "run", "file_sha256", "file_bytes"),
)

#: Columns of the catalog: name -> (type, unit). Rows are made of record.json alone.
COLUMNS: dict[str, tuple[type, str]] = {
    "id": (str, ""),
    "kind": (str, ""),
    "family": (str, ""),
    "pattern": (str, ""),
    "status": (str, ""),
    "samples": (int, ""),
    "failed": (int, ""),
    "sizes": (str, ""),
    **{item.name: (float, item.units) for item in SCALARS if item.dtype == "float64"},
    "step": (str, ""),
    "step_version": (int, ""),
    "version": (str, ""),
    "commit": (str, ""),
    "dirty": (int, ""),
    "created": (str, ""),
    "file_bytes": (int, "B"),
    "recipe_digest": (str, ""),
    "content_digest": (str, ""),
    "path": (str, ""),
}

#: Layers of a results folder: what is shipped, only read, and what was computed here.
REFERENCE, LOCAL = "reference", "local"

#: What datasets can be asked for: where they lie, and the columns of the catalog.
PROPERTIES: dict[str, tuple[type, str]] = {"source": (str, ""), **COLUMNS}


@dataclass(frozen=True)
class Entry:
    """One published dataset: what the catalog knows, without opening its file.

    `row` holds the values of PROPERTIES; `folder` holds data.nc and record.json.
    """

    kind: str
    recipe_digest: str
    content_digest: str
    folder: Path
    row: Mapping[str, Any]

    @property
    def id(self) -> str:
        """For instance "sweep:3f9c2e71b0aa"."""
        return f"{self.kind}:{self.recipe_digest[:SHORT_DIGEST]}"

    @property
    def source(self) -> str:
        """Layer it lies in, "reference" or "local"."""
        return str(self.row["source"])

    @classmethod
    def from_row(cls, row: Mapping[str, Any], layer: Path) -> Entry:
        """Entry of a catalog row; `layer` is the folder the row's path starts from."""
        return cls(
            kind=row["kind"],
            recipe_digest=row["recipe_digest"],
            content_digest=row["content_digest"],
            folder=layer / row["path"],
            row={"source": layer.name, **row},
        )


def read_record(folder: Path) -> dict[str, Any]:
    """Contents of a folder's record.json.

    Raises
    ------
    IntegrityError : missing, unreadable, or of another dataset.
    """
    path = folder / RECORD_FILE
    advice = f"Remove the folder {folder} and run the step again."
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
        for key in _KEYS:
            record[key]
        row_of_record(record, "")
    except FileNotFoundError as error:
        raise IntegrityError(f"{path} is missing. {advice}") from error
    except OSError as error:
        raise IntegrityError(f"{path} cannot be read: {error.strerror}.") from error
    except (ValueError, KeyError, TypeError) as error:
        raise IntegrityError(f"{path} is damaged. {advice}") from error
    if record["recipe_digest"][:SHORT_DIGEST] != folder.name:
        raise IntegrityError(
            f"{path} belongs to {record['recipe_digest'][:SHORT_DIGEST]}, "
            f"not to {folder.name}. {advice}"
        )
    result: dict[str, Any] = record
    return result


def row_of_record(record: Mapping[str, Any], path: str) -> dict[str, Any]:
    """Catalog row of a record; `path` is the folder seen from its layer, with slashes."""
    recipe, code = record["recipe"], record["code"]
    row: dict[str, Any] = {
        "id": f"{record['kind']}:{record['recipe_digest'][:SHORT_DIGEST]}",
        "kind": record["kind"],
        "status": "unconverged" if record["failed"] else "complete",
        "samples": record["samples"],
        "failed": record["failed"],
        "sizes": " ".join(f"{name}={size}" for name, size in record["sizes"].items()),
        "step": recipe["step"],
        "step_version": recipe["version"],
        **{name: code[name] for name in ("version", "commit", "dirty")},
        "created": record["environment"]["created"],
        "file_bytes": record["file_bytes"],
        "recipe_digest": record["recipe_digest"],
        "content_digest": record["content_digest"],
        "path": path,
    }
    return {name: row.get(name, record["scalars"].get(name)) for name in COLUMNS}

"""One published dataset as its folder tells it: record.json, and the catalog row made from it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from flexscale.datasets.identity import SHORT_DIGEST
from flexscale.datasets.variables import SCALARS
from flexscale.names import is_name

DATA_FILE = "data.nc"
MOST = 2.0**53  # up to which floats hold every whole number; of a catalog's numbers, nan is beyond
_DIGEST = re.compile(r"[0-9a-f]{64}")
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


def row_of_record(record: Mapping[str, Any], path: str) -> dict[str, Any]:
    """Catalog row of a record; `path` is the folder seen from its layer, with slashes."""
    recipe, code = record["recipe"], record["code"]
    row: dict[str, Any] = {
        "id": f"{record['kind']}:{record['recipe_digest'][:SHORT_DIGEST]}",
        "kind": record["kind"],
        "status": _status(record["failed"]),
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


def is_sound_row(row: Mapping[str, Any]) -> bool:
    """Whether a row of catalog.csv can be that of the folder it names; anybody may edit it."""
    digest = row["recipe_digest"]
    names = (row["kind"], row["family"], row["pattern"], digest[:SHORT_DIGEST])
    numbers = [row[name] for name, (kind, _) in COLUMNS.items() if kind is not str]
    return (
        all(is_name(name) for name in names)
        and row["path"] == "/".join(names)
        and row["id"] == f"{row['kind']}:{digest[:SHORT_DIGEST]}"
        and all(_DIGEST.fullmatch(text) for text in (digest, row["content_digest"]))
        and all(row[name] is not None for name in ("samples", "failed", "dirty", "file_bytes"))
        and 0 <= row["failed"] <= row["samples"]
        and row["status"] == _status(row["failed"])
        and all(number is None or abs(number) <= MOST for number in numbers)
        and all(row[name].isprintable() for name, (kind, _) in COLUMNS.items() if kind is str)
    )


def _status(failed: int) -> str:
    return "unconverged" if failed else "complete"

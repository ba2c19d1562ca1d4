"""A results folder with one sweep, and how somebody else might change it and sign it anew."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from flexscale.datasets.entry import Entry
from flexscale.datasets.store import Store
from tests.datasets.dataset_samples import recipe, sweep


def one_sweep(root: Path) -> Entry:
    """Publish a small sweep below `root`."""
    return Store(root).publish(sweep(), "sweep", recipe())


def sign(folder: Path) -> None:
    """Make record.json agree with whatever data.nc holds."""
    content = (folder / "data.nc").read_bytes()
    facts = {"file_sha256": hashlib.sha256(content).hexdigest(), "file_bytes": len(content)}
    edit_record(folder, lambda record: record.update(facts))


def edit_record(folder: Path, change: Callable[[dict[str, Any]], object]) -> None:
    """Let `change` alter the record, and drop the catalog, so that the record is read again."""
    path = folder / "record.json"
    record = json.loads(path.read_text())
    change(record)
    path.write_text(json.dumps(record))
    forget_catalog(folder)


def forget_catalog(folder: Path) -> None:
    (folder.parents[3] / "catalog.csv").unlink(missing_ok=True)

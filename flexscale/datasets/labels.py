"""What record.json repeats of data.nc, so that queries need not open it; made here, and held
against it here."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from flexscale.datasets.untrusted import parse_json
from flexscale.datasets.variables import SCALARS, statuses
from flexscale.errors import IntegrityError
from flexscale.status import SolveStatus


def labels_of(dataset: xr.Dataset) -> dict[str, Any]:
    """Parts of a record by name, derived from a complete dataset.

    Raises
    ------
    KeyError, TypeError, ValueError : it lacks attributes, or they are of another kind.
    """
    attributes = dataset.attrs
    ends = [status.values for status in statuses(dataset).values()]
    return {
        "kind": str(attributes["flexscale_kind"]),
        "schema": str(attributes["flexscale_schema"]),
        "recipe": parse_json(attributes["flexscale_recipe"]),
        "recipe_digest": str(attributes["flexscale_recipe_digest"]),
        "inputs": parse_json(attributes["flexscale_inputs"]),
        "scalars": {
            item.name: dataset[item.name].item() for item in SCALARS if item.name in dataset.coords
        },
        "sizes": {str(name): int(size) for name, size in dataset.sizes.items()},
        "samples": sum(end.size for end in ends),
        "failed": sum(int(np.count_nonzero(end != SolveStatus.converged)) for end in ends),
        "code": {
            "version": str(attributes["flexscale_version"]),
            "commit": str(attributes["flexscale_commit"]),
            "dirty": int(attributes["flexscale_dirty"]),
        },
    }


def require_same_labels(dataset: xr.Dataset, record: Mapping[str, Any], folder: Path) -> None:
    """IntegrityError, with the label and both its values, unless data.nc and record.json agree."""
    try:
        derived = labels_of(dataset)
    except (KeyError, TypeError, ValueError) as error:
        raise IntegrityError(f"{folder}: data.nc lacks labels of a dataset: {error}.") from error
    recorded = {name: record[name] for name in derived}
    recorded["inputs"] = [item["id"] for item in record["inputs"]]
    for name, value in derived.items():
        if recorded[name] != value:
            told, found = _first_difference(recorded[name], value)
            raise IntegrityError(
                f"{folder}: record.json says {name} {told!r:.100}, data.nc says {found!r:.100}."
            )


def _first_difference(told: Any, found: Any) -> tuple[Any, Any]:
    """Values that differ, of dicts only the entries that do."""
    if not isinstance(told, dict) or not isinstance(found, dict):
        return told, found
    names = [
        name
        for name in sorted(told.keys() | found.keys())
        if told.get(name, "nothing") != found.get(name, "nothing")
    ]
    return (
        {name: told.get(name, "nothing") for name in names},
        {name: found.get(name, "nothing") for name in names},
    )

"""Where a dataset comes from, what two datasets differ in, and many as one tree."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from flexscale.datasets.entry import Entry
from flexscale.datasets.files import load_entry
from flexscale.datasets.recipe_values import leaves
from flexscale.datasets.record import read_record

if TYPE_CHECKING:
    import xarray as xr


def lineage(entry: Entry, published: Mapping[str, Entry]) -> pd.DataFrame:
    """The dataset and all it was made from, inputs before results, one row each.

    Parameters
    ----------
    entry : the dataset in question.
    published : entries by id; an input that is not among them has a row without facts.
    """
    rows: dict[str, dict[str, Any]] = {}

    def visit(identifier: str) -> None:
        if identifier in rows:
            return
        known = entry if identifier == entry.id else published.get(identifier)
        if known is None:
            rows[identifier] = {"id": identifier, "created": "not here"}
            return
        record = read_record(known.folder)
        inputs = [item["id"] for item in record["inputs"]]
        for source in inputs:
            visit(source)
        columns = ("step", "step_version", "version", "commit", "dirty", "created")
        rows[identifier] = {
            "id": identifier,
            "inputs": ", ".join(inputs),
            **{name: known.row[name] for name in columns},
        }

    visit(entry.id)
    return pd.DataFrame(list(rows.values())).set_index("id")


def difference(first: Entry, second: Entry) -> pd.DataFrame:
    """Recipe entries and variables in which two datasets differ, one row each.

    Returns
    -------
    Columns `first` and `second` hold recipe values, or how many of the values of a variable are
    finite; `largest` is the greatest difference of a variable on equal axes, in its unit.
    """
    rows: list[dict[str, Any]] = []
    old = dict(leaves(read_record(first.folder)["recipe"]))
    new = dict(leaves(read_record(second.folder)["recipe"]))
    for key in sorted(old.keys() | new.keys()):
        a, b = old.get(key, "absent"), new.get(key, "absent")
        if a != b:
            rows.append({"what": key, "first": a, "second": b})
    left, right = load_entry(first), load_entry(second)
    for name in sorted({*map(str, left.variables), *map(str, right.variables)}):
        row = _variable_difference(left, right, name)
        if row is not None:
            rows.append(row)
    return pd.DataFrame(rows, columns=["what", "first", "second", "largest", "unit"])


def _variable_difference(left: xr.Dataset, right: xr.Dataset, name: str) -> dict[str, Any] | None:
    if name not in left.variables or name not in right.variables:
        there, absent = ("there", "absent") if name in left.variables else ("absent", "there")
        return {"what": name, "first": there, "second": absent}
    a, b = left.variables[name], right.variables[name]
    if a.equals(b):
        return None
    if a.dtype.kind not in "fi" or a.shape != b.shape:
        shown = [item.values.item() if item.ndim == 0 else f"shape {item.shape}" for item in (a, b)]
        return {"what": name, "first": shown[0], "second": shown[1]}
    gap = np.abs(a.values.astype(float) - b.values.astype(float))
    return {
        "what": name,
        "first": int(np.isfinite(a.values).sum()),
        "second": int(np.isfinite(b.values).sum()),
        "largest": float(np.nanmax(gap)) if np.isfinite(gap).any() else np.nan,
        "unit": a.attrs.get("units", ""),
    }


def to_tree(entries: Iterable[Entry]) -> xr.DataTree:
    """Datasets as /family/pattern; /family/pattern/kind_digest where that is not unique."""
    import xarray as xr

    chosen = list(entries)
    places = [f"/{entry.row['family']}/{entry.row['pattern']}" for entry in chosen]
    nodes = {
        place if places.count(place) == 1 else f"{place}/{entry.kind}_{entry.folder.name}": (
            load_entry(entry)
        )
        for place, entry in zip(places, chosen, strict=True)
    }
    return xr.DataTree.from_dict(nodes)

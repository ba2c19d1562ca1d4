"""Many datasets of one kind as one, along a property in which they differ."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from flexscale.checks import require_choice
from flexscale.datasets.entry import Entry
from flexscale.datasets.files import load_entry
from flexscale.datasets.variables import SCALARS
from flexscale.errors import MissingDataError, SchemaError

if TYPE_CHECKING:
    import xarray as xr


def stack(entries: Sequence[Entry], along: str) -> xr.Dataset:
    """Datasets side by side on a new axis; nothing is interpolated, filled or left out.

    Parameters
    ----------
    entries : datasets of one kind on equal axes.
    along : scalar coordinate that tells them apart: "pattern", "family", "gap", …

    Returns
    -------
    Dataset with the dimension `along`, in the order of `entries`; other scalar coordinates lie on
    it, and `dataset_id` names each one's source. Attributes in which they differ are dropped.

    Raises
    ------
    UnknownNameError : there is no such scalar coordinate.
    MissingDataError : there is nothing to stack, or two share a value of `along`.
    SchemaError : kinds, variables, sizes or coordinate values differ; names the odd one.
    """
    import xarray as xr

    known = [item.name for item in SCALARS]
    require_choice(along, "property to stack datasets along", known)
    if not entries:
        raise MissingDataError("There is no dataset to stack; loosen the criteria.")
    datasets = [load_entry(entry) for entry in entries]
    for entry, dataset in zip(entries, datasets, strict=True):
        _require_like(entries[0], datasets[0], entry, dataset, along)
    values = [dataset[along].item() for dataset in datasets]
    for value in values:
        if values.count(value) > 1:
            same = [e.id for e, other in zip(entries, values, strict=True) if other == value]
            raise MissingDataError(
                f"Several datasets have {along} {value!r}: {', '.join(same)}; "
                "choose one of them by another property."
            )
    labelled = [
        dataset.assign_coords(dataset_id=entry.id)
        for entry, dataset in zip(entries, datasets, strict=True)
    ]
    # Named coordinates are put on the axis even where all share a value.
    scalars = [name for name in known if name in datasets[0].coords and name != along]
    return xr.concat(
        labelled,
        dim=along,
        data_vars="all",
        coords=[*scalars, "dataset_id"],
        compat="override",
        join="exact",
        combine_attrs="drop_conflicts",
    )


def _require_like(
    first: Entry, model: xr.Dataset, entry: Entry, dataset: xr.Dataset, along: str
) -> None:
    """SchemaError unless `dataset` has the kind, variables and axes of `model`."""
    if entry.kind != first.kind:
        raise SchemaError(f"{entry.id} is no {first.kind}: stack datasets of one kind only.")
    names, wanted = set(map(str, dataset.variables)), set(map(str, model.variables))
    if names != wanted:
        odd = ", ".join(sorted(names ^ wanted))
        raise SchemaError(f"{entry.id} and {first.id} do not both have {odd}.")
    for name, size in model.sizes.items():
        if dataset.sizes[name] != size:
            raise SchemaError(
                f"{entry.id} has {dataset.sizes[name]} values along {name} and {first.id} has "
                f"{size}: only datasets on equal axes can be stacked."
            )
    scalars = {item.name for item in SCALARS}
    for name in set(map(str, model.coords)) - scalars - {along}:
        if not np.array_equal(model[name].values, dataset[name].values):
            raise SchemaError(
                f"{entry.id} has other values of {name} than {first.id}: only datasets on equal "
                "axes can be stacked."
            )

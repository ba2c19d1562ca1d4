"""Datasets as callers give them: whatever they did to them since they were loaded."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from flexscale.datasets.schema import SCHEMAS
from flexscale.datasets.variables import SCALARS, Variable
from flexscale.errors import SchemaError, shown

if TYPE_CHECKING:
    import xarray as xr


def require_variables(dataset: xr.Dataset, names: Iterable[str], what: str, kind: str = "") -> None:
    """Refuse a dataset that lacks variables or coordinates, or has other ones of these names.

    Other ones: over other dimensions than the kind's, or of another type. Where no kind is given,
    as many dimensions are enough as some kind has for this name.

    Parameters
    ----------
    what : for the message, what needs them: "A fit".
    kind : of dataset, if known.

    Raises
    ------
    SchemaError : a name is missing, or stands for something else.
    """
    variables = getattr(dataset, "variables", {})
    missing = [name for name in names if name not in variables]
    if missing:
        present = shown(sorted(map(str, variables))) if variables else "nothing"
        raise SchemaError(
            f"{what} needs {', '.join(missing)}, which this dataset does not have (it has "
            f"{present}); give it a dataset of the right kind."
        )
    for name in names:
        _require_declared(dataset, name, what, kind)


def read_config(dataset: xr.Dataset) -> dict[str, Any]:
    """How the dataset was made, {} where it does not say.

    Raises
    ------
    SchemaError : what it says is no JSON text.
    """
    given = dataset.attrs.get("flexscale_config", "{}")
    try:
        config = json.loads(given)
    except (TypeError, ValueError, RecursionError):
        config = None
    if not isinstance(config, dict):
        raise SchemaError(f"The attribute flexscale_config of the dataset is {shown(given)}.")
    return config


def read_labels(dataset: xr.Dataset) -> dict[str, float | str]:
    """What the dataset is labelled with: pattern, family, sizes, materials."""
    labels: dict[str, float | str] = {"family": "custom", "pattern": "custom"}
    for scalar in SCALARS:
        if scalar.name in dataset.variables and dataset[scalar.name].ndim == 0:
            labels[scalar.name] = dataset[scalar.name].item()
    return labels


def _require_declared(dataset: xr.Dataset, name: str, what: str, kind: str) -> None:
    variable = dataset.variables[name]
    schemas = [SCHEMAS[kind]] if kind else SCHEMAS.values()
    known = [schema.all[name] for schema in schemas if name in schema.all]
    if not known:  # a caller's own variable
        return
    dims = set(variable.dims)
    if not any(dims == set(d.dims) if kind else variable.ndim == len(d.dims) for d in known):
        wanted = " or ".join(dict.fromkeys(str(declared.dims) for declared in known))
        raise SchemaError(
            f"{what} needs {name} over {wanted}, but in this dataset it lies over "
            f"{shown(variable.dims)}: select with lists, as in sel(side=['closing'])."
        )
    if not any(_is_of_type(variable.dtype, declared) for declared in known):
        raise SchemaError(f"{what} needs {name} as {known[0].dtype}, not as {variable.dtype}.")
    if variable.size == 0:
        raise SchemaError(f"{what} needs {name}, of which this dataset has no values.")
    for axis in {name, *map(str, variable.dims)} & set(dataset.variables):
        _require_axis(dataset, axis)


def _require_axis(dataset: xr.Dataset, name: str) -> None:
    """Refuse an axis by which values cannot be told apart."""
    axis = dataset.variables[name]
    if axis.dims != (name,):
        return
    if axis.dtype.kind == "f" and not np.isfinite(axis.values).all():
        raise SchemaError(f"The {name} of this dataset has values that are not finite.")
    listed = axis.values.tolist()
    if len(set(map(str, listed))) < len(listed):
        raise SchemaError(f"The {name} of this dataset has a value twice: {shown(listed)}.")


def _is_of_type(dtype: np.dtype, declared: Variable) -> bool:
    return dtype.kind in ("UOT" if declared.dtype == "text" else "iuf")

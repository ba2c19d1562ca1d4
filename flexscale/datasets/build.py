"""Complete, labelled datasets from plain arrays."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

import flexscale.datasets.accessor  # noqa: F401  (registers `dataset.fs`)
from flexscale.datasets.identity import Recipe, plain
from flexscale.datasets.provenance import code_version
from flexscale.datasets.variables import Schema, Variable
from flexscale.errors import SchemaError, suggest
from flexscale.status import SolveStatus

PAPER = "FlexScale: Modeling and Characterization of Flexible Scaled Sheets"


def build_dataset(
    schema: Schema,
    arrays: Mapping[str, Any],
    *,
    scalars: Mapping[str, float | str],
    config: Mapping[str, Any],
) -> xr.Dataset:
    """Dataset of any kind from arrays named as in its schema, cast to the schema's types.

    Parameters
    ----------
    schema : of the kind.
    arrays : coordinates and variables by name; for a cell the arrays of a `PeriodicMesh`.
    scalars : "family", "pattern" and what is known of `variables.SCALARS`.
    config : resolved configuration, JSON-able, enough to compute the dataset again.

    Raises
    ------
    SchemaError : a name is missing or unknown, or a shape does not fit.
    """
    values: dict[str, Any] = {**arrays, **scalars}
    _check_names(schema, values)
    failed = None
    if "status" in values:
        failed = np.asarray(values["status"]) != SolveStatus.converged
    variables = {
        name: _labelled(schema, schema.all[name], value, failed) for name, value in values.items()
    }
    try:
        dataset = xr.Dataset(variables)
    except ValueError as error:
        raise SchemaError(f"The arrays of a {schema.name} dataset do not fit: {error}.") from error
    coordinates = {item.name for item in schema.coordinates} | set(scalars)
    dataset = dataset.set_coords(sorted(coordinates & set(dataset.variables)))
    recipe = Recipe(schema.kind, schema.version, config)  # until a step publishes it with its own
    dataset.attrs = global_attributes(schema, recipe, [], config)
    return dataset


def array_names(schema: Schema) -> list[str]:
    """Names of the required data variables of a kind, to collect them from an object."""
    return [item.name for item in schema.variables if not item.optional]


def global_attributes(
    schema: Schema,
    recipe: Recipe,
    inputs: Sequence[Mapping[str, str]],
    config: Mapping[str, Any],
) -> dict[str, Any]:
    """Global attributes of a dataset: text and numbers only, nested data as JSON text.

    Parameters
    ----------
    inputs : of each input its "id" and "content_digest".
    config : resolved configuration.
    """
    code = code_version()
    return {
        "Conventions": "CF-1.11",
        "title": schema.title,
        "source": f"FlexScale {code.version}",
        "history": f"step {recipe.step}, version {recipe.version}",
        "references": PAPER,
        "license": "CC-BY-4.0",
        "flexscale_kind": schema.kind,
        "flexscale_schema": schema.name,
        "flexscale_recipe": json.dumps(recipe.to_dict(), sort_keys=True),
        "flexscale_recipe_digest": recipe.digest(item["content_digest"] for item in inputs),
        "flexscale_config": json.dumps(plain(config, "config"), sort_keys=True),
        "flexscale_inputs": json.dumps([item["id"] for item in inputs]),
        "flexscale_version": code.version,
        "flexscale_commit": code.commit,
        "flexscale_dirty": int(code.dirty),
    }


def _check_names(schema: Schema, values: Mapping[str, Any]) -> None:
    known = schema.all
    for name in values:
        if name not in known:
            raise SchemaError(
                f"A {schema.name} dataset has no variable {name!r}. {suggest(name, known)}"
            )
    missing = [name for name, item in known.items() if not item.optional and name not in values]
    if missing:
        raise SchemaError(f"A {schema.name} dataset needs {', '.join(map(repr, missing))}.")


def _labelled(
    schema: Schema, declared: Variable, value: Any, failed: np.ndarray | None
) -> xr.Variable:
    """One variable with the declared type and attributes, nan at failed samples."""
    if declared.dtype == "text":
        data = np.asarray(value, dtype=str)
    else:
        data = np.array(value, dtype=declared.dtype)  # a copy: masking must not reach the caller
    if data.ndim != len(declared.dims):
        raise SchemaError(
            f"{declared.name} of a {schema.name} dataset has shape {data.shape}, "
            f"but its dimensions are ({', '.join(declared.dims)})."
        )
    samples = schema.all["status"].dims if failed is not None else ()
    measured = declared in schema.variables  # where a sample lies is known though it failed
    per_sample = failed is not None and measured and declared.dims[: len(samples)] == samples
    if failed is not None and per_sample and declared.dtype == "float64":
        if data.shape[: failed.ndim] != failed.shape:
            raise SchemaError(
                f"{declared.name} has shape {data.shape}, status has {failed.shape}: "
                f"both must hold one value per {', '.join(samples)}."
            )
        data[failed] = np.nan
    attrs: dict[str, Any] = {"long_name": declared.long_name}
    if declared.units:
        attrs["units"] = declared.units
    for name, item in declared.attrs.items():
        attrs[name] = np.asarray(item, dtype=declared.dtype) if isinstance(item, list) else item
    return xr.Variable(declared.dims, data, attrs)

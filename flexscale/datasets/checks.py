"""Does a dataset keep the promises of its kind?"""

from __future__ import annotations

import xarray as xr

from flexscale.datasets.identity import SHORT_DIGEST
from flexscale.datasets.schema import schema_of
from flexscale.datasets.untrusted import parse_json
from flexscale.datasets.variables import COMPONENTS, Schema, Variable
from flexscale.errors import SchemaError


def check_dataset(dataset: xr.Dataset, kind: str) -> None:
    """Raise SchemaError with one sentence unless `dataset` is a valid one of `kind`.

    Checked: names, dimensions and their order, types, units, global attributes; for a sweep also
    monotonic coordinates, finite values exactly at converged samples, energy parts that sum, and
    no energy without curvature; for meshes, indices within range.
    """
    schema = schema_of(kind)
    _check_names(dataset, schema)
    for name, declared in schema.all.items():
        if name in dataset.variables:
            _check_variable(dataset.variables[name], declared, schema)
    _check_attributes(dataset, schema)
    for name in ("component", "other_component"):
        if name in dataset.coords and tuple(dataset[name].values) != COMPONENTS:
            raise SchemaError(f"The values of {name} are {', '.join(COMPONENTS)}, in this order.")
    schema.check(dataset)


def _check_names(dataset: xr.Dataset, schema: Schema) -> None:
    known = schema.all
    for name in dataset.variables:
        if name not in known:
            raise SchemaError(f"A {schema.name} dataset must not hold the variable {name!r}.")
    for name, declared in known.items():
        if name not in dataset.variables and not declared.optional:
            raise SchemaError(f"The {schema.name} dataset lacks the variable {name!r}.")


def _check_variable(variable: xr.Variable, declared: Variable, schema: Schema) -> None:
    where = f"{declared.name} of the {schema.name} dataset"
    if variable.dims != declared.dims:
        raise SchemaError(f"{where} has dimensions {variable.dims}, not {declared.dims}.")
    is_text = variable.dtype.kind in "UOT"
    if (declared.dtype == "text") != is_text or (not is_text and variable.dtype != declared.dtype):
        raise SchemaError(f"{where} has type {variable.dtype}, not {declared.dtype}.")
    if str(variable.attrs.get("units", "")) != declared.units:
        raise SchemaError(
            f"{where} has units {variable.attrs.get('units')!r}, not {declared.units!r}."
        )
    if "long_name" not in variable.attrs:
        raise SchemaError(f"{where} has no long_name.")


def _check_attributes(dataset: xr.Dataset, schema: Schema) -> None:
    named = dataset.attrs.get("flexscale_schema")
    if named != schema.name:
        raise SchemaError(f"The dataset says it follows {named!r}, not {schema.name!r}.")
    for name in ("flexscale_config", "flexscale_recipe", "flexscale_inputs"):
        try:
            parse_json(dataset.attrs.get(name, ""))
        except (TypeError, ValueError) as error:
            raise SchemaError(f"The attribute {name} of the dataset is not JSON text.") from error
    if len(str(dataset.attrs.get("flexscale_recipe_digest", ""))) < SHORT_DIGEST:
        raise SchemaError("The dataset has no attribute flexscale_recipe_digest.")

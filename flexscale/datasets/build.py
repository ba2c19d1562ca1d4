"""Complete, labelled datasets from plain arrays."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

import flexscale.datasets.accessor  # noqa: F401  (registers `dataset.fs`)
from flexscale.datasets.fit_values import PARAMETERS
from flexscale.datasets.identity import Recipe, plain
from flexscale.datasets.provenance import code_version
from flexscale.datasets.schema import schema_of
from flexscale.datasets.variables import (
    ASSESSMENTS,
    COMPONENTS,
    SIDES,
    STATISTICS,
    Schema,
    Variable,
)
from flexscale.errors import SchemaError, UnknownNameError, suggest
from flexscale.status import SolveStatus

NO_CONTACT_COMMENT = "contact between scales was not modeled"
PAPER = "FlexScale: Modeling and Characterization of Flexible Scaled Sheets"


def build_sweep_dataset(
    sides: Sequence[str],
    directions: ArrayLike,
    curvatures: ArrayLike,
    arrays: Mapping[str, ArrayLike],
    *,
    scalars: Mapping[str, float | str],
    config: Mapping[str, Any],
    recipe: Recipe | None = None,
) -> xr.Dataset:
    """Dataset of kind sweep/1.

    Parameters
    ----------
    sides : of "closing", "opening".
    directions : (n_directions,) degree in [0, 180); sorted here, with the arrays.
    curvatures : (n_curvatures,) mm-1, non-negative; sorted here, with the arrays.
    arrays : values by the names of the schema, (n_sides, n_directions, n_curvatures), `stretch`
        with 3 components (xx, yy, xy) behind, `symmetry_source` (n_sides, n_directions) degree.
        Without contact leave out `energy_density_contact`, `contact_pairs`, `contact_force` and
        `min_gap`; they become 0, 0, 0 and nan. Without `symmetry_source` every direction was
        computed itself.
        Real values are set to nan wherever `status` is not 0.
    scalars : "family", "pattern" and what is known of `variables.SCALARS`.
    config : resolved configuration, JSON-able, enough to compute the sweep again.
    recipe : defaults to step "sweep" with `config` as its parameters.
    """
    sides = [str(side) for side in sides]
    for side in sides:
        if side not in SIDES:
            raise UnknownNameError(f"There is no side {side!r}. {suggest(side, SIDES)}")
    angles = np.asarray(directions, dtype=float)
    kappa = np.asarray(curvatures, dtype=float)
    shape = (len(sides), angles.size, kappa.size)
    signs = np.array([1 if side == "closing" else -1 for side in sides], dtype=np.int8)
    values: dict[str, Any] = dict(arrays)
    no_contact = "min_gap" not in values
    values.setdefault("energy_density_contact", np.zeros(shape))
    values.setdefault("contact_pairs", np.zeros(shape, dtype=np.int32))
    values.setdefault("contact_force", np.zeros(shape))
    values.setdefault("min_gap", np.full(shape, np.nan))
    values.setdefault("symmetry_source", np.broadcast_to(angles, shape[:2]))
    values.update(
        side=sides,
        direction=angles,
        curvature=kappa,
        component=list(COMPONENTS),
        side_sign=signs,
        direction_rad=np.deg2rad(angles),
        signed_curvature=signs[:, None] * kappa,
    )
    dataset = build_dataset("sweep", values, scalars=scalars, config=config, recipe=recipe)
    if no_contact:
        dataset["min_gap"].attrs["comment"] = NO_CONTACT_COMMENT
    return dataset.sortby(["side", "direction", "curvature"])


def build_tangent_dataset(
    matrix: ArrayLike,
    in_plane: ArrayLike,
    directions: ArrayLike,
    *,
    scalars: Mapping[str, float | str],
    config: Mapping[str, Any],
    recipe: Recipe | None = None,
) -> xr.Dataset:
    """Dataset of kind tangent; the stiffness in each direction follows from the matrix.

    Parameters
    ----------
    matrix : (3, 3) N mm, C in energy density 1/2 k C k with k = (kxx, kyy, 2 kxy).
    in_plane : (3, 3) N mm-1, energy density 1/2 E A E with E = (Exx, Eyy, 2 Exy).
    directions : (n,) degree.
    scalars, config, recipe : as in `build_sweep_dataset`.
    """
    angles = np.asarray(directions, dtype=float)
    stiffness = np.asarray(matrix, dtype=float)
    values = {
        "matrix": stiffness,
        "in_plane": in_plane,
        "stiffness": directional_stiffness(stiffness, angles),
        "direction": angles,
        "component": list(COMPONENTS),
        "other_component": list(COMPONENTS),
    }
    dataset = build_dataset("tangent", values, scalars=scalars, config=config, recipe=recipe)
    return dataset.sortby("direction")


def directional_stiffness(matrix: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """(n,) N mm: k C k for unit curvature in each direction (degree), k = (c², s², 2 c s)."""
    cosine, sine = np.cos(np.deg2rad(directions)), np.sin(np.deg2rad(directions))
    bending = np.stack([cosine**2, sine**2, 2.0 * cosine * sine])
    return np.einsum("in,ij,jn->n", bending, matrix, bending)


def build_fit_dataset(
    sides: Sequence[str],
    directions: ArrayLike,
    arrays: Mapping[str, ArrayLike],
    *,
    scalars: Mapping[str, float | str],
    config: Mapping[str, Any],
    recipe: Recipe | None = None,
) -> xr.Dataset:
    """Dataset of kind fit.

    Parameters
    ----------
    sides : of "closing", "opening".
    directions : (n,) degree, increasing.
    arrays : variables by the names of the schema; the parameters are a, b, kappa_0, in this order.
    scalars, config, recipe : as in `build_sweep_dataset`.
    """
    values = {
        **arrays,
        "side": list(sides),
        "direction": np.asarray(directions, dtype=float),
        "parameter": list(PARAMETERS),
        "parameter_units": ["N mm", "N mm", "mm-1"],
        "component": list(COMPONENTS),
        "other_component": list(COMPONENTS),
        "harmonic": np.arange(np.shape(arrays["cos_coefficient"])[-1]),
        "assessment": list(ASSESSMENTS),
        "statistic": list(STATISTICS),
    }
    return build_dataset("fit", values, scalars=scalars, config=config, recipe=recipe)


def build_dataset(
    kind: str,
    arrays: Mapping[str, Any],
    *,
    scalars: Mapping[str, float | str],
    config: Mapping[str, Any],
    recipe: Recipe | None = None,
) -> xr.Dataset:
    """Dataset of any kind from arrays named as in its schema, cast to the schema's types.

    Parameters
    ----------
    kind : a kind of `schema.SCHEMAS`.
    arrays : coordinates and variables by name; for a cell the arrays of a `PeriodicMesh`.
    scalars, config, recipe : as in `build_sweep_dataset`.

    Raises
    ------
    SchemaError : a name is missing or unknown, or a shape does not fit.
    """
    schema = schema_of(kind)
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
    if recipe is None:
        recipe = Recipe(kind, schema.version, config)
    dataset.attrs = global_attributes(schema, recipe, [], config)
    return dataset


def array_names(kind: str) -> list[str]:
    """Names of the required data variables of a kind, to collect them from an object."""
    return [item.name for item in schema_of(kind).variables if not item.optional]


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

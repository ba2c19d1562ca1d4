"""Does a dataset keep the promises of its kind?"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr

from flexscale.datasets.build import directional_stiffness
from flexscale.datasets.fit_values import ONSET_QUANTITIES, PARAMETERS, fit_parameters
from flexscale.datasets.identity import SHORT_DIGEST
from flexscale.datasets.sample_checks import check_axis, check_numbers, check_sides, check_status
from flexscale.datasets.schema import ENERGY_PARTS, SWEEP, schema_of
from flexscale.datasets.sheet_checks import (
    check_native_rig,
    check_rig,
    check_sheet_samples,
    check_turned_sheet,
)
from flexscale.datasets.untrusted import parse_json
from flexscale.datasets.variables import COMPONENTS, SIDES, VARIANTS, Schema, Variable
from flexscale.errors import SchemaError

#: share of the largest value that sums and zeros may be off by rounding
ROUNDING = 1e-9


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
    _CHECKS[kind](dataset)


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


def _check_sweep(dataset: xr.Dataset) -> None:
    check_sides(dataset, "sweep")
    direction = dataset["direction"].values
    check_axis(direction, "direction", "degree")
    if direction[0] < 0.0 or direction[-1] >= 180.0:
        raise SchemaError("Directions of a sweep must lie in [0, 180) degree.")
    curvature = dataset["curvature"].values
    check_axis(curvature, "curvature", "mm-1")
    if curvature[0] < 0.0:
        raise SchemaError("Curvatures of a sweep must not be negative: the side carries the sign.")
    status = dataset["status"]
    check_status(status, "sweep")
    for name, variable in dataset.data_vars.items():
        if variable.dims[:3] == status.dims and variable.dtype.kind == "f":
            check_numbers(variable, status, partial=SWEEP.all[str(name)].partial)
    _check_energy(dataset)


def _check_energy(dataset: xr.Dataset) -> None:
    energy = dataset["energy_density"].values
    parts = np.stack([dataset[name].values for name in ENERGY_PARTS])
    if not np.isfinite(energy).any():
        return
    scale = float(np.nanmax(np.abs(parts)))
    off = float(np.nanmax(np.abs(parts.sum(axis=0) - energy)))
    if off > ROUNDING * scale:
        raise SchemaError(f"The parts of energy_density miss its value by {off:.3g} N mm-1.")
    at_rest = energy[:, :, dataset["curvature"].values == 0.0]
    at_rest = at_rest[np.isfinite(at_rest)]
    if at_rest.size and np.abs(at_rest).max() > ROUNDING * max(scale, 1e-3):
        raise SchemaError(
            f"energy_density is {np.abs(at_rest).max():.3g} N mm-1 at curvature 0, not 0."
        )


def _check_tangent(dataset: xr.Dataset) -> None:
    for name in ("matrix", "in_plane"):
        _check_stiffness(dataset[name].values, name)
    matrix, direction = dataset["matrix"].values, dataset["direction"].values
    check_axis(direction, "direction", "degree")
    expected = directional_stiffness(matrix, direction)
    if np.abs(dataset["stiffness"].values - expected).max() > ROUNDING * np.abs(matrix).max():
        raise SchemaError("The directional stiffness does not follow from the matrix.")


def _check_stiffness(matrix: np.ndarray, name: str) -> None:
    if matrix.shape != (3, 3) or not np.isfinite(matrix).all():
        raise SchemaError(f"The stiffness {name} must be 3 by 3 and finite.")
    if np.abs(matrix - matrix.T).max() > 1e-6 * np.abs(matrix).max():
        raise SchemaError(f"The stiffness {name} must be symmetric.")


def _check_fit(dataset: xr.Dataset) -> None:
    """Parameters in order, a shared and positive, and fitted values that follow from harmonics."""
    if list(dataset["parameter"].values) != list(PARAMETERS):
        raise SchemaError(f"The parameters of a fit are {', '.join(PARAMETERS)}, in this order.")
    direction = dataset["direction"].values
    check_axis(direction, "direction", "degree")
    for name in ("cos_coefficient", "sin_coefficient"):
        values = dataset[name].values
        if not np.isfinite(values).all() or np.ptp(values[:, 0], axis=0).max() > 0.0:
            raise SchemaError(f"{name} must be finite, and a the same for both sides.")
    for side in dataset["side"].values:
        quantity = str(dataset["onset_quantity"].sel(side=side).values)
        if side not in SIDES or quantity not in ONSET_QUANTITIES:
            raise SchemaError(f"A fit cannot have the side {side!s} with contact by {quantity!r}.")
        for name, expected in fit_parameters(dataset, side, direction).items():
            stored = dataset["fitted_value"].sel(side=side, parameter=name).values
            if not np.allclose(stored, expected, rtol=ROUNDING, atol=0.0, equal_nan=True):
                raise SchemaError(f"The fitted {name}, {side!s}, does not follow from harmonics.")
            if np.nanmin(expected, initial=np.inf) <= 0.0:
                raise SchemaError(f"The fitted {name}, {side!s}, is not positive everywhere.")
    _check_sheet(dataset)


def _check_sheet(dataset: xr.Dataset) -> None:
    """Matrices that are known are stiffnesses, and a of the variant "tangent" is that of C."""
    variant = str(dataset["variant"].values)
    if variant not in VARIANTS or not float(dataset["w_biaxial"]) >= 0.0:
        raise SchemaError(f"A fit cannot have the variant {variant!r}, or w_biaxial below 0.")
    for name in ("tangent", "in_plane"):
        if variant == "tangent" or not np.isnan(dataset[name].values).all():
            _check_stiffness(dataset[name].values, name)
    if variant == "tangent":
        directions = dataset["direction"].values
        expected = directional_stiffness(dataset["tangent"].values, directions)
        stored = dataset["fitted_value"].sel(parameter="a").values[0]
        if not np.allclose(stored, expected, rtol=ROUNDING, atol=0.0):
            raise SchemaError("The fitted a does not follow from the tangent.")


#: index arrays and the dimension they point into
_CELL_INDICES = {
    "triangles": "vertex",
    "triangle_edges": "edge",
    "edges": "vertex",
    "tets": "scale_vertex",
    "base_triangles": "scale_vertex",
    "surface_triangles": "scale_vertex",
}
_SHAPE_INDICES = {"triangles": "point", "tets": "point", "surface_triangles": "point"}


def _check_mesh(indices: dict[str, str]) -> Callable[[xr.Dataset], None]:
    def check(dataset: xr.Dataset) -> None:
        for name, variable in dataset.data_vars.items():
            if variable.dtype.kind == "f" and not _is_whole(variable):
                raise SchemaError(f"{name} holds values that are not finite.")
        for name, target in indices.items():
            values = dataset[name].values
            size = dataset.sizes[target]
            if values.size and (values.min() < 0 or values.max() >= size):
                raise SchemaError(f"{name} points outside the {size} entries of {target}.")
        (a, b), (c, d) = dataset["lattice"].values
        if not a * d - b * c > 0.0:
            raise SchemaError("The lattice vectors must be right-handed and independent.")

    return check


def _is_whole(variable: xr.DataArray) -> bool:
    """All finite; a deformed state that did not converge is missing as a whole."""
    finite = np.isfinite(variable.values)
    if variable.dims[:1] != ("sample",):
        return bool(finite.all())
    per_sample = finite.reshape(finite.shape[0], -1)
    return bool((per_sample.all(axis=1) == per_sample.any(axis=1)).all())


_CHECKS: dict[str, Callable[[xr.Dataset], None]] = {
    "cell": _check_mesh(_CELL_INDICES),
    "sweep": _check_sweep,
    "tangent": _check_tangent,
    "shape": _check_mesh(_SHAPE_INDICES),
    "fit": _check_fit,
    "sheet": check_sheet_samples,
    "turned_sheet": check_turned_sheet,
    "native_sheet": check_sheet_samples,
    "rig": check_rig,
    "native_rig": check_native_rig,
}

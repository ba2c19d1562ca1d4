"""Do datasets of whole sheets keep the promises of their kinds?"""

from __future__ import annotations

import numpy as np
import xarray as xr

from flexscale.datasets.sample_checks import check_axis, check_numbers, check_sides, check_status
from flexscale.datasets.sheet_schema import DEVICE_COORDINATES, DEVICE_VARIABLES
from flexscale.datasets.variables import VARIANTS, Variable
from flexscale.errors import SchemaError


def check_sheet_samples(dataset: xr.Dataset) -> None:
    """Sides, curvatures, sizes, and numbers exactly where the sheet converged."""
    check_sides(dataset, "sheet")
    curvature = dataset["curvature"].values
    check_axis(curvature, "curvature", "mm-1")
    if curvature[0] < 0.0:
        raise SchemaError("Curvatures of a sheet must not be negative: the side carries the sign.")
    _check_bent(dataset, "sheet")


def check_turned_sheet(dataset: xr.Dataset) -> None:
    """Energies, sides, directions, sizes, and numbers exactly where the sheet converged."""
    variants = [str(variant) for variant in dataset["variant"].values]
    if not variants or len(set(variants)) != len(variants) or not set(variants) <= set(VARIANTS):
        raise SchemaError(
            f"Turned sheets have the energies {variants}, not of {', '.join(VARIANTS)}, once each."
        )
    check_sides(dataset, "turned sheet")
    directions = dataset["direction"].values
    check_axis(directions, "direction", "degree")
    if directions[0] < 0.0 or directions[-1] >= 180.0:
        raise SchemaError("Directions of turned sheets must lie in [0, 180) degree.")
    if not float(dataset["curvature"]) > 0.0:
        raise SchemaError("The curvature of turned sheets must be positive: the side has the sign.")
    _check_bent(dataset, "turned sheet")


def _check_bent(dataset: xr.Dataset, what: str) -> None:
    """Signed curvatures, sizes, statuses, and numbers exactly where the sheet converged."""
    signs = np.where(dataset["side"].values == "closing", 1.0, -1.0)
    signed = np.multiply.outer(signs, dataset["curvature"].values)
    if not np.array_equal(dataset["signed_curvature"].values, signed):
        raise SchemaError(
            f"The signed curvatures of a {what} do not follow from side and curvature."
        )
    _check_sizes(dataset, ("length", "width"))
    status = dataset["status"]
    check_status(status, what)
    for variable in dataset.data_vars.values():
        if variable.dims == status.dims and variable.dtype.kind == "f":
            check_numbers(variable, status)


def check_rig(dataset: xr.Dataset) -> None:
    """One device or both, each complete, with numbers exactly where it converged."""
    check_sides(dataset, "rig")
    present = [device for device in DEVICE_VARIABLES if f"{device}_status" in dataset]
    if not present:
        raise SchemaError("A rig dataset holds neither a mandrel nor a stage.")
    for device, declared in DEVICE_VARIABLES.items():
        own = (*DEVICE_COORDINATES[device], *declared)
        _check_complete(dataset, device, own, device in present)
    if "mandrel" in present:
        angles = dataset["angle"].values
        check_axis(angles, "angle", "degree")
        if angles[0] < 0.0 or angles[-1] >= 360.0:
            raise SchemaError("Angles of the mandrel must lie in [0, 360) degree.")
        _check_sizes(dataset, ("mandrel_radius", "mandrel_hub", "mandrel_indentation"))
    if "stage" in present:
        check_axis(dataset["shortening"].values, "shortening", "mm")
        _check_sizes(dataset, ("stage_length", "stage_width"))
    for device in present:
        status = dataset[f"{device}_status"]
        check_status(status, "rig")
        for item in DEVICE_VARIABLES[device]:
            if item.dtype == "float64":
                check_numbers(dataset[item.name], status)


def check_native_rig(dataset: xr.Dataset) -> None:
    """Sides, shortenings, sizes, and numbers exactly where the strip converged."""
    check_sides(dataset, "native rig")
    shortening = dataset["shortening"].values
    check_axis(shortening, "shortening", "mm")
    if shortening[0] <= 0.0:
        raise SchemaError("Shortenings must be positive: a flat strip carries any force.")
    _check_sizes(dataset, ("stage_length", "stage_width"))
    status = dataset["stage_status"]
    check_status(status, "native rig")
    for variable in dataset.data_vars.values():
        if variable.dims == status.dims and variable.dtype.kind == "f":
            check_numbers(variable, status)


def _check_complete(
    dataset: xr.Dataset, device: str, own: tuple[Variable, ...], present: bool
) -> None:
    wrong = [item.name for item in own if (item.name in dataset.variables) != present]
    if wrong:
        word = "lacks" if present else "has no status of its"
        raise SchemaError(f"The rig dataset {word} {device}: {', '.join(wrong)}.")


def _check_sizes(dataset: xr.Dataset, names: tuple[str, ...]) -> None:
    for name in names:
        value = float(dataset[name])
        if not (np.isfinite(value) and value > 0.0):
            raise SchemaError(f"{name} is {value:g} mm, but must be positive.")

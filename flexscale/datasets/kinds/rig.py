"""Kind `rig`: a macro model on the testing devices."""

from __future__ import annotations

import xarray as xr

from flexscale.datasets.device_variables import DEVICE_COORDINATES, DEVICE_VARIABLES
from flexscale.datasets.sample_checks import check_axis, check_numbers, check_sides, check_status
from flexscale.datasets.sheet_variables import check_sizes
from flexscale.datasets.variables import SIDE, Schema, Variable
from flexscale.errors import SchemaError


def _check_rig(dataset: xr.Dataset) -> None:
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
        check_sizes(dataset, ("mandrel_radius", "mandrel_hub", "mandrel_indentation"))
    if "stage" in present:
        check_axis(dataset["shortening"].values, "shortening", "mm")
        check_sizes(dataset, ("stage_length", "stage_width"))
    for device in present:
        status = dataset[f"{device}_status"]
        check_status(status, "rig")
        for item in DEVICE_VARIABLES[device]:
            if item.dtype == "float64":
                check_numbers(dataset[item.name], status)


def _check_complete(
    dataset: xr.Dataset, device: str, own: tuple[Variable, ...], present: bool
) -> None:
    wrong = [item.name for item in own if (item.name in dataset.variables) != present]
    if wrong:
        word = "lacks" if present else "has no status of its"
        raise SchemaError(f"The rig dataset {word} {device}: {', '.join(wrong)}.")


RIG = Schema(
    "rig",
    1,
    "Macro model on the testing devices: disc on the mandrel, strip on the stage",
    coordinates=(SIDE, *DEVICE_COORDINATES["mandrel"], *DEVICE_COORDINATES["stage"]),
    variables=(*DEVICE_VARIABLES["mandrel"], *DEVICE_VARIABLES["stage"]),
    check=_check_rig,
)

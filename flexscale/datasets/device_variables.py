"""What kinds of sheets on the testing devices share: axes, sizes and variables of each device."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import xarray as xr
from numpy.typing import ArrayLike

from flexscale.datasets.build import build_dataset
from flexscale.datasets.sample_checks import check_axis, check_numbers, check_sides, check_status
from flexscale.datasets.sheet_variables import COUNTS, Measured, check_sizes, number
from flexscale.datasets.variables import STATUS_ATTRS, Schema, Variable
from flexscale.errors import SchemaError

#: Name, unit and long name.
Measurement = tuple[str, str, str]
#: Device -> its part, its axis, and what it alone measures.
_DEVICES: dict[str, tuple[str, str, tuple[Measurement, ...]]] = {
    "mandrel": ("disc", "angle", (("force", "N", "force of the probe"),)),
    "stage": (
        "strip",
        "shortening",
        (
            ("force", "N", "force on the hinges"),
            ("deflection", "mm", "deflection of the middle, to the outer side of the arc"),
        ),
    ),
}


def device_variables(
    measured: Measurement,
    counted: Sequence[tuple[str, str]] = COUNTS,
    sizes: Sequence[tuple[str, str]] = (),
) -> dict[str, Measured]:
    """Variables of each device over side and its own axis; a dataset has all of them or none.

    Parameters
    ----------
    measured : name, unit and long name of what a kind measures on either, "{part}" in the latter.
    counted, sizes : names and long names of whole numbers of each sample, and of each device.
    """
    found = {}
    for device, (part, axis, own) in _DEVICES.items():
        dims = ("side", axis)
        numbers = (*own, ("energy", "N mm", "elastic energy of the {part}"), measured)
        end = f"end of the solve, {part}"
        found[device] = (
            *(
                Variable(
                    f"{device}_{name}", dims, "float64", units, meaning.format(part=part), True
                )
                for name, units, meaning in numbers
            ),
            *(_count(f"{device}_{name}", dims, f"{meaning}, {part}") for name, meaning in counted),
            Variable(f"{device}_status", dims, "int8", "1", end, True, STATUS_ATTRS),
            *(_count(f"{device}_{name}", (), f"{meaning}, {part}") for name, meaning in sizes),
        )
    return found


def _count(name: str, dims: tuple[str, ...], long_name: str) -> Variable:
    return Variable(name, dims, "int32", "1", long_name, True)


def size(name: str, units: str, long_name: str) -> Variable:
    return Variable(name, (), "float64", units, long_name, True)


STRIP = (
    number("stage_length", (), "mm", "length of the strip between its hinges"),
    number("stage_width", (), "mm", "width of the strip"),
    number("stage_direction", (), "degree", "direction of the length in the pattern's coordinates"),
)
#: Device -> its axis and sizes.
DEVICE_COORDINATES = {
    "mandrel": (
        Variable("angle", ("angle",), "float64", "degree", "angle around the rim", True),
        size("mandrel_radius", "mm", "radius of the disc"),
        size("mandrel_hub", "mm", "radius of the hub that holds the disc"),
        size("mandrel_indentation", "mm", "indentation of the rim, normal to the disc"),
    ),
    "stage": (
        Variable("shortening", ("shortening",), "float64", "mm", "shortening of the strip", True),
        *(replace(item, optional=True) for item in STRIP),
    ),
}


def check_devices(dataset: xr.Dataset, what: str, variables: Mapping[str, Measured]) -> None:
    """One device or both, each complete, with numbers exactly where it converged.

    Parameters
    ----------
    variables : of each device.
    """
    check_sides(dataset, what)
    present = [device for device in variables if f"{device}_status" in dataset]
    if not present:
        raise SchemaError(f"A {what} dataset holds neither a mandrel nor a stage.")
    for device, declared in variables.items():
        own = (*DEVICE_COORDINATES[device], *declared)
        _check_complete(dataset, what, own, device, device in present)
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
        check_status(status, what)
        for item in variables[device]:
            if item.dtype == "float64":
                check_numbers(dataset[item.name], status)


def _check_complete(
    dataset: xr.Dataset, what: str, own: Measured, device: str, present: bool
) -> None:
    wrong = [item.name for item in own if (item.name in dataset.variables) != present]
    if wrong:
        word = "lacks" if present else "has no status of its"
        raise SchemaError(f"The {what} dataset {word} {device}: {', '.join(wrong)}.")


def build_rig_dataset(
    schema: Schema,
    sides: Sequence[str],
    devices: Mapping[str, Mapping[str, ArrayLike]],
    *,
    scalars: Mapping[str, float | str],
    config: Mapping[str, Any],
) -> xr.Dataset:
    """Dataset of kind rig, or native_rig.

    Parameters
    ----------
    schema : of kind rig, or native_rig.
    sides : of "closing", "opening".
    devices : of "mandrel" and "stage" one or both; each with its axis ("angle" in degree, or
        "shortening" in mm, increasing), and its sizes and variables by the names of the schema
        without the device's. Variables are (n_sides, n_axis), or of the whole device.
    scalars, config : as in `build_sweep_dataset`.
    """
    values: dict[str, Any] = {"side": list(sides)}
    for device, arrays in devices.items():
        for name, value in arrays.items():
            own = name in ("angle", "shortening")
            values[name if own else f"{device}_{name}"] = value
    return build_dataset(schema, values, scalars=scalars, config=config)

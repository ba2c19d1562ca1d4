"""Kind `native_rig`: scales on joints on the testing devices."""

from __future__ import annotations

import xarray as xr

from flexscale.datasets.device_variables import DEVICE_COORDINATES, check_devices
from flexscale.datasets.sheet_variables import COUNTS, Measured
from flexscale.datasets.variables import SIDE, STATUS_ATTRS, Schema, Variable
from flexscale.errors import SchemaError

_COUNTS = (
    *COUNTS,
    ("contact_pairs", "active contact pairs"),
    ("outside_range", "stations of joints beyond the range of their law"),
)


def _of_device(device: str, part: str, axis: str, *own: tuple[str, str, str]) -> Measured:
    dims = ("side", axis)
    numbers = (
        *own,
        ("energy", "N mm", f"elastic energy of the {part}"),
        ("min_gap", "mm", f"smallest distance between scales of the {part}"),
    )
    sizes = (("n_scales", "scales, cut ones included"), ("n_unknowns", "unknowns of the model"))
    return (
        *(
            Variable(f"{device}_{name}", dims, "float64", units, long_name, True)
            for name, units, long_name in numbers
        ),
        *(
            Variable(f"{device}_{name}", dims, "int32", "1", f"{long_name}, {part}", True)
            for name, long_name in _COUNTS
        ),
        Variable(
            f"{device}_status", dims, "int8", "1", f"end of the solve, {part}", True, STATUS_ATTRS
        ),
        *(
            Variable(f"{device}_{name}", (), "int32", "1", f"{long_name}, {part}", True)
            for name, long_name in sizes
        ),
    )


VARIABLES = {
    "mandrel": _of_device("mandrel", "disc", "angle", ("force", "N", "force of the probe")),
    "stage": _of_device(
        "stage",
        "strip",
        "shortening",
        ("force", "N", "force on the hinges"),
        ("deflection", "mm", "deflection of the middle, to the outer side of the arc"),
    ),
}


def _check_native_rig(dataset: xr.Dataset) -> None:
    """One device or both, each complete, with numbers exactly where it converged."""
    check_devices(dataset, "native rig", VARIABLES)
    if "stage_status" in dataset and float(dataset["shortening"].values[0]) <= 0.0:
        raise SchemaError("Shortenings must be positive: a flat strip carries any force.")


NATIVE_RIG = Schema(
    "native_rig",
    2,
    "Scales on the testing devices: disc on the mandrel, strip on the stage",
    coordinates=(SIDE, *DEVICE_COORDINATES["mandrel"], *DEVICE_COORDINATES["stage"]),
    variables=(*VARIABLES["mandrel"], *VARIABLES["stage"]),
    check=_check_native_rig,
)

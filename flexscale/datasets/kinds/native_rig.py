"""Kind `native_rig`: scales on joints on the testing devices."""

from __future__ import annotations

import xarray as xr

from flexscale.datasets.device_variables import (
    DEVICE_COORDINATES,
    check_devices,
    device_variables,
)
from flexscale.datasets.sheet_variables import COUNTS
from flexscale.datasets.variables import SIDE, Schema
from flexscale.errors import SchemaError

VARIABLES = device_variables(
    ("min_gap", "mm", "smallest distance between scales of the {part}"),
    counted=(
        *COUNTS,
        ("contact_pairs", "active contact pairs"),
        ("outside_range", "stations of joints beyond the range of their law"),
    ),
    sizes=(("n_scales", "scales, cut ones included"), ("n_unknowns", "unknowns of the model")),
)


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

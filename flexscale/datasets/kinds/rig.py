"""Kind `rig`: a macro model on the testing devices."""

from __future__ import annotations

import xarray as xr

from flexscale.datasets.device_variables import (
    DEVICE_COORDINATES,
    check_devices,
    device_variables,
)
from flexscale.datasets.variables import SIDE, Schema

VARIABLES = device_variables(
    ("largest_curvature", "mm-1", "largest principal curvature in the {part}")
)


def _check_rig(dataset: xr.Dataset) -> None:
    """One device or both, each complete, with numbers exactly where it converged."""
    check_devices(dataset, "rig", VARIABLES)


RIG = Schema(
    "rig",
    1,
    "Macro model on the testing devices: disc on the mandrel, strip on the stage",
    coordinates=(SIDE, *DEVICE_COORDINATES["mandrel"], *DEVICE_COORDINATES["stage"]),
    variables=(*VARIABLES["mandrel"], *VARIABLES["stage"]),
    check=_check_rig,
)

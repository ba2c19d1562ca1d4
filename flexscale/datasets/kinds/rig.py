"""Kind `rig`: a macro model on the testing devices."""

from __future__ import annotations

import xarray as xr

from flexscale.datasets.device_variables import (
    DEVICE_COORDINATES,
    DEVICE_VARIABLES,
    check_devices,
)
from flexscale.datasets.variables import SIDE, Schema


def _check_rig(dataset: xr.Dataset) -> None:
    """One device or both, each complete, with numbers exactly where it converged."""
    check_devices(dataset, "rig", DEVICE_VARIABLES)


RIG = Schema(
    "rig",
    1,
    "Macro model on the testing devices: disc on the mandrel, strip on the stage",
    coordinates=(SIDE, *DEVICE_COORDINATES["mandrel"], *DEVICE_COORDINATES["stage"]),
    variables=(*DEVICE_VARIABLES["mandrel"], *DEVICE_VARIABLES["stage"]),
    check=_check_rig,
)

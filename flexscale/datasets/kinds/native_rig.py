"""Kind `native_rig`: a strip of scales on the stage."""

from __future__ import annotations

import xarray as xr

from flexscale.datasets.device_variables import STRIP
from flexscale.datasets.sample_checks import check_axis, check_numbers, check_sides, check_status
from flexscale.datasets.sheet_variables import COUNTS, SIZES, check_sizes, number
from flexscale.datasets.variables import SIDE, STATUS_ATTRS, Schema, Variable
from flexscale.errors import SchemaError

_SHORTENED = ("side", "shortening")


def _check_native_rig(dataset: xr.Dataset) -> None:
    """Sides, shortenings, sizes, and numbers exactly where the strip converged."""
    check_sides(dataset, "native rig")
    shortening = dataset["shortening"].values
    check_axis(shortening, "shortening", "mm")
    if shortening[0] <= 0.0:
        raise SchemaError("Shortenings must be positive: a flat strip carries any force.")
    check_sizes(dataset, ("stage_length", "stage_width"))
    status = dataset["stage_status"]
    check_status(status, "native rig")
    for variable in dataset.data_vars.values():
        if variable.dims == status.dims and variable.dtype.kind == "f":
            check_numbers(variable, status)


NATIVE_RIG = Schema(
    "native_rig",
    1,
    "Strip of whole and cut scales on the stage",
    coordinates=(
        SIDE,
        number("shortening", ("shortening",), "mm", "shortening of the strip"),
        *STRIP,
    ),
    variables=(
        number("stage_force", _SHORTENED, "N", "force on the hinges"),
        number("stage_energy", _SHORTENED, "N mm", "elastic energy of the strip"),
        number(
            "stage_deflection",
            _SHORTENED,
            "mm",
            "deflection of the middle, to the outer side of the arc",
        ),
        number("stage_min_gap", _SHORTENED, "mm", "smallest distance between scales"),
        *(
            Variable(f"stage_{name}", _SHORTENED, "int32", "1", f"{long_name}, strip")
            for name, long_name in (*COUNTS, ("contact_pairs", "active contact pairs"))
        ),
        Variable(
            "stage_status", _SHORTENED, "int8", "1", "end of the solve, strip", attrs=STATUS_ATTRS
        ),
        *SIZES,
    ),
    check=_check_native_rig,
)

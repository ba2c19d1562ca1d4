"""Kind `turned_sheet`: sheets of macro models, with the pattern turned on them."""

from __future__ import annotations

import xarray as xr

from flexscale.datasets.sheet_variables import (
    TURNED,
    check_turned,
    number,
    response,
    steepest,
    strips,
)
from flexscale.datasets.variables import VARIANTS, Schema, Variable
from flexscale.errors import SchemaError

_TURNED = ("variant", *TURNED)


def _check_turned_sheet(dataset: xr.Dataset) -> None:
    """Energies of a curvature tensor, and what all turned sheets keep."""
    variants = [str(variant) for variant in dataset["variant"].values]
    if not variants or len(set(variants)) != len(variants) or not set(variants) <= set(VARIANTS):
        raise SchemaError(
            f"Turned sheets have the energies {variants}, not of {', '.join(VARIANTS)}, once each."
        )
    check_turned(dataset)


TURNED_SHEET = Schema(
    "turned_sheet",
    1,
    "Rectangular sheets of macro models between end strips, with the pattern turned on them",
    coordinates=(
        Variable("variant", ("variant",), "text", "", "energy of a curvature tensor"),
        *strips((), ("direction",)),
    ),
    variables=(
        *response(_TURNED),
        steepest(_TURNED),
        number(
            "law_energy_density",
            _TURNED,
            "N mm-1",
            "energy per area of the model bent to the cylinder everywhere",
        ),
    ),
    check=_check_turned_sheet,
)

"""Kind `turned_sheet`: sheets of macro models, with the pattern turned on them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from flexscale.datasets.build import build_dataset
from flexscale.datasets.sample_checks import check_axis, check_sides
from flexscale.datasets.sheet_variables import check_bent, number, response, sided, steepest, strips
from flexscale.datasets.variables import VARIANTS, Schema, Variable
from flexscale.errors import SchemaError

_TURNED = ("variant", "side", "direction")


def _check_turned_sheet(dataset: xr.Dataset) -> None:
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
    check_bent(dataset, "turned sheet")


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


def build_turned_sheet_dataset(
    variants: Sequence[str],
    sides: Sequence[str],
    directions: ArrayLike,
    arrays: Mapping[str, ArrayLike],
    *,
    curvature: float,
    length: float,
    width: float,
    scalars: Mapping[str, float | str],
    config: Mapping[str, Any],
) -> xr.Dataset:
    """Dataset of kind turned_sheet.

    Parameters
    ----------
    variants : energies of a curvature tensor, of `variables.VARIANTS`.
    sides : of "closing", "opening".
    directions : (n,) degree, increasing, of the lengths in the pattern's coordinates.
    arrays : (n_variants, n_sides, n) variables by the names of the schema; real values become nan
        wherever `status` is not 0.
    curvature : mm-1, positive.
    length, width : mm.
    scalars, config : as in `build_sweep_dataset`.
    """
    values = {
        **arrays,
        **sided(sides, curvature),
        "variant": list(variants),
        "direction": np.asarray(directions, dtype=float),
        "length": length,
        "width": width,
    }
    return build_dataset(TURNED_SHEET, values, scalars=scalars, config=config)

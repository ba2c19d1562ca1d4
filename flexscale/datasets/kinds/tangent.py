"""Kind `tangent`: bending and in-plane stiffness of the flat cell."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from flexscale.datasets.build import build_dataset
from flexscale.datasets.sample_checks import ROUNDING, check_axis
from flexscale.datasets.stiffness import (
    BENDING,
    IN_PLANE,
    VOIGT,
    check_stiffness,
    directional_stiffness,
    matrix,
)
from flexscale.datasets.variables import COMPONENTS, DIRECTION, Schema, Variable
from flexscale.errors import SchemaError


def _check_tangent(dataset: xr.Dataset) -> None:
    for name in ("matrix", "in_plane"):
        check_stiffness(dataset[name].values, name)
    bending, direction = dataset["matrix"].values, dataset["direction"].values
    check_axis(direction, "direction", "degree")
    expected = directional_stiffness(bending, direction)
    if np.abs(dataset["stiffness"].values - expected).max() > ROUNDING * np.abs(bending).max():
        raise SchemaError("The directional stiffness does not follow from the matrix.")


TANGENT = Schema(
    "tangent",
    2,
    "Stiffness of a periodic scaled sheet at rest",
    coordinates=(DIRECTION, *VOIGT),
    variables=(
        matrix("matrix", "N mm", BENDING),
        matrix("in_plane", "N mm-1", IN_PLANE),
        Variable(
            "stiffness", ("direction",), "float64", "N mm", "moment per curvature in a direction"
        ),
    ),
    check=_check_tangent,
)


def build_tangent_dataset(
    bending: ArrayLike,
    in_plane: ArrayLike,
    directions: ArrayLike,
    *,
    scalars: Mapping[str, float | str],
    config: Mapping[str, Any],
) -> xr.Dataset:
    """Dataset of kind tangent; the stiffness in each direction follows from the matrix.

    Parameters
    ----------
    bending : (3, 3) N mm, C in energy density 1/2 k C k with k = (kxx, kyy, 2 kxy).
    in_plane : (3, 3) N mm-1, energy density 1/2 E A E with E = (Exx, Eyy, 2 Exy).
    directions : (n,) degree.
    scalars, config : as in `build_sweep_dataset`.
    """
    angles = np.asarray(directions, dtype=float)
    stiffness = np.asarray(bending, dtype=float)
    values = {
        "matrix": stiffness,
        "in_plane": in_plane,
        "stiffness": directional_stiffness(stiffness, angles),
        "direction": angles,
        "component": list(COMPONENTS),
        "other_component": list(COMPONENTS),
    }
    dataset = build_dataset(TANGENT, values, scalars=scalars, config=config)
    return dataset.sortby("direction")

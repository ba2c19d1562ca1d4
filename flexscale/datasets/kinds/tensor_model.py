"""Kind `tensor_model`: the macro model of any bending, gaps that close and a correction."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from flexscale.datasets.build import build_dataset
from flexscale.datasets.mesh_variables import array
from flexscale.datasets.stiffness import BENDING, IN_PLANE, VOIGT, check_stiffness, matrix
from flexscale.datasets.variables import COMPONENTS, STATISTICS, Schema
from flexscale.errors import SchemaError

QUANTITIES = ("energy", "moment")
REGIMES = ("before_contact", "in_contact")
RAY_AXES = ("direction", "shape", "curvature")
_LEAST_GRID = 4  # coefficients of a cubic spline


def _check_tensor_model(dataset: xr.Dataset) -> None:
    """Matrices are stiffnesses; gaps, turns and the correction are finite; errors not negative."""
    for name in ("tangent", "in_plane"):
        check_stiffness(dataset[name].values, name)
    for name in ("distances", "slopes", "compliance", "turns", "correction"):
        if not np.isfinite(dataset[name].values).all():
            raise SchemaError(f"{name} of a tensor model holds values that are not finite.")
    n = dataset["distances"].size
    if dataset["compliance"].shape != (n, n) or dataset["turns"].shape != (n, 3, 3):
        raise SchemaError("Compliance and turns of a tensor model need a row for each gap.")
    for name in ("compliance", "turns"):
        values = dataset[name].values
        other = np.swapaxes(values, -2, -1)
        if not np.allclose(values, other, rtol=0.0, atol=1e-9 * np.abs(values).max(initial=0.0)):
            raise SchemaError(f"{name} of a tensor model must be symmetric.")
    shape = dataset["correction"].shape
    if len(set(shape)) != 1 or shape[0] < _LEAST_GRID:
        raise SchemaError(f"The correction of a tensor model is a cubic grid, not one of {shape}.")
    for name in ("softening", "contact_softening"):
        if not 0.0 <= float(dataset[name]) < np.inf:
            raise SchemaError(f"{name} of a tensor model is {float(dataset[name]):g}, below 0.")
    if not 0.0 < float(dataset["largest_curvature"]) < np.inf:
        raise SchemaError("The largest curvature of a tensor model must be above 0.")
    errors = dataset["held_out_error"].values
    if not (np.isnan(errors) | (errors >= 0.0)).all():
        raise SchemaError("The errors of a tensor model must not be negative.")


TENSOR_MODEL = Schema(
    "tensor_model",
    1,
    "Macro model of any bending: gaps that close, fitted to a tensor sweep, and a correction",
    coordinates=(
        array("direction", "direction", "float64", "direction of the larger principal curvature",
              "degree"),
        array("shape", "shape", "float64", "angle of the principal curvatures", "degree"),
        array("curvature", "curvature", "float64", "root of the sum of their squares", "mm-1"),
        *VOIGT,
        array("quantity", "quantity", "text", "what an error is of", ""),
        array("regime", "regime", "text", "whether scales touch", ""),
        array("statistic", "statistic", "text", "statistic of absolute relative errors", ""),
    ),
    variables=(
        matrix("tangent", "N mm", BENDING),
        matrix("in_plane", "N mm-1", IN_PLANE),
        array("distances", "contact", "float64", "gaps g between scales at rest", "mm"),
        array("slopes", "contact component", "float64", "slopes G of the gaps by k", "mm2"),
        array(
            "compliance",
            "contact other_contact",
            "float64",
            "compliance S of the gaps: opening by pressures (force over cell area)",
            "mm3 N-1",
        ),
        array(
            "turns",
            "contact component other_component",
            "float64",
            "turns Q of the gaps: second derivatives by k",
            "mm3",
        ),
        array("softening", "", "float64", "s: energy E before contact is log(1 + s E)/s", "mm N-1"),
        array("contact_softening", "", "float64", "the same for the energy of contact", "mm N-1"),
        array(
            "correction",
            "grid_xx grid_yy grid_xy",
            "float64",
            "coefficients of the cubic spline c, energy = exp(c) times that of the gaps, over "
            "(kxx, kyy, sqrt(2) kxy)",
        ),
        array(
            "largest_curvature",
            "",
            "float64",
            "root of the sum of squares of the principal curvatures up to which the sweep goes",
            "mm-1",
        ),
        array(
            "held_out_error",
            "quantity regime statistic",
            "float64",
            "absolute relative error at rays that a fit to all others had not seen",
        ),
        array("energy_error", "direction shape curvature", "float64",
              "relative error of energies at the samples of the sweep, fitted ones"),
        array("n_ignored", "", "int32", "samples of the sweep that did not converge"),
    ),
    check=_check_tensor_model,
)  # fmt: skip


def build_tensor_model_dataset(
    arrays: Mapping[str, ArrayLike],
    *,
    scalars: Mapping[str, float | str],
    config: Mapping[str, Any],
) -> xr.Dataset:
    """Dataset of kind tensor_model.

    Parameters
    ----------
    arrays : variables by the names of the schema.
    scalars, config : as in `build_dataset`.
    """
    values = {
        **arrays,
        "component": list(COMPONENTS),
        "other_component": list(COMPONENTS),
        "quantity": list(QUANTITIES),
        "regime": list(REGIMES),
        "statistic": list(STATISTICS),
    }
    return build_dataset(TENSOR_MODEL, values, scalars=scalars, config=config)

"""Kind `fit`: the macro model, a two-regime law in every direction."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from flexscale.datasets.build import build_dataset
from flexscale.datasets.fit_values import ONSET_QUANTITIES, PARAMETERS, fit_parameters
from flexscale.datasets.mesh_variables import array
from flexscale.datasets.sample_checks import ROUNDING, check_axis
from flexscale.datasets.stiffness import (
    BENDING,
    IN_PLANE,
    VOIGT,
    check_stiffness,
    directional_stiffness,
    matrix,
)
from flexscale.datasets.variables import (
    ASSESSMENTS,
    COMPONENTS,
    DIRECTION,
    SIDE,
    STATISTICS,
    VARIANTS,
    Schema,
    Variable,
)
from flexscale.errors import SchemaError
from flexscale.sides import SIDES

_MIXED = {"comment": "units: see parameter_units"}
_COEFFICIENT = {"comment": "units: see parameter_units; mm where onset_quantity is 1/kappa_0"}
_PARAMETRIC = ("side", "parameter", "direction")
_ERROR = "assessment side direction"
_OVERALL = "assessment side"


def _check_fit(dataset: xr.Dataset) -> None:
    """Parameters in order, a shared and positive, and fitted values that follow from harmonics."""
    if list(dataset["parameter"].values) != list(PARAMETERS):
        raise SchemaError(f"The parameters of a fit are {', '.join(PARAMETERS)}, in this order.")
    direction = dataset["direction"].values
    check_axis(direction, "direction", "degree")
    for name in ("cos_coefficient", "sin_coefficient"):
        values = dataset[name].values
        if not np.isfinite(values).all() or np.ptp(values[:, 0], axis=0).max() > 0.0:
            raise SchemaError(f"{name} must be finite, and a the same for both sides.")
    for side in dataset["side"].values:
        quantity = str(dataset["onset_quantity"].sel(side=side).values)
        if side not in SIDES or quantity not in ONSET_QUANTITIES:
            raise SchemaError(f"A fit cannot have the side {side!s} with contact by {quantity!r}.")
        for name, expected in fit_parameters(dataset, side, direction).items():
            stored = dataset["fitted_value"].sel(side=side, parameter=name).values
            if not np.allclose(stored, expected, rtol=ROUNDING, atol=0.0, equal_nan=True):
                raise SchemaError(f"The fitted {name}, {side!s}, does not follow from harmonics.")
            if np.nanmin(expected, initial=np.inf) <= 0.0:
                raise SchemaError(f"The fitted {name}, {side!s}, is not positive everywhere.")
    _check_sheet(dataset)


def _check_sheet(dataset: xr.Dataset) -> None:
    """Matrices that are known are stiffnesses, and a of the variant "tangent" is that of C."""
    variant = str(dataset["variant"].values)
    if variant not in VARIANTS or not float(dataset["w_biaxial"]) >= 0.0:
        raise SchemaError(f"A fit cannot have the variant {variant!r}, or w_biaxial below 0.")
    for name in ("tangent", "in_plane"):
        if variant == "tangent" or not np.isnan(dataset[name].values).all():
            check_stiffness(dataset[name].values, name)
    if variant == "tangent":
        directions = dataset["direction"].values
        expected = directional_stiffness(dataset["tangent"].values, directions)
        stored = dataset["fitted_value"].sel(parameter="a").values[0]
        if not np.allclose(stored, expected, rtol=ROUNDING, atol=0.0):
            raise SchemaError("The fitted a does not follow from the tangent.")


FIT = Schema(
    "fit",
    2,
    "Macro model of a scaled sheet: two-regime bending law in every direction",
    coordinates=(
        SIDE,
        DIRECTION,
        Variable("parameter", ("parameter",), "text", "", "a before, b after contact at kappa_0"),
        Variable("parameter_units", ("parameter",), "text", "", "units of the parameter"),
        *VOIGT,
        Variable("harmonic", ("harmonic",), "int32", "1", "order k of cos 2k and sin 2k"),
        Variable("assessment", ("assessment",), "text", "", "samples the errors are taken at"),
        Variable("statistic", ("statistic",), "text", "", "statistic over samples"),
    ),
    variables=(
        Variable(
            "cos_coefficient",
            ("side", "parameter", "harmonic"),
            "float64",
            "",
            "coefficient of cos 2k direction",
            attrs=_COEFFICIENT,
        ),
        Variable(
            "sin_coefficient",
            ("side", "parameter", "harmonic"),
            "float64",
            "",
            "coefficient of sin 2k direction",
            attrs=_COEFFICIENT,
        ),
        Variable("order", ("parameter",), "int32", "1", "highest order of the parameter"),
        Variable(
            "onset_quantity",
            ("side",),
            "text",
            "",
            "what the harmonics of kappa_0 interpolate: kappa_0, 1/kappa_0, or none (no contact)",
        ),
        Variable(
            "directional_value",
            _PARAMETRIC,
            "float64",
            "",
            "parameter fitted in one direction, nan without contact",
            attrs=_MIXED,
        ),
        Variable(
            "fitted_value",
            _PARAMETRIC,
            "float64",
            "",
            "parameter by the harmonics, nan without contact",
            attrs=_MIXED,
        ),
        array("samples_before", "side direction", "int32", "samples up to the onset"),
        array("samples_beyond", "side direction", "int32", "samples beyond the onset"),
        array("energy_rmse", _ERROR, "float64", "error of the energy", "N mm-1"),
        array("moment_rmse", _ERROR, "float64", "error of the moment", "N"),
        array(
            "moment_error",
            f"{_ERROR} statistic",
            "float64",
            "relative error of the moment",
        ),
        array("overall_energy_rmse", _OVERALL, "float64", "error of energy", "N mm-1"),
        array("overall_moment_rmse", _OVERALL, "float64", "error of the moment", "N"),
        array(
            "overall_moment_error",
            f"{_OVERALL} statistic",
            "float64",
            "relative error of the moment over all directions",
        ),
        array("largest_curvature", "", "float64", "largest curvature sampled", "mm-1"),
        array("n_parameters", "", "int32", "numbers that define the model"),
        array("n_ignored", "", "int32", "samples ignored, not converged"),
        Variable("weighting", (), "text", "", "weights of the samples: relative or absolute"),
        Variable("variant", (), "text", "", "energy of a curvature tensor: tangent or paper"),
        matrix("tangent", "N mm", f"{BENDING}, nan if not known"),
        matrix("in_plane", "N mm-1", f"{IN_PLANE}, nan if not known"),
        array("w_biaxial", "", "float64", "energy density 1/2 w det(k)^2", "N mm3"),
        array("softening", "", "float64", "s: energy E before contact is log(1 + s E)/s", "mm N-1"),
    ),
    check=_check_fit,
)


def build_fit_dataset(
    sides: Sequence[str],
    directions: ArrayLike,
    arrays: Mapping[str, ArrayLike],
    *,
    scalars: Mapping[str, float | str],
    config: Mapping[str, Any],
) -> xr.Dataset:
    """Dataset of kind fit.

    Parameters
    ----------
    sides : of "closing", "opening".
    directions : (n,) degree, increasing.
    arrays : variables by the names of the schema; the parameters are a, b, kappa_0, in this order.
    scalars, config : as in `build_sweep_dataset`.
    """
    values = {
        **arrays,
        "side": list(sides),
        "direction": np.asarray(directions, dtype=float),
        "parameter": list(PARAMETERS),
        "parameter_units": ["N mm", "N mm", "mm-1"],
        "component": list(COMPONENTS),
        "other_component": list(COMPONENTS),
        "harmonic": np.arange(np.shape(arrays["cos_coefficient"])[-1]),
        "assessment": list(ASSESSMENTS),
        "statistic": list(STATISTICS),
    }
    return build_dataset(FIT, values, scalars=scalars, config=config)

"""Macro models as datasets of kind fit, and back."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.datasets.checks import check_dataset
from flexscale.datasets.fit_values import PARAMETERS
from flexscale.datasets.given import read_config, read_labels, require_variables
from flexscale.datasets.kinds.fit import FIT, build_fit_dataset
from flexscale.datasets.variables import ASSESSMENTS, STATISTICS
from flexscale.errors import SchemaError
from flexscale.macro.assessment import FitErrors
from flexscale.macro.harmonics import Harmonics
from flexscale.macro.polar import DirectionalLaws, PolarLaw
from flexscale.sides import SOME_SIDES

if TYPE_CHECKING:
    import xarray as xr

    from flexscale.macro.model import MacroModel

#: Axes that are the same in all datasets of this kind.
_FIXED = {"parameter": PARAMETERS, "assessment": ASSESSMENTS, "statistic": STATISTICS}
_ERRORS = tuple(FitErrors.__dataclass_fields__)


def write_model(model: MacroModel) -> xr.Dataset:
    """Dataset of kind fit; all of the model is in it."""
    sampled, fitted = [], []
    for side in range(len(model.sides)):
        law, smooth = model.laws.law(side), model.polar.law(model.laws.directions, side)
        sampled.append([law.a, law.b, law.kappa_0])
        fitted.append([smooth.a, smooth.b, smooth.kappa_0])
    arrays: dict[str, Any] = {name: getattr(model.errors, name) for name in _ERRORS}
    arrays |= {
        "cos_coefficient": _coefficients(model.polar, "cosine"),
        "sin_coefficient": _coefficients(model.polar, "sine"),
        "order": [model.polar.a.order, model.polar.b[0].order, model.polar.onset[0].order],
        "onset_quantity": list(model.polar.onset_quantity),
        "directional_value": np.array(sampled),
        "fitted_value": np.array(fitted),
        "samples_before": model.laws.n_before,
        "samples_beyond": model.laws.n_beyond,
        "largest_curvature": model.largest_curvature,
        "n_parameters": model.n_parameters,
        "n_ignored": model.n_ignored,
        "weighting": model.weighting,
        "variant": model.variant,
        "tangent": _or_nan(model.tangent),
        "in_plane": _or_nan(model.in_plane),
        "w_biaxial": model.w_biaxial,
        "softening": model.polar.softening,
    }
    return build_fit_dataset(
        model.sides,
        model.laws.directions,
        arrays,
        scalars=model.labels,
        config=model.config,
    )


def _coefficients(polar: PolarLaw, part: str) -> FloatArray:
    """(s, 3, 4) cosine or sine coefficients; orders a parameter does not have are 0."""
    rows = []
    for b, onset in zip(polar.b, polar.onset, strict=True):
        found = [getattr(item, part) for item in (polar.a, b, onset)]
        longest = max(len(row) for row in found)
        rows.append([np.pad(row, (0, longest - len(row))) for row in found])
    return np.array(rows)


def read_model(dataset: xr.Dataset) -> dict[str, Any]:
    """Fields of the model that a dataset of kind fit holds.

    Raises
    ------
    SchemaError : not a fit.
    """
    declared = FIT
    needed = [v.name for v in (*declared.coordinates, *declared.variables) if not v.optional]
    require_variables(dataset, needed, "A macro model", "fit")
    for name, wanted in _FIXED.items():
        if dataset[name].values.tolist() != list(wanted):
            raise SchemaError(f"The {name} of a macro model is {', '.join(wanted)}, in this order.")
    sides = SOME_SIDES(dataset["side"].values, "side")
    check_dataset(dataset, "fit")
    values = {name: dataset[name].values for name in dataset.variables}
    directional = values["directional_value"]
    a = directional[:, 0]
    laws = DirectionalLaws(
        values["direction"],
        np.where(np.isnan(a[0]), a[-1], a[0]),
        directional[:, 1],
        directional[:, 2],
        values["samples_before"],
        values["samples_beyond"],
        float(values["softening"]),
    )
    return {
        "polar": _polar_of(dataset, sides),
        "laws": laws,
        "errors": FitErrors(**{name: values[name] for name in _ERRORS}),
        "weighting": values["weighting"].item(),
        "variant": values["variant"].item(),
        "tangent": _or_none(values["tangent"]),
        "in_plane": _or_none(values["in_plane"]),
        "w_biaxial": float(values["w_biaxial"]),
        "n_ignored": int(values["n_ignored"]),
        "labels": read_labels(dataset),
        "config": read_config(dataset),
    }


def _polar_of(dataset: xr.Dataset, sides: tuple[str, ...]) -> PolarLaw:
    orders = {
        name: int(order) for name, order in zip(PARAMETERS, dataset["order"].values, strict=True)
    }
    found: dict[str, list[Harmonics]] = {name: [] for name in PARAMETERS}
    for side in sides:
        for name in PARAMETERS:
            one = dataset.sel(side=side, parameter=name)
            cut = slice(0, orders[name] + 1)
            found[name].append(
                Harmonics(one["cos_coefficient"].values[cut], one["sin_coefficient"].values[cut])
            )
    return PolarLaw(
        sides,
        found["a"][0],
        tuple(found["b"]),
        tuple(found["kappa_0"]),
        tuple(str(item) for item in dataset["onset_quantity"].values),
        float(dataset["largest_curvature"]),
        float(dataset["softening"]),
    )


def _or_nan(matrix: FloatArray | None) -> FloatArray:
    return np.full((3, 3), np.nan) if matrix is None else matrix


def _or_none(matrix: FloatArray) -> FloatArray | None:
    return None if np.isnan(matrix).all() else matrix

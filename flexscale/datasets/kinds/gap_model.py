"""Kind `gap_model`: the macro model of the flat cell, its stiffness and its gaps that close."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from flexscale.datasets.build import build_dataset
from flexscale.datasets.mesh_variables import array
from flexscale.datasets.sample_checks import ROUNDING, check_axis, check_sides
from flexscale.datasets.stiffness import BENDING, IN_PLANE, VOIGT, check_stiffness, matrix
from flexscale.datasets.variables import COMPONENTS, DIRECTION, SIDE, SIDE_SIGN, Schema, Variable
from flexscale.errors import SchemaError
from flexscale.sides import side_sign

#: mm-1: a gap that closes at none below this one closes by rounding alone.
NEVER = 1e6


def _check_gap_model(dataset: xr.Dataset) -> None:
    """Matrices are stiffnesses, gaps are open at rest, softenings and onsets not negative."""
    check_sides(dataset, "gap model")
    check_axis(dataset["direction"].values, "direction", "degree")
    for name in ("tangent", "in_plane"):
        check_stiffness(dataset[name].values, name)
    gaps, compliance = dataset["distances"].values, dataset["compliance"].values
    if not (gaps >= 0.0).all() or not np.isfinite(dataset["slopes"].values).all():
        raise SchemaError("The gaps of a gap model must be finite, and not negative at rest.")
    if compliance.shape != 2 * gaps.shape:
        raise SchemaError("The compliance of the gaps of a gap model needs a row for each gap.")
    if not np.allclose(compliance, compliance.T, rtol=0.0, atol=1e-6 * np.abs(compliance).max()):
        raise SchemaError("The compliance of the gaps of a gap model must be symmetric.")
    numbers = ("softening", "contact_softening", "w_biaxial", "largest_curvature")
    for name in numbers:
        if not 0.0 <= float(dataset[name]) < np.inf:
            raise SchemaError(f"{name} of a gap model is {float(dataset[name]):g}, below 0.")
    # The first gap to close does not depend on what holds it open.
    onset = dataset["onset"].values
    if not (np.isnan(onset) | (onset >= 0.0)).all():
        raise SchemaError("The onsets of a gap model must not be negative.")
    expected = _onsets(dataset)
    if not np.allclose(onset, expected, rtol=ROUNDING**0.5, atol=0.0, equal_nan=True):
        raise SchemaError("The onsets of a gap model do not follow from its gaps.")


def _onsets(dataset: xr.Dataset) -> np.ndarray:
    """(n_sides, n_directions) mm-1 at which the first gap closes, nan for never."""
    angle = np.deg2rad(dataset["direction"].values)
    sign = dataset["side_sign"].values[:, None, None].astype(float)
    bends = np.stack([np.cos(angle) ** 2, np.sin(angle) ** 2, np.sin(2.0 * angle)], axis=-1)
    closing = -sign * bends @ dataset["slopes"].values.T
    with np.errstate(divide="ignore", invalid="ignore"):
        reached = np.where(closing > 0.0, dataset["distances"].values / closing, np.inf)
    first = reached.min(axis=-1, initial=np.inf)
    return _known(first)


def _known(onset: np.ndarray) -> np.ndarray:
    """Onsets, nan for those that are never reached."""
    return np.where(onset < NEVER, onset, np.nan)


GAP_MODEL = Schema(
    "gap_model",
    1,
    "Macro model of the flat cell: its stiffness, and gaps that close",
    coordinates=(
        SIDE,
        SIDE_SIGN,
        DIRECTION,
        *VOIGT,
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
        array("softening", "", "float64", "s: energy E before contact is log(1 + s E)/s", "mm N-1"),
        array("contact_softening", "", "float64", "the same for the energy of contact", "mm N-1"),
        array("w_biaxial", "", "float64", "energy density 1/2 w det(k)^2", "N mm3"),
        array("largest_curvature", "", "float64", "largest curvature the model is tried", "mm-1"),
        Variable(
            "onset",
            ("side", "direction"),
            "float64",
            "mm-1",
            "curvature at which the first scales meet, to first order",
            attrs={"comment": "nan where no scales meet"},
        ),
    ),
    check=_check_gap_model,
)


def build_gap_model_dataset(
    sides: Sequence[str],
    directions: ArrayLike,
    arrays: Mapping[str, ArrayLike],
    *,
    scalars: Mapping[str, float | str],
    config: Mapping[str, Any],
) -> xr.Dataset:
    """Dataset of kind gap_model; onsets that are never reached become nan.

    Parameters
    ----------
    sides : of "closing", "opening".
    directions : (n,) degree, increasing, of the onsets.
    arrays : variables by the names of the schema.
    scalars, config : as in `build_dataset`.
    """
    onset = np.asarray(arrays["onset"], dtype=float)
    values = {
        **arrays,
        "onset": _known(onset),
        "side": list(sides),
        "side_sign": [side_sign(side) for side in sides],
        "direction": np.asarray(directions, dtype=float),
        "component": list(COMPONENTS),
        "other_component": list(COMPONENTS),
    }
    return build_dataset(GAP_MODEL, values, scalars=scalars, config=config)

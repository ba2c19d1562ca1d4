"""Kind `joint`: the law of the joint between two scales, and the solid states it was fitted to."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from flexscale.datasets.build import build_dataset
from flexscale.datasets.mesh_variables import array
from flexscale.datasets.variables import Schema, Variable
from flexscale.errors import SchemaError

POSE = ("u", "w", "s", "phi")
_STATES = "in thicknesses of the sheet, moduli of the sheet, and radian"


def _check_joint(dataset: xr.Dataset) -> None:
    """A law that is finite, of a stiffness that is its own quadratic part, within bounds."""
    for name, variable in dataset.data_vars.items():
        if variable.dtype.kind == "f" and not np.isfinite(variable.values).all():
            raise SchemaError(f"{name} of a joint holds values that are not finite.")
    if tuple(dataset["pose"].values) != POSE or tuple(dataset["other_pose"].values) != POSE:
        raise SchemaError(f"A joint's poses must be {', '.join(POSE)}.")
    exponents = dataset["exponents"].transpose("term", "pose").values
    if exponents.min(initial=0) < 0:
        raise SchemaError("The exponents of a joint's law must not be negative.")
    if not (dataset["lowest"] < dataset["highest"]).all():
        raise SchemaError("The range of a joint's poses must not be empty.")
    for name in ("energy_error", "force_error"):
        if not (dataset[name] >= 0.0).all():
            raise SchemaError(f"The {name} of a joint must not be negative.")
    stiffness = dataset["stiffness"].transpose("pose", "other_pose").values
    size = np.abs(stiffness).max()
    if np.abs(stiffness - stiffness.T).max() > 1e-9 * size:
        raise SchemaError("The stiffness of a joint must be symmetric.")
    if np.linalg.eigvalsh(stiffness).min() <= 0.0:
        raise SchemaError("The stiffness of a joint must be positive definite.")
    expected = quadratic_part(exponents, dataset["coefficients"].values)
    if np.abs(stiffness - expected).max() > 1e-9 * size:
        raise SchemaError("The stiffness of a joint is not the quadratic part of its law.")


def quadratic_part(exponents: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
    """(4, 4) second derivatives at rest of a polynomial."""
    found = np.zeros((4, 4))
    for powers, value in zip(exponents, coefficients, strict=True):
        if powers.sum() == 2:
            i, j = np.repeat(np.arange(4), powers)
            found[i, j] = found[j, i] = value * (2.0 if i == j else 1.0)
    return found


JOINT = Schema(
    "joint",
    1,
    "Joint between two scales: energy per length of their relative pose",
    coordinates=(
        Variable("pose", ("pose",), "text", "", "opening u, shift w, slide s, turn phi (closing)"),
        Variable("other_pose", ("other_pose",), "text", "", "the same"),
    ),
    variables=(
        array("exponents", "term pose", "int32", "powers of u/t, w/t, s/t and phi of each term"),
        array("coefficients", "term", "float64", "of the terms, in E t^2"),
        array("stiffness", "pose other_pose", "float64", "second derivatives at rest, in E t^2"),
        array("energy_error", "", "float64", "rms error over states held out, of the rms energy"),
        array("force_error", "pose", "float64", "rms errors over states held out, of rms forces"),
        array("mesh_error", "pose", "float64", "excess of the stiffness of the mesh of the states"),
        array("lowest", "pose", "float64", f"least that was sampled, {_STATES}"),
        array("highest", "pose", "float64", f"most that was sampled, {_STATES}"),
        array("touching_slope", "", "float64", "opening by turn where tops touch, in thicknesses"),
        array("below_touching", "", "float64", "how far u/t may lie below touching_slope phi"),
        array("above_touching", "", "float64", "how far u/t may lie above touching_slope phi"),
        array("before_touching", "", "float64", "u/t that is in range at any turn"),
        array("state_poses", "state pose", "float64", f"poses that were solved, {_STATES}"),
        array("state_energies", "state", "float64", "energies per length of them, in E t^2"),
        array("state_forces", "state pose", "float64", "derivatives of them by the pose, in E t^2"),
        array("held_out", "state", "int8", "1 for states left out of the fit"),
        array("n_missing", "", "int32", "states that were not reached"),
        array("gap_ratio", "", "float64", "gap, in thicknesses of the sheet"),
        array("height_ratio", "", "float64", "height of the scales, in thicknesses, rounded"),
        array("modulus_ratio", "", "float64", "Young's modulus of elastic scales, over the sheet's",
              optional=True),
        array("groove_depth_ratio", "", "float64", "depth of grooves, in thicknesses; 0 for none"),
    ),
    check=_check_joint,
)  # fmt: skip


def build_joint_dataset(
    arrays: Mapping[str, ArrayLike],
    *,
    scalars: Mapping[str, float | str],
    config: Mapping[str, Any],
) -> xr.Dataset:
    """Dataset of kind joint.

    Parameters
    ----------
    arrays : variables by the names of the schema.
    scalars, config : as in `build_dataset`.
    """
    values = {**arrays, "pose": list(POSE), "other_pose": list(POSE)}
    return build_dataset(JOINT, values, scalars=scalars, config=config)

"""What kinds of whole sheets between end strips share: variables, checks, and what is derived."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from flexscale.datasets.build import build_dataset
from flexscale.datasets.sample_checks import check_axis, check_numbers, check_sides, check_status
from flexscale.datasets.variables import SIDE, SIDE_SIGN, STATUS_ATTRS, Schema, Variable
from flexscale.errors import SchemaError
from flexscale.sides import side_sign

Measured = tuple[Variable, ...]

BENT = ("side", "curvature")
TURNED = ("side", "direction")
COUNTS = (
    ("newton_iterations", "Newton iterations"),
    ("negative_eigenvalues", "negative eigenvalues of the Hessian"),
)


def number(name: str, dims: tuple[str, ...], units: str, long_name: str) -> Variable:
    return Variable(name, dims, "float64", units, long_name)


def count(name: str, dims: tuple[str, ...], long_name: str) -> Variable:
    return Variable(name, dims, "int32", "1", long_name)


def strips(curvature: tuple[str, ...], direction: tuple[str, ...]) -> Measured:
    """Sheet and strips; curvature and direction are axes, or the same for all sheets."""
    return (
        SIDE,
        number("curvature", curvature, "mm-1", "curvature of the end strips"),
        SIDE_SIGN,
        number("signed_curvature", ("side", *curvature), "mm-1", "curvature, closing > 0"),
        number("length", (), "mm", "length of the sheet, along which it is bent"),
        number("width", (), "mm", "width of the sheet"),
        number(
            "direction", direction, "degree", "direction of the length in the pattern's coordinates"
        ),
    )


def response(dims: tuple[str, ...]) -> Measured:
    return (
        number("energy", dims, "N mm", "elastic energy of the sheet"),
        number("energy_density", dims, "N mm-1", "energy per rest area"),
        number("moment", dims, "N", "mean bending moment per width, to its side"),
        number("slide", dims, "mm", "slide of the free strip along the arc, away from the other"),
        *(count(name, dims, long_name) for name, long_name in COUNTS),
        Variable("status", dims, "int8", "1", "end of the solve", attrs=STATUS_ATTRS),
    )


def steepest(dims: tuple[str, ...]) -> Variable:
    return number("largest_curvature", dims, "mm-1", "largest principal curvature in the sheet")


SIZES = (
    Variable("n_scales", (), "int32", "1", "scales, cut ones included"),
    Variable("n_unknowns", (), "int32", "1", "unknowns of the model"),
)


def check_sheet_samples(dataset: xr.Dataset) -> None:
    """Sides, curvatures, sizes, and numbers exactly where the sheet converged."""
    check_sides(dataset, "sheet")
    curvature = dataset["curvature"].values
    check_axis(curvature, "curvature", "mm-1")
    if curvature[0] < 0.0:
        raise SchemaError("Curvatures of a sheet must not be negative: the side carries the sign.")
    check_bent(dataset, "sheet")


def check_turned(dataset: xr.Dataset) -> None:
    """Sides, directions, one curvature, sizes, and numbers exactly where sheets converged."""
    check_sides(dataset, "turned sheet")
    directions = dataset["direction"].values
    check_axis(directions, "direction", "degree")
    if directions[0] < 0.0 or directions[-1] >= 180.0:
        raise SchemaError("Directions of turned sheets must lie in [0, 180) degree.")
    if not float(dataset["curvature"]) > 0.0:
        raise SchemaError("The curvature of turned sheets must be positive: the side has the sign.")
    check_bent(dataset, "turned sheet")


def check_bent(dataset: xr.Dataset, what: str) -> None:
    """Signed curvatures, sizes, statuses, and numbers exactly where the sheet converged."""
    signs = [side_sign(str(side)) for side in dataset["side"].values]
    signed = np.multiply.outer(signs, dataset["curvature"].values)
    if not np.array_equal(dataset["signed_curvature"].values, signed):
        raise SchemaError(
            f"The signed curvatures of a {what} do not follow from side and curvature."
        )
    check_sizes(dataset, ("length", "width"))
    status = dataset["status"]
    check_status(status, what)
    for variable in dataset.data_vars.values():
        if variable.dims == status.dims and variable.dtype.kind == "f":
            check_numbers(variable, status)


def check_sizes(dataset: xr.Dataset, names: tuple[str, ...]) -> None:
    """SchemaError unless sizes are positive."""
    for name in names:
        value = float(dataset[name])
        if not (np.isfinite(value) and value > 0.0):
            raise SchemaError(f"{name} is {value:g} mm, but must be positive.")


def sided(sides: Sequence[str], curvature: ArrayLike) -> dict[str, Any]:
    """Sides and curvatures (mm-1, one or several), and what follows from them."""
    kappa = np.asarray(curvature, dtype=float)
    signs = np.array([side_sign(side) for side in sides], dtype=np.int8)
    return {
        "side": list(sides),
        "curvature": kappa,
        "side_sign": signs,
        "signed_curvature": np.multiply.outer(signs, kappa),
    }


def build_sheet_dataset(
    schema: Schema,
    sides: Sequence[str],
    curvatures: ArrayLike,
    arrays: Mapping[str, ArrayLike],
    *,
    length: float,
    width: float,
    direction: float,
    scalars: Mapping[str, float | str],
    config: Mapping[str, Any],
) -> xr.Dataset:
    """Dataset of kind sheet, or native_sheet.

    Parameters
    ----------
    schema : of kind sheet, or native_sheet.
    sides : of "closing", "opening".
    curvatures : (n,) mm-1, non-negative, increasing.
    arrays : (n_sides, n) variables by the names of the schema, and numbers; real values become nan
        wherever `status` is not 0.
    length, width : mm.
    direction : degree, of the length in the pattern's coordinates.
    scalars, config : as in `build_sweep_dataset`.
    """
    values = {
        **arrays,
        **sided(sides, curvatures),
        "length": length,
        "width": width,
        "direction": direction,
    }
    return build_dataset(schema, values, scalars=scalars, config=config)


def build_turned_dataset(
    schema: Schema,
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
    """Dataset of kind turned_sheet, or native_turned_sheet.

    Parameters
    ----------
    schema : of kind turned_sheet, or native_turned_sheet.
    sides : of "closing", "opening".
    directions : (n,) degree, increasing, of the lengths in the pattern's coordinates.
    arrays : (…, n_sides, n) variables by the names of the schema; real values become nan wherever
        `status` is not 0.
    curvature : mm-1, positive.
    length, width : mm.
    scalars, config : as in `build_sweep_dataset`.
    """
    values = {
        **arrays,
        **sided(sides, curvature),
        "direction": np.asarray(directions, dtype=float),
        "length": length,
        "width": width,
    }
    return build_dataset(schema, values, scalars=scalars, config=config)

"""What holds of samples over axes, whatever their kind: sides, axes, numbers where converged."""

from __future__ import annotations

import numpy as np
import xarray as xr

from flexscale.errors import SchemaError
from flexscale.sides import SIDES
from flexscale.status import SolveStatus

#: Share of the largest value that sums and zeros may be off by rounding.
ROUNDING = 1e-9


def check_sides(dataset: xr.Dataset, what: str) -> None:
    """SchemaError unless the sides are closing and opening, or one of them, once each."""
    sides = [str(side) for side in dataset["side"].values]
    if not sides or len(set(sides)) != len(sides) or not set(sides) <= set(SIDES):
        raise SchemaError(f"The sides of a {what} are {sides}, not closing and opening, once each.")


def check_axis(values: np.ndarray, name: str, unit: str) -> None:
    """SchemaError unless values are finite and strictly increasing."""
    if values.size == 0 or not np.isfinite(values).all() or not (np.diff(values) > 0).all():
        raise SchemaError(
            f"The {name} axis [{unit}] must hold finite, strictly increasing values, "
            f"not {values.tolist()[:12]}."
        )


def check_status(status: xr.DataArray, what: str) -> None:
    """SchemaError unless every status is a known one."""
    if not np.isin(status.values, [int(item) for item in SolveStatus]).all():
        raise SchemaError(f"A status of the {what} is none of the known ones.")


def check_numbers(values: xr.DataArray, status: xr.DataArray, *, partial: bool = False) -> None:
    """SchemaError unless numbers stand exactly where the solve converged.

    Parameters
    ----------
    values : the dimensions of `status`, with others behind.
    partial : numbers may be missing where the solve converged.

    All missing is fine when a comment says why.
    """
    finite, converged = np.isfinite(values.values), status.values == SolveStatus.converged
    if finite.ndim > converged.ndim:
        converged = np.broadcast_to(converged[..., None], finite.shape)
    if "comment" in values.attrs and not finite.any():
        return
    wrong = np.argwhere(finite & ~converged if partial else finite != converged)
    if wrong.size:
        place = tuple(int(index) for index in wrong[0])
        end = SolveStatus(int(status.values[place[: status.ndim]]))
        where = ", ".join(
            _coordinate(values, str(dim), index)
            for dim, index in zip(status.dims, place, strict=False)
        )
        raise SchemaError(
            f"{values.name} is {values.values[place]} at {where}, where the status is {end.name}: "
            "numbers belong to converged samples only."
        )


def _coordinate(values: xr.DataArray, dim: str, index: int) -> str:
    value, units = values[dim].values[index], str(values[dim].attrs.get("units", ""))
    shown = f"{value:g}" if isinstance(value, float) else str(value)
    return f"{dim} {shown} {units}".rstrip()

"""`dataset.fs`: look up samples by physical values."""

from __future__ import annotations

import numpy as np
import xarray as xr

from flexscale.checks import ANGLE, checked, number, text
from flexscale.errors import MissingDataError, UnknownNameError, suggest
from flexscale.sides import ONE_SIDE

#: Share of a step of the grid by which an asked value may miss its sample.
ROUNDED = 1e-3


@xr.register_dataset_accessor("fs")
class FlexScaleAccessor:
    """FlexScale's additions to xarray datasets."""

    def __init__(self, dataset: xr.Dataset) -> None:
        self._dataset = dataset

    @checked(
        name=text,
        side=ONE_SIDE,
        direction=ANGLE,
        curvature=number("mm-1"),
    )
    def sample(
        self,
        name: str,
        *,
        side: str | None = None,
        direction: float | None = None,
        curvature: float | None = None,
    ) -> xr.DataArray:
        """Values of a variable at stored samples; what lies between samples is refused.

        Digits may be rounded: a sample is meant within a thousandth of the step beside it.

        Parameters
        ----------
        name : variable, for instance "moment".
        side : "closing" or "opening"; all when left out.
        direction : degree, any real number (directions repeat after 180); all when left out.
        curvature : mm-1, non-negative; all when left out.

        Returns
        -------
        Values over the remaining dimensions; the coordinates and the attribute `sampled` say
        what was picked.

        Raises
        ------
        UnknownNameError : unknown variable or side.
        MissingDataError : no sample is stored there; the message names its neighbors.
        """
        known = list(self._dataset.data_vars)
        if name not in known:
            raise UnknownNameError(f"There is no variable {name!r}. {suggest(name, known)}")
        values = self._dataset[name]
        picked = []
        if side is not None:
            sides = [str(item) for item in values["side"].values]
            if side not in sides:
                raise UnknownNameError(f"There is no side {side!r} here. {suggest(side, sides)}")
            values = values.isel(side=sides.index(side))
            picked.append(f"side {side}")
        for axis, wanted, unit, period in (
            ("direction", direction, "degree", 180.0),
            ("curvature", curvature, "mm-1", None),
        ):
            if wanted is None:
                continue
            grid = values[axis].values.astype(float)
            index = _place(grid, float(wanted), axis, unit, period)
            values = values.isel({axis: index})
            picked.append(f"{axis} {grid[index]:.6g} {unit} (asked {float(wanted):.6g})")
        values = values.copy()
        values.attrs["sampled"] = ", ".join(picked) or "everything"
        return values


def _place(grid: np.ndarray, wanted: float, axis: str, unit: str, period: float | None) -> int:
    """Index of the grid value that is meant by `wanted`; error when there is none."""
    distance = np.abs(grid - wanted)
    if period is not None:
        distance = np.abs((grid - wanted + period / 2) % period - period / 2)
    index = int(np.argmin(distance)) if grid.size else 0
    steps = np.diff(np.sort(grid))
    step = float(steps.min()) if steps.size else max(1.0, abs(wanted))
    if not grid.size or not distance[index] <= ROUNDED * step:
        near = np.sort(grid[np.argsort(distance)[:2]])
        listed = " and ".join(f"{value:.6g}" for value in near)
        raise MissingDataError(
            f"There is no sample at {axis} {wanted:.6g} {unit}; of the {grid.size} stored the "
            f"nearest are {listed} {unit}. Between samples: dataset[name].interp({axis}=…)."
        )
    return index

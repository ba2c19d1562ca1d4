"""Curves of a model over an axis, one a side, with crosses where nothing converged."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from flexscale.plotting.style import FAILED_COLOR, MACRO_COLOR, SIDE_LINESTYLES, axis_label

FAILED_NOTE = "× at the upper rim: not converged, left out of the curve"
SIDE_MARKERS = {"closing": "o", "opening": "s"}


def draw_side_curves(
    axes: Axes,
    values: xr.DataArray,
    status: xr.DataArray,
    axis: str,
    sides: Sequence[str],
    color: str = MACRO_COLOR,
) -> list[str]:
    """Draw values (side, axis) from 0 on, each side in its own line style.

    Returns
    -------
    Notes for `add_note`.
    """
    places = values[axis].values.astype(float)
    notes = []
    for side in sides:
        line = values.sel(side=side).values.astype(float)
        failed = status.sel(side=side).values != 0
        axes.plot(
            places,
            np.where(failed, np.nan, line),
            color=color,
            linestyle=SIDE_LINESTYLES[side],
            marker=SIDE_MARKERS[side],
            markerfacecolor="white" if side == "opening" else color,
            markersize=3.0,
            label=side,
        )
        if failed.any():
            height = 0.985 if side == "closing" else 0.955
            axes.plot(
                places[failed],
                np.full(int(failed.sum()), height),
                transform=axes.get_xaxis_transform(),
                linestyle="none",
                marker="x",
                markersize=4.0,
                color=FAILED_COLOR,
                clip_on=False,
                label="_unconverged",
            )
            notes = [FAILED_NOTE]
    axes.set_xlim(0.0, 1.03 * float(places.max()) if places.max() > 0.0 else 1.0)
    if not np.nanmin(values.values, initial=0.0) < 0.0:
        axes.set_ylim(bottom=0.0)
    axes.xaxis.set_major_locator(MaxNLocator(5))
    axes.set_xlabel(axis_label(values[axis]))
    axes.set_ylabel(axis_label(values))
    return notes

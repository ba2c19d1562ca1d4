"""Response curves over curvature: one line per direction and side."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from flexscale.checks import DATASET, checked, text
from flexscale.errors import SchemaError, shown
from flexscale.plotting.fits import fitted_curve, require_fitted
from flexscale.plotting.selection import (
    pick_sides,
    pick_values,
    require_variables,
    subject,
    unconverged,
)
from flexscale.plotting.style import (
    COLUMN_WIDTH,
    MARKERS,
    SIDE_LINESTYLES,
    add_note,
    axis_label,
    direction_color,
    flexscale_style,
    new_figure,
)

FAILED_NOTE = "× at the upper rim: sample not converged, left out of the curve"
# With more samples than this a marker at every sample hides the line; then about this many.
_MAX_MARKERS = 13


@checked(sweep=DATASET, variable=text, fit=DATASET)
def curves(
    sweep: xr.Dataset,
    directions: float | Sequence[float] | None = None,
    sides: str | Sequence[str] | None = None,
    *,
    variable: str = "moment",
    fit: xr.Dataset | None = None,
) -> Figure:
    """Bending moment, or another response, against curvature.

    Parameters
    ----------
    sweep : dataset of kind sweep/1.
    directions : degree; None takes up to six computed ones, evenly spread (directions filled in
        by symmetry would only cover other lines).
    sides : "closing", "opening" or both; None takes all the sweep has. Closing lines are solid,
        opening lines dashed.
    variable : any sample variable of the sweep, for instance "energy_density" or "min_gap".
    fit : dataset of kind fit; its curves are drawn on top, and samples become mere markers,
        filled for closing and open for opening. For "moment" and "energy_density" only.

    Returns
    -------
    Figure with one axes; its labels come from the dataset's `long_name` and `units`.

    Raises
    ------
    UnknownNameError, BadInputError : a side or direction the sweep does not have, or a variable
        the fit does not predict.
    SchemaError : not a sweep, or it has no such variable.
    """
    if fit is not None:
        require_fitted(variable)
    needed = [variable, "direction", "curvature", "side"]
    require_variables(sweep, needed, f"A plot of {variable} over curvature")
    if set(sweep[variable].dims) != {"side", "direction", "curvature"}:
        raise SchemaError(
            f"{variable} lies over {shown(sweep[variable].dims)}, and not over side, direction and "
            "curvature: draw another variable of the sweep."
        )
    shown_sides = pick_sides(sweep, sides)
    if directions is None:
        directions = _computed_directions(sweep)
    chosen = pick_values(sweep["direction"], directions, n_default=6)
    with flexscale_style():
        figure = new_figure(COLUMN_WIDTH * 1.3, COLUMN_WIDTH * 0.85)
        axes = figure.add_subplot()
        n_failed = draw_curves(axes, sweep, variable, shown_sides, chosen, fit)
        axes.set_title(subject(sweep))
        handles = _legend(sweep, shown_sides, chosen, fit is not None)
        figure.legend(handles=handles, loc="outside right center")
        add_note(figure, [FAILED_NOTE] if n_failed else [])
    return figure


def draw_curves(
    axes: Axes,
    sweep: xr.Dataset,
    variable: str,
    sides: Sequence[str],
    direction_indices: Sequence[int] | np.ndarray,
    fit: xr.Dataset | None = None,
) -> int:
    """Draw one line per side and direction into axes, a gap and a cross where none is known.

    With a fit the lines are its own, and the samples markers.

    Returns
    -------
    Number of samples drawn as failed.
    """
    curvature = np.asarray(sweep["curvature"].values, dtype=float)
    dims = ("side", "direction", "curvature")
    values = sweep[variable].transpose(*dims)
    failed = unconverged(sweep).transpose(*dims)
    every = -(-len(curvature) // _MAX_MARKERS)
    n_failed = 0
    for side in sides:
        for rank, index in enumerate(direction_indices):
            line = values.sel(side=side).isel(direction=index).values.astype(float)
            missing = failed.sel(side=side).isel(direction=index).values
            direction = float(sweep["direction"].values[index])
            color = direction_color(direction)
            axes.plot(
                curvature,
                np.where(missing, np.nan, line),
                linestyle=SIDE_LINESTYLES[side] if fit is None else "none",
                color=color,
                marker=MARKERS[rank % len(MARKERS)],
                markerfacecolor="white" if fit is not None and side == "opening" else color,
                markevery=every if fit is None else 1,
                markersize=2.8,
                label=f"{side} {direction:g}",
            )
            if fit is not None:
                smooth = fitted_curve(fit, side, direction, variable, float(curvature.max()))
                axes.plot(
                    *smooth,
                    linestyle=SIDE_LINESTYLES[side],
                    color=color,
                    linewidth=1.0,
                    label=f"fit {side} {direction:g}",
                )
            n_failed += int(missing.sum())
            _draw_crosses(axes, curvature[missing], color, rank)
    axes.set_xlim(0.0, float(curvature.max()) * 1.03 if curvature.max() > 0.0 else 1.0)
    shown = values.isel(direction=direction_indices).values
    if not np.any(shown < -1e-9 * np.nanmax(np.abs(shown), initial=0.0)):
        axes.set_ylim(bottom=0.0)
    axes.xaxis.set_major_locator(MaxNLocator(5))  # labels of small curvatures are long
    axes.set_xlabel(axis_label(sweep["curvature"]))
    axes.set_ylabel(axis_label(sweep[variable]))
    return n_failed


def _computed_directions(sweep: xr.Dataset) -> list[float] | None:
    """Up to six directions that are no symmetric copy; None when the sweep does not say."""
    if "symmetry_source" not in sweep:
        return None
    direction = np.asarray(sweep["direction"].values, dtype=float)
    source = sweep["symmetry_source"].transpose("side", "direction").values
    own = direction[np.any(np.isclose(source, direction, atol=1e-6), axis=0)]
    return [float(value) for value in own[:: max(1, -(-len(own) // 6))]] or None


def _draw_crosses(axes: Axes, curvature: np.ndarray, color: object, rank: int) -> None:
    """Crosses at the upper rim, one row per direction so that none hides another."""
    if len(curvature):
        axes.plot(
            curvature,
            np.full(len(curvature), 0.985 - 0.03 * rank),
            transform=axes.get_xaxis_transform(),
            linestyle="none",
            marker="x",
            markersize=4.0,
            color=color,
            clip_on=False,
            label="_unconverged",
        )


def _legend(
    sweep: xr.Dataset,
    sides: Sequence[str],
    direction_indices: Sequence[int] | np.ndarray,
    with_fit: bool,
) -> list[Line2D]:
    """One entry per direction (color, marker) and one per side (line style)."""
    entries = [
        Line2D(
            [],
            [],
            color=direction_color(float(direction)),
            marker=MARKERS[rank % len(MARKERS)],
            markersize=3.5,
            label=f"{direction:g}°",
        )
        for rank, direction in enumerate(sweep["direction"].values[direction_indices])
    ]
    for side in sides:
        label = f"{side}, fit" if with_fit else side
        entries.append(Line2D([], [], color="0.3", linestyle=SIDE_LINESTYLES[side], label=label))
    for side in sides if with_fit else ():
        face = "white" if side == "opening" else "0.3"
        look: dict[str, Any] = {"color": "0.3", "linestyle": "none", "marker": "o"}
        look |= {"markersize": 3.5, "markerfacecolor": face}
        entries.append(Line2D([], [], label=f"{side}, native", **look))
    return entries

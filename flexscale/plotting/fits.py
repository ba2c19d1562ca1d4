"""Fits of the two-regime law: parameters by direction, and curves over samples (Fig. 4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.projections.polar import PolarAxes
from matplotlib.ticker import MaxNLocator

from flexscale.arrays import FloatArray
from flexscale.checks import ANGLE, DATASET, checked
from flexscale.datasets.fit_values import (
    PARAMETERS,
    fit_parameters,
    two_regime_energy,
    two_regime_moment,
)
from flexscale.errors import BadInputError
from flexscale.plotting.polar_axes import PolarCurve, common_radius, draw_polar_curves, polar_axes
from flexscale.plotting.selection import (
    pick_sides,
    pick_values,
    require_variables,
    subject,
    unconverged,
)
from flexscale.plotting.style import (
    MACRO_COLOR,
    NATIVE_COLOR,
    PAGE_WIDTH,
    SIDE_LINESTYLES,
    add_note,
    axis_label,
    flexscale_style,
    new_figure,
    unit_text,
)

#: What the fit predicts, by the name of the sweep's variable.
RESPONSES = {"moment": two_regime_moment, "energy_density": two_regime_energy}
SYMBOLS = {"a": "a", "b": "b", "kappa_0": "κ₀"}
ONE_SAMPLE_NOTE = "b is left out where a single sample lies beyond the onset"
HARMONICS_STYLE: Any = (0, (1.2, 1.2))
_SIDE_MARKERS = {"closing": "o", "opening": "s"}
_NEEDED = (
    "cos_coefficient",
    "sin_coefficient",
    "directional_value",
    "samples_beyond",
    "softening",
)


@checked(model=DATASET, sweep=DATASET, direction=ANGLE)
def fit(
    model: xr.Dataset, sweep: xr.Dataset | None = None, *, direction: float | None = None
) -> Figure:
    """Parameters a, b and κ0 by direction, and the response in one direction (paper's Fig. 4).

    Parameters
    ----------
    model : dataset of kind fit, as from `MacroModel.to_dataset`.
    sweep : the sweep it was fitted to; with it, energy and moment over curvature are drawn below.
    direction : degree, of these curves; the one that makes contact first if not given.

    Returns
    -------
    Figure. Blue dots are native: parameters fitted in one direction, samples of the sweep. Orange
    is the fit; closing solid with round dots, opening dashed with square ones.

    Raises
    ------
    SchemaError : not a fit, or not a sweep.
    BadInputError : a direction the sweep does not have.
    """
    require_variables(model, _NEEDED, "A figure of a fit", "fit")
    sides = pick_sides(model, None)
    with flexscale_style():
        height = PAGE_WIDTH * (0.36 if sweep is None else 0.74)
        figure = new_figure(PAGE_WIDTH, height)
        grid = figure.add_gridspec(1 if sweep is None else 2, 6)
        figure.suptitle(
            f"{subject(model)}: fit, {model['weighting'].item()} weighting".lstrip(": ")
        )
        notes = []
        for column, name in enumerate(PARAMETERS):
            panel = grid[0, 2 * column : 2 * column + 2]
            notes += _draw_parameter(polar_axes(figure, panel), model, name, sides)
        if sweep is not None:
            panels = [figure.add_subplot(grid[1, :3]), figure.add_subplot(grid[1, 3:])]
            _draw_responses(panels, model, sweep, direction)
        figure.legend(handles=_legend(sides, sweep is not None), loc="outside right center")
        add_note(figure, list(dict.fromkeys(notes)))
    return figure


def fitted_curve(
    model: xr.Dataset, side: str, direction: float, variable: str, largest: float
) -> tuple[FloatArray, FloatArray]:
    """Curvatures from 0 to `largest` (mm-1), κ0 among them, and the fit's response there.

    `variable` : of RESPONSES; the parameters are those of the harmonics.
    """
    law = {name: float(v) for name, v in fit_parameters(model, side, direction).items()}
    return _law_curve(law, float(model["softening"]), variable, largest)


def require_fitted(variable: str) -> None:
    """Refuse a variable that a fit does not predict."""
    if variable not in RESPONSES:
        raise BadInputError(
            f"A fit predicts {' and '.join(RESPONSES)}, not {variable}: leave out the fit, or "
            "draw one of these."
        )


def _law_curve(
    law: dict[str, float], softening: float, variable: str, largest: float
) -> tuple[FloatArray, FloatArray]:
    kappa = np.linspace(0.0, largest, 201)
    onset = law["kappa_0"]
    if not np.isnan(onset) and onset < largest:
        kappa = np.sort(np.append(kappa, onset))
    return kappa, RESPONSES[variable](kappa, law["a"], law["b"], onset, softening)


def _draw_parameter(
    axes: PolarAxes, model: xr.Dataset, name: str, sides: Sequence[str]
) -> list[str]:
    """One polar panel: dots of the sampled directions, and the harmonics; returns notes."""
    dense = np.arange(0.0, 180.0, 0.5)
    sampled = np.asarray(model["direction"].values, dtype=float)
    curves, left_out = [], False
    for side in sides if name != "a" else sides[:1]:
        values = model["directional_value"].sel(side=side, parameter=name).values
        if name == "b":
            unsure = model["samples_beyond"].sel(side=side).values == 1
            values = np.where(unsure, np.nan, values)
            left_out = left_out or bool(unsure.any())
        smooth = fit_parameters(model, side, dense)[name]
        # Dots first, or many of them would hide the fit.
        dots = _curve(sampled, values, NATIVE_COLOR, "none", dotted=True)
        curves.append(replace(dots, marker=_SIDE_MARKERS[side]))
        curves.append(_curve(dense, smooth, MACRO_COLOR, SIDE_LINESTYLES[side], dotted=False))
    units = unit_text(str(model["parameter_units"].sel(parameter=name).values))
    notes = draw_polar_curves(axes, curves, common_radius(curves))
    title = f"{SYMBOLS[name]}(θ) [{units}]"
    known = [curve for curve in curves if np.isfinite(curve.values).any()]
    if not known:
        title += "\nno contact"
    elif name == "kappa_0":
        inverse = [s for s in sides if model["onset_quantity"].sel(side=s).item() == "1/kappa_0"]
        if inverse:
            notes.append(f"1/κ₀ interpolated ({', '.join(inverse)}): no contact in some directions")
    axes.set_title(title)
    notes += [ONE_SAMPLE_NOTE] * left_out
    return [note for note in notes if not note.startswith("dots:")]


def _curve(
    directions: FloatArray, values: FloatArray, color: str, linestyle: Any, *, dotted: bool
) -> PolarCurve:
    return PolarCurve(
        directions,
        np.asarray(values, dtype=float),
        failed=np.zeros(len(directions), dtype=bool),
        dotted=np.full(len(directions), dotted),
        color=color,
        linestyle=linestyle,
    )


def _draw_responses(
    panels: Sequence[Axes], model: xr.Dataset, sweep: xr.Dataset, direction: float | None
) -> None:
    """Energy and moment over curvature in one direction, all sides."""
    require_variables(sweep, [*RESPONSES, "direction", "curvature", "side"], "A figure of a fit")
    chosen = _first_contact(model) if direction is None else direction
    index = int(pick_values(sweep["direction"], chosen, n_default=1)[0])
    shown = float(sweep["direction"].values[index])
    sides = [side for side in pick_sides(sweep, None) if side in model["side"].values]
    for axes, variable in zip(panels, ("energy_density", "moment"), strict=True):
        for side in sides:
            _draw_response(axes, model, sweep.sel(side=side), side, shown, variable)
        axes.set_title(f"at {shown:g}°")
        axes.xaxis.set_major_locator(MaxNLocator(5))
        axes.set_xlim(left=0.0)
        axes.set_ylim(bottom=0.0)
        axes.set_xlabel(axis_label(sweep["curvature"]))
        axes.set_ylabel(axis_label(sweep[variable]))


def _draw_response(
    axes: Axes, model: xr.Dataset, one: xr.Dataset, side: str, direction: float, variable: str
) -> None:
    kappa = np.asarray(one["curvature"].values, dtype=float)
    line = one.sel(direction=direction)
    failed = unconverged(line).values
    values = np.where(failed, np.nan, line[variable].values)
    axes.plot(kappa, values, color=NATIVE_COLOR, label=f"native {side}", **_dots(side))
    at = model["directional_value"].sel(side=side)
    near = int(np.argmin(np.abs(model["direction"].values - direction)))
    law = {name: float(at.sel(parameter=name).values[near]) for name in PARAMETERS}
    look = {"color": MACRO_COLOR, "linestyle": SIDE_LINESTYLES[side]}
    fitted = _law_curve(law, float(model["softening"]), variable, kappa[-1])
    axes.plot(*fitted, label=f"law {side}", **look)
    smooth = fitted_curve(model, side, direction, variable, kappa[-1])
    look["linestyle"] = HARMONICS_STYLE
    axes.plot(*smooth, label=f"harmonics {side}", linewidth=0.9, **look)
    if not np.isnan(law["kappa_0"]):
        axes.axvline(law["kappa_0"], color="0.6", linewidth=0.6, zorder=0)
        axes.text(
            law["kappa_0"],
            0.98 if side == "closing" else 0.9,
            f" κ₀ {side}",
            transform=axes.get_xaxis_transform(),
            va="top",
            size=6,
        )


def _dots(side: str) -> dict[str, Any]:
    return {
        "linestyle": "none",
        "marker": _SIDE_MARKERS[side],
        "markersize": 3.0,
        "markerfacecolor": NATIVE_COLOR if side == "closing" else "white",
        "zorder": 3,
    }


def _first_contact(model: xr.Dataset) -> float:
    """Direction with the least κ0 of any side; the first one without contact."""
    onsets = model["directional_value"].sel(parameter="kappa_0").transpose("side", "direction")
    values = np.nan_to_num(onsets.values, nan=np.inf).min(axis=0)
    return float(model["direction"].values[int(np.argmin(values))])


def _legend(sides: Sequence[str], with_curves: bool) -> list[Line2D]:
    entries = []
    for side in sides:
        dots = _dots(side) if with_curves else _dots("closing") | {"marker": _SIDE_MARKERS[side]}
        entries.append(Line2D([], [], color=NATIVE_COLOR, label=f"native,\n{side}", **dots))
    for side in sides:
        look = {"color": MACRO_COLOR, "linestyle": SIDE_LINESTYLES[side]}
        entries.append(Line2D([], [], label=f"fit, {side}", **look))
    if with_curves:
        look = {"color": MACRO_COLOR, "linestyle": HARMONICS_STYLE, "linewidth": 0.9}
        entries.append(Line2D([], [], label="below: with\nharmonics", **look))
    return entries

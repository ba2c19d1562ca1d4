"""Moments of the macro model and of native cells against direction (paper's Fig. 12)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.projections.polar import PolarAxes

from flexscale.arrays import FloatArray
from flexscale.checks import DATASET, checked
from flexscale.datasets.fit_values import fit_parameters, two_regime_moment
from flexscale.plotting.polar import moment_curves
from flexscale.plotting.polar_axes import PolarCurve, common_radius, draw_polar_curves, polar_axes
from flexscale.plotting.selection import pick_sides, pick_values, require_variables, subject
from flexscale.plotting.style import (
    MACRO_COLOR,
    NATIVE_COLOR,
    PAGE_WIDTH,
    add_note,
    flexscale_style,
    moment_label,
    new_figure,
    unit_text,
)

N_CURVATURES = 4
_DENSE = np.arange(0.0, 180.0, 0.5)  # degree
_NEEDED = ("cos_coefficient", "sin_coefficient", "softening")


@checked(model=DATASET, sweep=DATASET)
def macro_polar(
    model: xr.Dataset,
    sweep: xr.Dataset,
    sides: str | Sequence[str] | None = None,
    curvatures: float | Sequence[float] | None = None,
) -> Figure:
    """Native and macro moments against direction, one panel per side and curvature.

    Parameters
    ----------
    model : dataset of kind fit, as from `MacroModel.to_dataset`.
    sweep : native samples.
    sides : "closing", "opening" or both; None takes all the model has. One row each.
    curvatures : mm-1; None takes up to four of the sweep, evenly spread.

    Returns
    -------
    Figure. Native samples are blue, the model is orange. As in the paper each panel has its own
    radius; the largest moment is above it.

    Raises
    ------
    SchemaError : not a fit, or not a sweep.
    UnknownNameError, BadInputError : a side or curvature that there is not.
    """
    require_variables(model, _NEEDED, "A figure of a macro model", "fit")
    require_variables(
        sweep, ["moment", "direction", "curvature", "side"], "A polar moment plot", "sweep"
    )
    rows = pick_sides(model, sides)
    pick_sides(sweep, rows)
    chosen = pick_values(sweep["curvature"], curvatures, n_default=N_CURVATURES, skip_zero=True)
    with flexscale_style():
        height = PAGE_WIDTH * (0.08 + 0.26 * len(rows) * N_CURVATURES / max(len(chosen), 3))
        figure = new_figure(PAGE_WIDTH, height)
        figure.suptitle(f"{subject(sweep)}: {moment_label(sweep)}, native and macro".lstrip(": "))
        notes: list[str] = []
        for row, side in enumerate(rows):
            for column, index in enumerate(chosen):
                place = (len(rows), len(chosen), row * len(chosen) + column + 1)
                notes += draw_macro_panel(polar_axes(figure, place), model, sweep, side, int(index))
        figure.legend(handles=macro_legend(), loc="outside right center")
        add_note(figure, [*dict.fromkeys(notes), "each panel has its own radius, from 0"])
    return figure


def draw_macro_panel(
    axes: PolarAxes, model: xr.Dataset, sweep: xr.Dataset, side: str, curvature_index: int
) -> list[str]:
    """One panel: native dots and line, and the macro moment at all angles; returns notes."""
    axes.set_thetagrids(np.arange(0, 360, 30), labels=[""] * 12)
    curvature = float(sweep["curvature"].values[curvature_index])
    (native,) = moment_curves(sweep, side, [curvature_index])
    native = PolarCurve(
        native.directions, native.values, native.failed, native.dotted, NATIVE_COLOR
    )
    macro = PolarCurve(
        _DENSE,
        macro_moment(model, side, _DENSE, curvature),
        failed=np.zeros(len(_DENSE), dtype=bool),
        dotted=np.zeros(len(_DENSE), dtype=bool),
        color=MACRO_COLOR,
    )
    notes = draw_polar_curves(axes, [native, macro], common_radius([native, macro]))
    largest = np.nanmax(native.values, initial=-np.inf)
    units = unit_text(str(sweep["moment"].attrs.get("units", "N")))
    shown = f"{largest:.3g} {units}" if np.isfinite(largest) else "none converged"
    per_length = unit_text(str(sweep["curvature"].attrs.get("units", "mm-1")))
    axes.set_title(f"{side} {curvature:g} {per_length}\nlargest {shown}", fontsize=6.5)
    return [note for note in notes if not note.startswith("dots:")]


def macro_moment(
    model: xr.Dataset, side: str, directions: FloatArray, curvature: float
) -> FloatArray:
    """Moment per width [N] of a fit in directions (degree) at one curvature (mm-1)."""
    law = fit_parameters(model, side, directions)
    return two_regime_moment(
        curvature, law["a"], law["b"], law["kappa_0"], float(model["softening"])
    )


def macro_legend() -> list[Line2D]:
    """What the colors mean."""
    return [
        Line2D([], [], color=NATIVE_COLOR, marker="o", markersize=2.5, label="native"),
        Line2D([], [], color=MACRO_COLOR, label="macro"),
    ]

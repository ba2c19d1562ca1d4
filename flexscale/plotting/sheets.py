"""Sheets between end strips, of the macro model and of the scales: energy against curvature."""

from __future__ import annotations

from collections.abc import Sequence

import xarray as xr
from matplotlib.figure import Figure

from flexscale.checks import DATASET, checked
from flexscale.plotting.selection import pick_sides, require_variables, subject
from flexscale.plotting.side_curves import draw_side_curves
from flexscale.plotting.style import (
    COLUMN_WIDTH,
    MACRO_COLOR,
    NATIVE_COLOR,
    add_note,
    axis_label,
    flexscale_style,
    new_figure,
)


@checked(bent=DATASET)
def sheet(bent: xr.Dataset, sides: str | Sequence[str] | None = None) -> Figure:
    """Energy of a sheet against the curvature of its strips.

    Parameters
    ----------
    bent : dataset of kind sheet, or native_sheet.
    sides : "closing", "opening" or both; None takes all the dataset has.

    Raises
    ------
    SchemaError : not a sheet.
    UnknownNameError : a side the sheet was not bent to.
    """
    needed = ["energy", "status", "curvature", "side", "length", "width", "direction"]
    require_variables(bent, needed, "A figure of a bent sheet")
    shown = pick_sides(bent, sides)
    native = "n_scales" in bent
    with flexscale_style():
        figure = new_figure(COLUMN_WIDTH, COLUMN_WIDTH * 0.8)
        axes = figure.add_subplot()
        model, color = ("native", NATIVE_COLOR) if native else ("macro", MACRO_COLOR)
        energy, status = bent["energy"], bent["status"]
        notes = draw_side_curves(axes, energy, status, "curvature", shown, color)
        sizes = f"{float(bent['length']):g} mm × {float(bent['width']):g} mm"
        about = f"{sizes}, along {float(bent['direction']):g}°"
        axes.set_title(f"{subject(bent)}, {model} model\n{about}".lstrip(", "))
        axes.legend()
        add_note(figure, notes)
    return figure


def compared_sheets(native: xr.Dataset, macro: xr.Dataset, side: str) -> Figure:
    """Energy density of the same sheet by both models, against the curvature of its strips.

    Parameters
    ----------
    native, macro : datasets of kinds native_sheet and sheet.
    side : "closing" or "opening".

    Raises
    ------
    SchemaError : other datasets.
    """
    needed = ["energy_density", "status", "curvature", "side", "length", "width", "direction"]
    with flexscale_style():
        figure = new_figure(COLUMN_WIDTH, COLUMN_WIDTH * 0.8)
        axes = figure.add_subplot()
        for dataset, color, line, label in (
            (native, NATIVE_COLOR, "-", "native"),
            (macro, MACRO_COLOR, "--", "macro"),
        ):
            require_variables(dataset, needed, "A comparison of bent sheets")
            shown = dataset["energy_density"].sel(side=side)
            shown = shown.where(dataset["status"].sel(side=side) == 0)
            axes.plot(shown["curvature"], shown, color=color, linestyle=line, marker="o",
                      markersize=3.0, label=label)  # fmt: skip
        axes.set_xlabel(axis_label(native["curvature"]))
        axes.set_ylabel(axis_label(native["energy_density"]))
        axes.set_xlim(left=0.0)
        axes.set_ylim(bottom=0.0)
        sizes = f"{float(native['length']):g} mm × {float(native['width']):g} mm"
        axes.set_title(f"{subject(native)}, {side}\n{sizes}, along {float(native['direction']):g}°")
        axes.legend()
    return figure

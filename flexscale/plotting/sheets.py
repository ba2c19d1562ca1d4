"""Sheets of the macro model between end strips: energy against curvature."""

from __future__ import annotations

from collections.abc import Sequence

import xarray as xr
from matplotlib.figure import Figure

from flexscale.plotting.selection import pick_sides, require_variables, subject
from flexscale.plotting.side_curves import draw_side_curves
from flexscale.plotting.style import COLUMN_WIDTH, add_note, flexscale_style, new_figure


def sheet(bent: xr.Dataset, sides: str | Sequence[str] | None = None) -> Figure:
    """Energy of a sheet against the curvature of its strips.

    Parameters
    ----------
    bent : dataset of kind sheet.
    sides : "closing", "opening" or both; None takes all the dataset has.

    Raises
    ------
    SchemaError : not a sheet.
    UnknownNameError : a side the sheet was not bent to.
    """
    needed = ["energy", "status", "curvature", "side", "length", "width", "direction"]
    require_variables(bent, needed, "A figure of a bent sheet")
    shown = pick_sides(bent, sides)
    with flexscale_style():
        figure = new_figure(COLUMN_WIDTH, COLUMN_WIDTH * 0.8)
        axes = figure.add_subplot()
        notes = draw_side_curves(axes, bent["energy"], bent["status"], "curvature", shown)
        sizes = f"{float(bent['length']):g} mm × {float(bent['width']):g} mm"
        about = f"{sizes}, along {float(bent['direction']):g}°"
        axes.set_title(f"{subject(bent)}, macro model\n{about}".lstrip(", "))
        axes.legend()
        add_note(figure, notes)
    return figure

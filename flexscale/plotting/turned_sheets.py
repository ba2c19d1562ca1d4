"""Sheets with the pattern turned on them, and the cell bent in that direction (paper's Fig. 14)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.projections.polar import PolarAxes

from flexscale.checks import DATASET, checked
from flexscale.errors import MissingDataError
from flexscale.plotting.polar_axes import PolarCurve, common_radius, draw_polar_curves, polar_axes
from flexscale.plotting.selection import pick_sides, require_variables, subject, unconverged
from flexscale.plotting.style import (
    MACRO_COLOR,
    NATIVE_COLOR,
    NOTE_COLOR,
    PAGE_WIDTH,
    add_note,
    flexscale_style,
    new_figure,
    unit_text,
)

#: Line and marker of each energy of a curvature tensor.
_LOOKS: dict[str, dict[str, Any]] = {
    "tangent": {"linestyle": (0, (4.0, 1.6)), "marker": "s"},
    "paper": {"linestyle": (0, (1.0, 1.2)), "marker": "^"},
}
_LAW_NOTE = "thin lines without marks: the model bent to the cylinder everywhere, no free sides"
_NEEDED_OF_CELLS = ["energy_density", "moment", "status", "side", "direction", "curvature"]
_NEEDED = ["energy_density", "law_energy_density", "status", "variant", "side", "direction"]


@checked(turned=DATASET, sweep=DATASET)
def turned_sheet(
    turned: xr.Dataset, sweep: xr.Dataset, sides: str | Sequence[str] | None = None
) -> Figure:
    """Energy density of sheets against direction, beside the cell's; one column a side.

    Parameters
    ----------
    turned : dataset of kind turned_sheet.
    sweep : native samples of the same pattern, at the curvature of the sheets.
    sides : "closing", "opening" or both; None takes all the sheets were bent to.

    Raises
    ------
    SchemaError : other datasets.
    UnknownNameError : a side that they were not bent to.
    MissingDataError : the sweep lacks the curvature, a direction or a side of the sheets.
    """
    require_variables(turned, _NEEDED, "A figure of turned sheets", "turned_sheet")
    return turned_sheets([(turned, sweep, side) for side in pick_sides(turned, sides)])


def turned_sheets(columns: Sequence[tuple[xr.Dataset, xr.Dataset, str]]) -> Figure:
    """One column for each (turned sheets, sweep, side): energy densities, and errors below.

    Raises
    ------
    SchemaError, MissingDataError : as `turned_sheet`.
    """
    n = len(columns)
    width = min(PAGE_WIDTH, 0.3 * PAGE_WIDTH * n)
    with flexscale_style():
        figure = new_figure(width, 1.9 * width / n + 0.55)
        notes: list[str] = []
        first: Axes | None = None
        for column, (turned, sweep, side) in enumerate(columns):
            require_variables(turned, _NEEDED, "A figure of turned sheets")
            cell = cell_energy_density(turned, sweep).sel(side=side)
            panel = polar_axes(figure, (2, n, column + 1))
            notes += _draw_energies(panel, turned.sel(side=side), cell)
            panel.set_title(f"{subject(turned)}, {side}")
            errors = figure.add_subplot(2, n, n + column + 1, sharey=first)
            _draw_errors(errors, turned.sel(side=side), cell)
            if first is None:
                errors.set_ylabel("sheet over cell, less 1 [%]")
            else:
                errors.tick_params(labelleft=False)
            first = first or errors
        turned = columns[0][0]
        figure.legend(handles=_legend(turned), loc="outside upper center", ncols=3 if n > 1 else 1)
        sizes = f"{float(turned['length']):g} mm × {float(turned['width']):g} mm"
        at = f"{float(turned['curvature']):g} {unit_text('mm-1')}"
        units = unit_text(str(turned["energy_density"].attrs["units"]))
        what = f"above: energy per area [{units}], sheets of {sizes} at {at}"
        add_note(figure, [what, *dict.fromkeys(notes), _LAW_NOTE])
    return figure


def cell_energy_density(turned: xr.Dataset, sweep: xr.Dataset) -> xr.DataArray:
    """(side, direction) N/mm of the periodic cell, bent as the sheets are.

    Raises
    ------
    SchemaError : not a sweep.
    MissingDataError : the sweep lacks the curvature, a direction or a side of the sheets.
    """
    require_variables(sweep, _NEEDED_OF_CELLS, "A comparison with cells", "sweep")
    energies = sweep["energy_density"].where(~unconverged(sweep))
    try:
        found = energies.sel(side=turned["side"].values)
        found = found.sel(curvature=float(turned["curvature"]), method="nearest", tolerance=1e-9)
        found = found.sel(direction=turned["direction"].values, method="nearest", tolerance=1e-6)
    except KeyError as error:
        raise MissingDataError(
            "The sweep does not hold all sides and directions of the sheets at "
            f"{float(turned['curvature']):g} mm-1: give the sweep they were fitted to."
        ) from error
    return found.transpose("side", "direction")


def sheet_errors(
    turned: xr.Dataset, sweep: xr.Dataset, name: str = "energy_density"
) -> xr.DataArray:
    """(variant, side, direction) of a sheet's energy over the cell's, less 1; nan where unknown.

    Parameters
    ----------
    name : "energy_density", or "law_energy_density" for the model bent to the cylinder everywhere.
    """
    return turned[name] / cell_energy_density(turned, sweep).values - 1.0


def _draw_energies(axes: PolarAxes, turned: xr.Dataset, cell: xr.DataArray) -> list[str]:
    directions = turned["direction"].values.astype(float)
    dotted = np.ones(len(directions), dtype=bool)
    unknown = np.isnan(cell.values)
    curves = [PolarCurve(directions, cell.values, unknown, dotted, NATIVE_COLOR, label="cell")]
    for variant in turned["variant"].values:
        one = turned.sel(variant=variant)
        failed = one["status"].values != 0
        curves.append(
            PolarCurve(
                directions,
                np.where(failed, np.nan, one["energy_density"].values),
                failed,
                dotted,
                MACRO_COLOR,
                label=str(variant),
                **_LOOKS[str(variant)],
            )
        )
    axes.set_thetagrids(np.arange(0, 360, 30), labels=["0°", "", "", "90°", *[""] * 8])
    return draw_polar_curves(axes, curves, common_radius(curves))


def _draw_errors(axes: Axes, turned: xr.Dataset, cell: xr.DataArray) -> None:
    directions = turned["direction"].values.astype(float)
    axes.axhline(0.0, color=NATIVE_COLOR, linewidth=0.8)
    for variant in turned["variant"].values:
        one, look = turned.sel(variant=variant), _LOOKS[str(variant)]
        law = 100.0 * (one["law_energy_density"].values / cell.values - 1.0)
        axes.plot(directions, law, color=NOTE_COLOR, linewidth=0.6, linestyle=look["linestyle"])
        off = 100.0 * (one["energy_density"].values / cell.values - 1.0)
        axes.plot(directions, off, color=MACRO_COLOR, markersize=2.5, label=str(variant), **look)
    axes.set_xlim(-4.0, 184.0)
    axes.set_xticks(np.arange(0, 181, 45))
    axes.set_xlabel("direction [°]")


def _legend(turned: xr.Dataset) -> list[Line2D]:
    handles = [Line2D([], [], color=NATIVE_COLOR, marker="o", markersize=2.5, label="native cell")]
    for variant in turned["variant"].values:
        look, label = _LOOKS[str(variant)], f"macro sheet, {variant}"
        handles.append(Line2D([], [], color=MACRO_COLOR, markersize=2.5, label=label, **look))
    return handles

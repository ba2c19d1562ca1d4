"""Sheets with the pattern turned on them, and the cell bent in that direction (paper's Fig. 14)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
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
    SCALE_COLOR,
    add_note,
    flexscale_style,
    new_figure,
    unit_text,
)

#: Color, line and marker of each energy of a curvature tensor, and of sheets of scales.
_LOOKS: dict[str, dict[str, Any]] = {
    "tangent": {"color": MACRO_COLOR, "linestyle": (0, (4.0, 1.6)), "marker": "s"},
    "paper": {"color": SCALE_COLOR, "linestyle": (0, (1.0, 1.2)), "marker": "^"},
}
_NATIVE_LOOK: dict[str, Any] = {"color": NATIVE_COLOR, "linestyle": "none", "marker": "D"}
_CELL_LOOK: dict[str, Any] = {"color": NATIVE_COLOR, "linestyle": "-", "marker": "o"}
_LAW_NOTE = "thin lines without marks: the model bent to the cylinder everywhere, no free sides"
_NEEDED_OF_CELLS = ["energy_density", "moment", "status", "side", "direction", "curvature"]
_NEEDED_OF_SHEETS = ["energy_density", "status", "side", "direction", "curvature"]
_NEEDED = [*_NEEDED_OF_SHEETS, "law_energy_density", "variant"]


@dataclass(frozen=True)
class TurnedColumn:
    """What one column shows, to one side.

    Attributes
    ----------
    turned, sweep : macro sheets, and native samples of the same pattern at their curvature.
    side : "closing" or "opening".
    native : sheets of scales, of kind native_turned_sheet, if there are some.
    thin : macro sheets and sweep of another native model, drawn as thin lines.
    """

    turned: xr.Dataset
    sweep: xr.Dataset
    side: str
    native: xr.Dataset | None = None
    thin: tuple[xr.Dataset, xr.Dataset] | None = None


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
    shown = pick_sides(turned, sides)
    return turned_sheets([TurnedColumn(turned, sweep, side) for side in shown])


@checked(sheets=DATASET)
def native_turned_sheet(sheets: xr.Dataset, sides: str | Sequence[str] | None = None) -> Figure:
    """Energy density of sheets of scales against direction; one panel a side.

    Parameters
    ----------
    sheets : dataset of kind native_turned_sheet.
    sides : "closing", "opening" or both; None takes all the sheets were bent to.

    Raises
    ------
    SchemaError : another dataset.
    UnknownNameError : a side that they were not bent to.
    """
    kind = "native_turned_sheet"
    require_variables(sheets, _NEEDED_OF_SHEETS, "A figure of turned sheets of scales", kind)
    shown = pick_sides(sheets, sides)
    width = 0.4 * PAGE_WIDTH * len(shown)
    with flexscale_style():
        figure = new_figure(width, 0.42 * PAGE_WIDTH)
        notes: list[str] = []
        for place, side in enumerate(shown):
            panel = polar_axes(figure, (1, len(shown), place + 1))
            curve = _of_scales(sheets.sel(side=side))
            notes += draw_polar_curves(panel, [curve], common_radius([curve]))
            panel.set_title(f"{subject(sheets)}, {side}")
        add_note(figure, [_what(sheets), *dict.fromkeys(notes)])
    return figure


def turned_sheets(columns: Sequence[TurnedColumn], thin_model: str = "shell") -> Figure:
    """One column each: energy densities, and errors below.

    Parameters
    ----------
    thin_model : native model of the thin lines, for the legend.

    Raises
    ------
    SchemaError, UnknownNameError, MissingDataError : as `turned_sheet`.
    """
    n = len(columns)
    width = min(PAGE_WIDTH, 0.3 * PAGE_WIDTH * n)
    with flexscale_style():
        figure = new_figure(width, 1.9 * width / n + 0.65)
        notes: list[str] = []
        first: Axes | None = None
        for place, column in enumerate(columns):
            panel = polar_axes(figure, (2, n, place + 1))
            notes += _draw_energies(panel, column)
            panel.set_title(f"{subject(column.turned)}, {column.side}")
            errors = figure.add_subplot(2, n, n + place + 1, sharey=first)
            _draw_errors(errors, column)
            if first is None:
                errors.set_ylabel("sheet over cell, less 1 [%]")
            else:
                errors.tick_params(labelleft=False)
            first = first or errors
        turned = columns[0].turned
        handles = _legend(columns, thin_model)
        figure.legend(handles=handles, loc="outside upper center", ncols=3 if n > 1 else 1)
        what = f"above: {_what(turned)}"
        thin = any(column.thin is not None for column in columns)
        last = f"thin below: sheets of the {thin_model} over its own cell" if thin else _LAW_NOTE
        add_note(figure, [what, *dict.fromkeys(notes), last])
    return figure


def _what(turned: xr.Dataset) -> str:
    """What is drawn, of sheets of which size, at which curvature."""
    sizes = f"{float(turned['length']):g} mm × {float(turned['width']):g} mm"
    at = f"{float(turned['curvature']):g} {unit_text('mm-1')}"
    units = unit_text(str(turned["energy_density"].attrs["units"]))
    return f"energy per area [{units}], sheets of {sizes} at {at}"


def cell_energy_density(turned: xr.Dataset, sweep: xr.Dataset) -> xr.DataArray:
    """(side, direction) N/mm of the periodic cell, bent as the sheets are.

    Parameters
    ----------
    turned : dataset of kind turned_sheet, or native_turned_sheet.

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
    """(…, side, direction) of a sheet's energy over the cell's, less 1; nan where unknown.

    Parameters
    ----------
    turned : dataset of kind turned_sheet, with an axis `variant` before, or native_turned_sheet.
    name : "energy_density", or "law_energy_density" for the model bent to the cylinder everywhere.
    """
    return turned[name] / cell_energy_density(turned, sweep).values - 1.0


def _draw_energies(axes: PolarAxes, column: TurnedColumn) -> list[str]:
    side, curves = column.side, []
    cell = cell_energy_density(column.turned, column.sweep).sel(side=side)
    curves.append(_curve(cell, np.isnan(cell.values), _CELL_LOOK, "cell"))
    for variant in column.turned["variant"].values:
        one = column.turned.sel(side=side, variant=variant)
        failed = one["status"].values != 0
        curves.append(_curve(one["energy_density"], failed, _LOOKS[str(variant)], str(variant)))
    if column.native is not None:
        require_variables(column.native, _NEEDED_OF_SHEETS, "Sheets of scales")
        pick_sides(column.native, side)
        curves.append(_of_scales(column.native.sel(side=side)))
    axes.set_thetagrids(np.arange(0, 360, 30), labels=["0°", "", "", "90°", *[""] * 8])
    others = []
    if column.thin is not None:
        thin = cell_energy_density(*column.thin).sel(side=side)
        others.append(_curve(thin, np.isnan(thin.values), _CELL_LOOK))
    notes = draw_polar_curves(axes, curves, common_radius([*curves, *others]))
    for curve in others:
        turns = [curve.directions + turn for turn in (0.0, 180.0)]
        ring = np.radians([*turns[0], *turns[1], 360.0 + turns[0][0]])
        values = [*curve.values, *curve.values, curve.values[0]]
        axes.plot(ring, values, color=NOTE_COLOR, linewidth=0.6)
    return notes


def _of_scales(one: xr.Dataset) -> PolarCurve:
    """Energies of sheets of scales bent to one side."""
    return _curve(one["energy_density"], one["status"].values != 0, _NATIVE_LOOK, "scales")


def _curve(
    values: xr.DataArray, failed: np.ndarray, look: dict[str, Any], label: str = ""
) -> PolarCurve:
    """Energies by direction, with a mark at each."""
    return PolarCurve(
        values["direction"].values.astype(float),
        np.where(failed, np.nan, values.values),
        failed,
        np.ones(len(failed), dtype=bool),
        label=label,
        **look,
    )


def _draw_errors(axes: Axes, column: TurnedColumn) -> None:
    axes.axhline(0.0, color=NATIVE_COLOR, linewidth=0.8)
    thin, name = column.thin or (column.turned, column.sweep), "law_energy_density"
    below = sheet_errors(*thin, "energy_density" if column.thin else name).sel(side=column.side)
    errors = sheet_errors(column.turned, column.sweep).sel(side=column.side)
    for variant in column.turned["variant"].values:
        look = _LOOKS[str(variant)]
        if variant in below["variant"]:
            plain = look | {"marker": "", "color": look["color"] if column.thin else NOTE_COLOR}
            one = 100.0 * below.sel(variant=variant)
            axes.plot(one["direction"], one, linewidth=0.6, **plain)
        off = 100.0 * errors.sel(variant=variant)
        axes.plot(off["direction"], off, markersize=2.5, label=str(variant), **look)
    if column.native is not None:
        native = 100.0 * sheet_errors(column.native, column.sweep).sel(side=column.side)
        axes.plot(native["direction"], native, markersize=2.5, label="scales", **_NATIVE_LOOK)
    axes.set_xlim(-4.0, 184.0)
    axes.set_xticks(np.arange(0, 181, 45))
    axes.set_xlabel("direction [°]")


def _legend(columns: Sequence[TurnedColumn], thin_model: str) -> list[Line2D]:
    scales = any(column.native is not None for column in columns)
    thin = any(column.thin is not None for column in columns)
    # Only joints have sheets of scales; beside another model, the usual one is meant.
    of = "scales on joints" if scales or thin else "native"
    entries = [(f"cell, {of}", _CELL_LOOK)]
    if scales:
        entries.append((f"sheet, {of}", _NATIVE_LOOK))
    variants = columns[0].turned["variant"].values
    entries += [(f"macro sheet, {variant}", _LOOKS[str(variant)]) for variant in variants]
    handles = [Line2D([], [], markersize=2.5, label=label, **look) for label, look in entries]
    if thin:
        handles.append(Line2D([], [], color=NOTE_COLOR, linewidth=0.6, label=f"cell, {thin_model}"))
    return handles

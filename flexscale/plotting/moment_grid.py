"""Moments against direction for growing curvature, one row per pattern (paper's Figs. 7 and 8)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.projections.polar import PolarAxes

from flexscale.plotting.polar import moment_curves
from flexscale.plotting.polar_axes import common_radius, draw_polar_curves, polar_axes
from flexscale.plotting.scene import draw_pattern
from flexscale.plotting.selection import pick_values, subject
from flexscale.plotting.style import (
    MACRO_COLOR,
    PAGE_WIDTH,
    add_note,
    flexscale_style,
    moment_label,
    new_figure,
    unit_text,
)

N_CURVATURES = 4


THIN_NOTE = "thin: the shell's, on a radius of its own"


def moment_grid(
    rows: Sequence[tuple[xr.Dataset, xr.Dataset, xr.Dataset | None]], side: str = "closing"
) -> Figure:
    """One row per pattern: the pattern from above, then the moment at up to four curvatures.

    Parameters
    ----------
    rows : cell and sweep of each pattern, and a sweep of another model or None.
    side : "closing" or "opening".

    Returns
    -------
    Figure. As in the paper each panel has its own radius; the largest moment is above it. Curves
    of the other model are thin, and fill the panel as well: their shape is to be compared.
    """
    with flexscale_style():
        n_columns = N_CURVATURES + 1
        figure = new_figure(PAGE_WIDTH, PAGE_WIDTH / n_columns * 1.35 * len(rows) + 0.2)
        notes: list[str] = []
        for row, (cell, sweep, other) in enumerate(rows):
            first = row * n_columns + 1
            axes = figure.add_subplot(len(rows), n_columns, first)
            draw_pattern(axes, cell)
            axes.set_title(subject(sweep))
            notes += _draw_row(figure, sweep, other, side, (len(rows), n_columns, first + 1))
        notes.append(f"{moment_label(rows[0][1])}; each panel has its own radius, from 0")
        add_note(figure, list(dict.fromkeys(notes)))
    return figure


def _draw_row(
    figure: Figure,
    sweep: xr.Dataset,
    other: xr.Dataset | None,
    side: str,
    place: tuple[int, int, int],
) -> list[str]:
    """Moment panels of one pattern from a subplot place on; returns notes on how to read them."""
    chosen = pick_values(sweep["curvature"], None, n_default=N_CURVATURES, skip_zero=True)
    moment_unit = unit_text(str(sweep["moment"].attrs.get("units", "N")))
    curvature_unit = unit_text(str(sweep["curvature"].attrs.get("units", "mm-1")))
    notes: list[str] = []
    for column, curve in enumerate(moment_curves(sweep, side, chosen)):
        axes = polar_axes(figure, (*place[:2], place[2] + column))
        axes.set_thetagrids(np.arange(0, 360, 30), labels=[""] * 12)
        # Dots would crowd a panel this small.
        curve = replace(curve, dotted=np.zeros(len(curve.values), dtype=bool))
        radius = common_radius([curve])
        notes += draw_polar_curves(axes, [curve], radius)
        if other is not None:
            notes += _draw_thin(
                axes, other, side, float(sweep["curvature"][chosen[column]]), radius
            )
        finite = curve.values[np.isfinite(curve.values)]
        largest = f"largest {finite.max():.3g} {moment_unit}" if finite.size else "no result"
        axes.set_title(f"{curve.label} {curvature_unit}\n{largest}")
    return notes


def _draw_thin(
    axes: PolarAxes, sweep: xr.Dataset, side: str, curvature: float, radius: float
) -> list[str]:
    """The moments of another model at a curvature, if it has that one."""
    known = sweep["curvature"].values
    index = int(np.abs(known - curvature).argmin())
    if abs(known[index] - curvature) > 1e-9:
        return []
    values = sweep["moment"].sel(side=side).isel(curvature=index).values
    if not np.isfinite(values).all():
        return []
    turns = np.radians(np.concatenate([sweep["direction"].values + k for k in (0.0, 180.0, 360.0)]))
    n = 2 * len(values) + 1
    scaled = np.tile(values, 3)[:n] * radius / values.max()
    axes.plot(turns[:n], scaled, color=MACRO_COLOR, linewidth=0.5, linestyle="--")
    return [THIN_NOTE]

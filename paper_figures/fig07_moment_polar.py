"""Figure 7 of the paper: bending moment in every direction, for growing curvature.

One row per pattern: the pattern from above, then the moment at up to four curvatures. As in the
paper each panel has its own radius; the largest moment is printed above it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from flexscale.plotting.figures import Need
from flexscale.plotting.polar import moment_curves
from flexscale.plotting.polar_axes import common_radius, draw_polar_curves, polar_axes
from flexscale.plotting.scene import draw_pattern
from flexscale.plotting.selection import pick_values, subject
from flexscale.plotting.style import (
    PAGE_WIDTH,
    add_note,
    flexscale_style,
    new_figure,
    unit_text,
)

_COMMAND = "flexscale run workflows/quickstart.yaml"
PATTERNS = {"hexagon": "IH20", "square": "IH76"}

NEEDS = {
    f"{pattern}_{kind}": Need(kind, _COMMAND, {"family": family, "pattern": pattern})
    for pattern, family in PATTERNS.items()
    for kind in ("cell", "sweep")
}
CAPTION = (
    "Native-scale simulations: bending moment against bending direction when the scales close, "
    "for growing curvature (after Fig. 7 of the paper, its patterns a and b)."
)
SIDE = "closing"
N_CURVATURES = 4


def draw(inputs: Mapping[str, xr.Dataset]) -> Figure:
    """Grid of panels, one row per pattern.

    Parameters
    ----------
    inputs : datasets by the names of NEEDS.
    """
    with flexscale_style():
        n_columns = N_CURVATURES + 1
        height = PAGE_WIDTH / n_columns * 1.35 * len(PATTERNS) + 0.2
        figure = new_figure(PAGE_WIDTH, height)
        notes: list[str] = []
        for row, pattern in enumerate(PATTERNS):
            sweep = inputs[f"{pattern}_sweep"]
            axes = figure.add_subplot(len(PATTERNS), n_columns, row * n_columns + 1)
            draw_pattern(axes, inputs[f"{pattern}_cell"])
            axes.set_title(subject(sweep))
            notes += _draw_row(figure, sweep, row * n_columns + 2, n_columns)
        notes.append("each panel has its own radius, from 0")
        add_note(figure, list(dict.fromkeys(notes)))
    return figure


def _draw_row(figure: Figure, sweep: xr.Dataset, first: int, n_columns: int) -> list[str]:
    """Moment panels of one pattern; returns notes on how to read them."""
    chosen = pick_values(sweep["curvature"], None, n_default=N_CURVATURES, skip_zero=True)
    moment_unit = unit_text(str(sweep["moment"].attrs.get("units", "N")))
    curvature_unit = unit_text(str(sweep["curvature"].attrs.get("units", "mm-1")))
    notes: list[str] = []
    for column, curve in enumerate(moment_curves(sweep, SIDE, chosen)):
        axes = polar_axes(figure, (len(PATTERNS), n_columns, first + column))
        axes.set_thetagrids(np.arange(0, 360, 30), labels=[""] * 12)
        # Dots would crowd a panel this small.
        curve = replace(curve, dotted=np.zeros(len(curve.values), dtype=bool))
        notes += draw_polar_curves(axes, [curve], common_radius([curve]))
        finite = curve.values[np.isfinite(curve.values)]
        largest = f"largest {finite.max():.3g} {moment_unit}" if finite.size else "no result"
        axes.set_title(f"{curve.label} {curvature_unit}\n{largest}")
    return notes

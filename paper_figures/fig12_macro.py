"""Figure 12 of the paper: moments of the macro model against native ones, in every direction.

One row per pattern: the pattern from above, then the moment at up to four curvatures. As in the
paper each panel has its own radius; the largest native moment is printed above it.
"""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr
from matplotlib.figure import Figure

from flexscale.plotting.figures import Need
from flexscale.plotting.macro_polar import N_CURVATURES, draw_macro_panel, macro_legend
from flexscale.plotting.polar_axes import polar_axes
from flexscale.plotting.scene import draw_pattern
from flexscale.plotting.selection import pick_values, subject
from flexscale.plotting.style import PAGE_WIDTH, add_note, flexscale_style, new_figure

_COMMAND = "flexscale run workflows/quickstart.yaml"
PATTERNS = {"hexagon": "IH20", "square": "IH76"}

NEEDS = {
    f"{pattern}_{kind}": Need(kind, _COMMAND, {"family": family, "pattern": pattern})
    for pattern, family in PATTERNS.items()
    for kind in ("cell", "sweep", "fit")
}
CAPTION = (
    "Native-scale simulations and the macro model: bending moment against bending direction when "
    "the scales close, for growing curvature (after Fig. 12 of the paper)."
)
SIDE = "closing"


def draw(inputs: Mapping[str, xr.Dataset]) -> Figure:
    """Grid of panels, one row per pattern; `inputs` are datasets by the names of NEEDS."""
    with flexscale_style():
        n_columns = N_CURVATURES + 1
        figure = new_figure(PAGE_WIDTH, PAGE_WIDTH / n_columns * 1.35 * len(PATTERNS) + 0.3)
        notes: list[str] = []
        for row, pattern in enumerate(PATTERNS):
            fit, sweep = inputs[f"{pattern}_fit"], inputs[f"{pattern}_sweep"]
            first = row * n_columns + 1
            axes = figure.add_subplot(len(PATTERNS), n_columns, first)
            draw_pattern(axes, inputs[f"{pattern}_cell"])
            axes.set_title(subject(sweep))
            chosen = pick_values(sweep["curvature"], None, n_default=N_CURVATURES, skip_zero=True)
            for column, index in enumerate(chosen, start=1):
                panel = polar_axes(figure, (len(PATTERNS), n_columns, first + column))
                notes += draw_macro_panel(panel, fit, sweep, SIDE, int(index))
        figure.legend(handles=macro_legend(), loc="outside upper right", ncols=2)
        add_note(figure, [*dict.fromkeys(notes), "each panel has its own radius, from 0"])
    return figure

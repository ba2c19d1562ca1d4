"""Figure 12 of the paper: moments of the macro model against native ones, in every direction.

One row per pattern: the pattern from above, then the moment at up to four curvatures. As in the
paper each panel has its own radius; the largest native moment is printed above it.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from flexscale.plotting.figure_scripts import Need
from flexscale.plotting.macro_polar import (
    N_CURVATURES,
    draw_macro_panel,
    macro_legend,
    macro_moment,
)
from flexscale.plotting.polar_axes import polar_axes
from flexscale.plotting.scene import draw_pattern
from flexscale.plotting.selection import pick_values, subject
from flexscale.plotting.style import PAGE_WIDTH, add_note, flexscale_style, moment_label, new_figure

_SHELL = "flexscale run workflows/named_patterns.yaml"
_PRINTED = "flexscale run workflows/printed.yaml"
PATTERNS = {"hexagon": "IH20", "square": "IH76", "chevron": "IH64", "threefold": "IH07"}

NEEDS = {
    **{
        f"{pattern}_cell": Need("cell", _SHELL, {"family": family, "pattern": pattern})
        for pattern, family in PATTERNS.items()
    },
    **{
        f"{pattern}_{kind}": Need(kind, _PRINTED, {"family": family, "pattern": pattern}, "joints")
        for pattern, family in PATTERNS.items()
        for kind in ("sweep", "fit")
    },
}
CAPTION = (
    "Cells of scales on joints (native) and the macro model fitted to them: bending moment against "
    "bending direction when the scales close, for growing curvature (after Fig. 12 of the paper). "
    "Patterns from above are the shell's meshes."
)
PAPER_SAYS = (
    "The macro model generally achieves good agreement. For larger curvatures the approximation is "
    "of high quality, with larger deviations for some patterns at lower curvatures, with 19 "
    "variables."
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
        label = f"{moment_label(inputs['hexagon_sweep'])}; each panel has its own radius, from 0"
        add_note(figure, [*dict.fromkeys(notes), label])
    return figure


def findings(inputs: Mapping[str, xr.Dataset]) -> list[str]:
    """Errors of the macro model's moments at the curvatures drawn."""
    sentences = []
    for pattern in PATTERNS:
        fit, sweep = inputs[f"{pattern}_fit"], inputs[f"{pattern}_sweep"]
        directions = sweep["direction"].values.astype(float)
        chosen = pick_values(sweep["curvature"], None, n_default=N_CURVATURES, skip_zero=True)
        parts = []
        for index in chosen:
            one = sweep["moment"].sel(side=SIDE).isel(curvature=int(index))
            macro = macro_moment(fit, SIDE, directions, float(one["curvature"]))
            off = 100.0 * np.abs(macro / one.values - 1.0)
            errors = f"{np.nanmedian(off):.2g} % ({np.nanmax(off):.2g} %)"
            parts.append(f"{float(one['curvature']):g} mm-1 {errors}")
        sentences.append(
            f"{pattern}, median (worst) error over directions at {', '.join(parts)}; "
            f"{int(fit['n_parameters'])} parameters for both sides."
        )
    return sentences

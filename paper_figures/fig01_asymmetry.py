"""Figure 1 of the paper, as far as it is computed: contact to one side, and its homogenization.

Top: one pattern bent to both sides. Bottom: four patterns with native and macro moments.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from flexscale.plotting.cell_geometry import cell_offsets, shape_surfaces
from flexscale.plotting.figure_scripts import Need
from flexscale.plotting.macro_polar import draw_macro_panel, macro_legend, macro_moment
from flexscale.plotting.polar_axes import polar_axes
from flexscale.plotting.raster import View
from flexscale.plotting.scene import (
    BESIDE_AXIS,
    draw_panel,
    draw_pattern,
    draw_ruler,
    half_window,
    sample_title,
)
from flexscale.plotting.selection import pick_values, subject
from flexscale.plotting.style import PAGE_WIDTH, add_note, flexscale_style, new_figure

PATTERNS = {"hexagon": "IH20", "square": "IH76", "arrowhead": "IH69", "fish_scale": "IH68"}
BENT = "hexagon"
SIDE, CURVATURE = "closing", 0.015
_SHELL = "flexscale run workflows/named_patterns.yaml"
_PRINTED = "flexscale run workflows/printed.yaml"

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
NEEDS["shape"] = Need("shape", _PRINTED, {"family": PATTERNS[BENT], "pattern": BENT}, "joints")
CAPTION = (
    "Scales on joints press on each other when the sheet closes and part when it opens (top). "
    "Bending moment of four patterns against direction, of cells of scales on joints (native) and "
    "of the macro model fitted to them (bottom; after Fig. 1 of the paper, whose upper part shows "
    "prints). Patterns from above are the shell's meshes."
)
PAPER_SAYS = (
    "Bending-induced contact between scales leads to distinct behavior for positive and negative "
    "curvatures; homogenization captures the curvature response of arbitrary scale patterns."
)


def draw(inputs: Mapping[str, xr.Dataset]) -> Figure:
    """Pictures of the bent cell, patterns, and polar moments; `inputs` by the names of NEEDS."""
    shape = inputs["shape"]
    camera = View(float(shape["sample_direction"].values[0]) + BESIDE_AXIS, 24.0)
    panels = [shape_surfaces(shape, sample, cell_offsets(3), camera) for sample in (0, 1)]
    half = half_window(panels)
    with flexscale_style():
        tops = PAGE_WIDTH / 2 * half[1] / half[0] + 0.2
        column = PAGE_WIDTH / len(PATTERNS)
        heights = [tops, 0.62 * column, 1.1 * column]
        figure = new_figure(PAGE_WIDTH, sum(heights) + 0.5)
        grid = figure.add_gridspec(3, len(PATTERNS), height_ratios=heights)
        for sample, surfaces in enumerate(panels):
            axes = figure.add_subplot(grid[0, 2 * sample : 2 * sample + 2])
            draw_panel(axes, surfaces, half, PAGE_WIDTH / 2)
            axes.set_title(sample_title(shape, sample))
            if sample == 0:
                draw_ruler(axes, camera, half)
        notes: list[str] = []
        for place, pattern in enumerate(PATTERNS):
            fit, sweep = inputs[f"{pattern}_fit"], inputs[f"{pattern}_sweep"]
            axes = figure.add_subplot(grid[1, place])
            draw_pattern(axes, inputs[f"{pattern}_cell"])
            axes.set_title(subject(sweep))
            panel = polar_axes(figure, grid[2, place])
            (index,) = pick_values(sweep["curvature"], CURVATURE, n_default=1)
            notes += draw_macro_panel(panel, fit, sweep, SIDE, int(index))
        figure.legend(handles=macro_legend(), loc="outside lower right", ncols=2)
        add_note(figure, [*dict.fromkeys(notes), "each polar panel has its own radius, from 0"])
    return figure


def findings(inputs: Mapping[str, xr.Dataset]) -> list[str]:
    """Closing against opening, and the macro model's error at the drawn curvature."""
    sentences = []
    for pattern in PATTERNS:
        fit, sweep = inputs[f"{pattern}_fit"], inputs[f"{pattern}_sweep"]
        one = sweep.sel(curvature=CURVATURE, method="nearest")
        ratio = (one["moment"].sel(side="closing") / one["moment"].sel(side="opening")).values
        native = one["moment"].sel(side=SIDE).values
        directions = sweep["direction"].values.astype(float)
        macro = macro_moment(fit, SIDE, directions, float(one["curvature"]))
        error = 100.0 * np.abs(macro / native - 1.0)
        sentences.append(
            f"{pattern}, at {float(one['curvature']):g} mm-1: closing moments are "
            f"{ratio.min():.3g} to {ratio.max():.3g} times opening ones; the macro model is "
            f"{np.median(error):.2g} % off (median over directions, worst {error.max():.2g} %)."
        )
    return sentences

"""Closing against opening: moments with contact marked, beside the bent cells (Figs. 10, 11)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from flexscale.plotting.cell_geometry import cell_offsets, shape_surfaces
from flexscale.plotting.raster import View
from flexscale.plotting.scene import BESIDE_AXIS, draw_panel, draw_ruler, half_window, sample_title
from flexscale.plotting.selection import pick_sides, pick_values, require_variables, subject
from flexscale.plotting.style import (
    CONTACT_COLOR,
    PAGE_WIDTH,
    SCALE_COLOR,
    SIDE_LINESTYLES,
    SUBSTRATE_COLOR,
    axis_label,
    direction_color,
    flexscale_style,
    new_figure,
)

_CURVES_SHARE = 0.36  # of the figure's width


def both_sides(
    sweep: xr.Dataset,
    shape: xr.Dataset,
    directions: float | Sequence[float],
    sides: str | Sequence[str] | None = None,
    *,
    elevation: float = 24.0,
) -> Figure:
    """Moment against curvature, filled markers where scales touch, and deformed cells.

    Parameters
    ----------
    sweep : dataset of kind sweep.
    shape : dataset of kind shape, its first two samples are drawn.
    directions : degree, those of the curves.
    sides : of the curves; None takes all the sweep has.
    elevation : degree, of the camera above the sheet; negative looks at it from below.

    Returns
    -------
    Figure with one plot and up to two pictures at one length scale.
    """
    require_variables(sweep, ["moment", "contact_pairs", "direction", "curvature"], "This figure")
    shown = pick_sides(sweep, sides)
    chosen = pick_values(sweep["direction"], directions, n_default=1)
    samples = list(range(min(2, shape.sizes["sample"])))
    offsets = cell_offsets(3)
    view = View(float(shape["sample_direction"].values[0]) + BESIDE_AXIS, elevation)
    panels = [shape_surfaces(shape, sample, offsets, view) for sample in samples]
    half = half_window(panels)
    with flexscale_style():
        panel_width = PAGE_WIDTH * (1.0 - _CURVES_SHARE) / len(samples)
        figure = new_figure(PAGE_WIDTH, max(2.3, panel_width * half[1] / half[0] + 0.9))
        ratios = [_CURVES_SHARE] + [(1.0 - _CURVES_SHARE) / len(samples)] * len(samples)
        grid = figure.add_gridspec(1, len(ratios), width_ratios=ratios)
        axes = figure.add_subplot(grid[0])
        _draw_moments(axes, sweep, shown, chosen)
        for column, (sample, surfaces) in enumerate(zip(samples, panels, strict=True), start=1):
            picture = figure.add_subplot(grid[column])
            draw_panel(picture, surfaces, half, panel_width)
            picture.set_title(sample_title(shape, sample))
            if column == 1:
                draw_ruler(picture, view, half)
        handles = [
            Patch(color=SCALE_COLOR, label="scales"),
            Patch(color=SUBSTRATE_COLOR, label="substrate"),
            Patch(color=CONTACT_COLOR, label="pressed by another scale"),
        ]
        figure.legend(handles=handles, loc="outside lower right", ncols=3)
        figure.suptitle(subject(sweep))
    return figure


def _draw_moments(
    axes: Axes, sweep: xr.Dataset, sides: Sequence[str], directions: np.ndarray
) -> None:
    curvature = sweep["curvature"].values
    several = len(directions) > 1
    handles = []
    for index in directions:
        direction = float(sweep["direction"].values[index])
        color = direction_color(direction)
        for side in sides:
            line = sweep.sel(side=side).isel(direction=index)
            label = f"{side}, {direction:g}°" if several else side
            look = {"color": color, "linestyle": SIDE_LINESTYLES[side]}
            axes.plot(curvature, line["moment"].values, label=label, **look)
            touching = line["contact_pairs"].values > 0
            for where, face in ((touching, color), (~touching, "white")):
                axes.plot(
                    curvature[where],
                    line["moment"].values[where],
                    linestyle="none",
                    marker="o",
                    markersize=3.0,
                    color=color,
                    markerfacecolor=face,
                )
            handles.append(Line2D([], [], label=label, **look))
    axes.set_xlim(left=0.0)
    axes.set_ylim(bottom=0.0)
    axes.xaxis.set_major_locator(MaxNLocator(4))
    axes.set_xlabel(axis_label(sweep["curvature"]))
    axes.set_ylabel(axis_label(sweep["moment"]))
    if not several:
        axes.set_title(f"direction {float(sweep['direction'].values[directions[0]]):g}°")
    dots: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": 3.0, "color": "0.3"}
    handles += [
        Line2D([], [], label="scales touch", **dots),
        Line2D([], [], label="free", markerfacecolor="white", **dots),
    ]
    axes.legend(handles=handles, loc="upper left")

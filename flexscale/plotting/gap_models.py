"""Gap models: stiffness of the flat cell, and the curvature at which scales first meet."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from flexscale.arrays import FloatArray
from flexscale.checks import DATASET, checked
from flexscale.datasets.stiffness import directional_stiffness
from flexscale.plotting.polar_axes import PolarCurve, common_radius, draw_polar_curves, polar_axes
from flexscale.plotting.selection import pick_sides, require_variables, subject
from flexscale.plotting.style import (
    MACRO_COLOR,
    PAGE_WIDTH,
    SIDE_LINESTYLES,
    add_note,
    flexscale_style,
    new_figure,
    unit_text,
)

_NEEDED = ("tangent", "onset", "direction", "side", "largest_curvature")


@checked(model=DATASET)
def gap_model(model: xr.Dataset) -> Figure:
    """Bending stiffness before contact, and curvature of first contact, against direction.

    Parameters
    ----------
    model : dataset of kind gap_model.
    """
    require_variables(model, _NEEDED, "A figure of a gap model", "gap_model")
    directions = np.asarray(model["direction"].values, dtype=float)
    sides = pick_sides(model, None)
    with flexscale_style():
        figure = new_figure(PAGE_WIDTH, 0.5 * PAGE_WIDTH)
        figure.suptitle(f"{subject(model)}: gap model".lstrip(": "))
        tangent = model["tangent"].transpose("component", "other_component").values
        stiffness = [_curve(directions, directional_stiffness(tangent, directions), "closing")]
        axes = polar_axes(figure, (1, 2, 1))
        notes = draw_polar_curves(axes, stiffness, common_radius(stiffness))
        axes.set_title(f"a(θ) [{unit_text('N mm')}]")
        axes = polar_axes(figure, (1, 2, 2))
        onset, most = (
            model["onset"].transpose("side", "direction"),
            float(model["largest_curvature"]),
        )
        if (onset > most).any():
            onset = onset.where(onset <= most)
            notes.append(f"not drawn: first contact beyond {most:g} mm⁻¹, up to which it is tried")
        curves = [_curve(directions, onset.sel(side=side).values, side) for side in sides]
        notes += draw_polar_curves(axes, curves, common_radius(curves))
        title = f"κ₀(θ) [{unit_text('mm-1')}]"
        met = [side for side in sides if np.isfinite(onset.sel(side=side)).any()]
        axes.set_title(title if met else f"{title}\nno contact up to {most:g} mm⁻¹")
        for side in met:
            axes.plot([], [], color=MACRO_COLOR, linestyle=SIDE_LINESTYLES[side], label=side)
        if met:
            figure.legend(*axes.get_legend_handles_labels(), loc="outside right center")
        add_note(figure, list(dict.fromkeys(notes)))
    return figure


def _curve(directions: FloatArray, values: FloatArray, side: str) -> PolarCurve:
    return PolarCurve(
        directions,
        np.asarray(values, dtype=float),
        failed=np.zeros(len(directions), dtype=bool),
        dotted=np.zeros(len(directions), dtype=bool),
        color=MACRO_COLOR,
        linestyle=SIDE_LINESTYLES[side],
    )

"""Tensor models: how far their energies are from the samples they were fitted to."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flexscale.checks import DATASET, checked
from flexscale.datasets.kinds.tensor_model import RAY_AXES
from flexscale.plotting.selection import require_variables, subject
from flexscale.plotting.style import (
    MACRO_COLOR,
    PAGE_WIDTH,
    add_note,
    flexscale_style,
    new_figure,
    unit_text,
)
from flexscale.plotting.tensor_sweeps import draw_map, name_shapes

_NEEDED = ("energy_error", "held_out_error", *RAY_AXES)


@checked(model=DATASET)
def tensor_model(model: xr.Dataset) -> Figure:
    """Largest error of energies on each ray, and errors over the curvature.

    Parameters
    ----------
    model : dataset of kind tensor_model.

    Raises
    ------
    SchemaError : not a tensor model.
    """
    require_variables(model, _NEEDED, "A figure of a tensor model", "tensor_model")
    errors = 100.0 * np.abs(model["energy_error"].transpose(*RAY_AXES).values)
    largest = np.nanmax(np.where(np.isnan(errors), -np.inf, errors), axis=-1)
    largest = np.where(np.isfinite(largest), largest, np.nan)
    with flexscale_style():
        figure = new_figure(PAGE_WIDTH, 0.45 * PAGE_WIDTH)
        figure.suptitle(f"{subject(model)}: tensor model".lstrip(": "))
        left, right = figure.subplots(1, 2)
        draw_map(left, model, largest, "largest error of the energy on a ray [%]", logarithmic=True)
        name_shapes(left)
        _draw_over_curvature(right, model["curvature"].values, errors)
        notes = ["gray: not converged"] if np.isnan(largest).any() else []
        notes.append(_held_out(model))
        add_note(figure, [note for note in notes if note])
    return figure


def _draw_over_curvature(axes: Axes, curvature: np.ndarray, errors: np.ndarray) -> None:
    """Median and 95 % of all rays."""
    flat = errors.reshape(-1, len(curvature))
    known = np.isfinite(flat).any(axis=0)
    for share, style in ((0.5, "-"), (0.95, "--")):
        label = "median" if share == 0.5 else f"{100 * share:g} % of rays below"
        values = np.nanquantile(flat[:, known], share, axis=0)
        axes.plot(curvature[known], values, style, color=MACRO_COLOR, label=label)
    axes.set_xlabel(f"curvature [{unit_text('mm-1')}]")
    axes.set_ylabel("error of the energy [%]")
    axes.set_ylim(bottom=0.0)
    axes.legend()


def _held_out(model: xr.Dataset) -> str:
    errors = model["held_out_error"].sel(quantity="energy", statistic="percentile_95")
    told = [
        f"{float(errors.sel(regime=regime)) * 100:.1f} % {words}"
        for regime, words in (("before_contact", "before contact"), ("in_contact", "in contact"))
        if np.isfinite(errors.sel(regime=regime))
    ]
    return f"rays held out: 95 % of energies within {' and '.join(told)}" if told else ""

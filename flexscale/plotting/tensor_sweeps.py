"""Tensor sweeps: how much a sheet stiffens, and when scales meet, over direction and shape."""

from __future__ import annotations

from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MultipleLocator, NullLocator
from numpy.typing import ArrayLike

from flexscale.arrays import FloatArray
from flexscale.checks import DATASET, checked, number
from flexscale.datasets.kinds.tensor_sweep import unit_tensors
from flexscale.plotting.selection import pick_values, require_variables, subject
from flexscale.plotting.style import PAGE_WIDTH, add_note, flexscale_style, new_figure, unit_text

_NEEDED = ("energy_density", "tangent", "direction", "shape", "curvature", "in_plane")
_SAMPLE = ("direction", "shape", "curvature")
#: Shapes with a name, degree.
_NAMED = {
    -135.0: "opening dome",
    -90.0: "opening cylinder",
    -45.0: "saddle",
    0.0: "closing cylinder",
    45.0: "closing dome",
}
_MISSING = "#BBBBBB"


@checked(sweep=DATASET, curvature=number("mm-1", 0.0))
def tensor_sweep(sweep: xr.Dataset, curvature: float | None = None) -> Figure:
    """Energy over that of the flat sheet's stiffness, and curvature of first contact.

    Parameters
    ----------
    sweep : dataset of kind tensor_sweep.
    curvature : mm-1 at which energies are compared; None takes a sample at two thirds of the last.

    Raises
    ------
    BadInputError : a curvature that the sweep does not have.
    SchemaError : not a tensor sweep.
    """
    require_variables(sweep, _NEEDED, "A figure of a tensor sweep", "tensor_sweep")
    kappa = np.asarray(sweep["curvature"].values, dtype=float)
    if curvature is None:
        curvature = float(kappa[np.abs(kappa - 2.0 / 3.0 * kappa[-1]).argmin()])
    (index,) = pick_values(sweep["curvature"], curvature, n_default=1)
    ratio = secant_ratios(sweep)[..., index]
    unit = unit_text("mm-1")
    with flexscale_style():
        figure = new_figure(PAGE_WIDTH, 0.45 * PAGE_WIDTH)
        figure.suptitle(f"{subject(sweep)}: {sweep['in_plane'].item()} in its plane".lstrip(": "))
        left, right = figure.subplots(1, 2, sharey=True)
        title = f"energy / energy of the flat sheet's stiffness\nat {kappa[index]:g} {unit}"
        draw_map(left, sweep, ratio, title, logarithmic=True)
        notes = ["gray: not converged"] if np.isnan(ratio).any() else []
        if "contact_pairs" in sweep:
            onset = contact_onsets(sweep)
            draw_map(right, sweep, onset, f"curvature of first contact\n[{unit}]")
            if np.isnan(onset).any():
                notes.append(f"right, gray: no contact met up to {kappa[-1]:g} {unit}")
        else:
            right.set_axis_off()
        name_shapes(left)
        add_note(figure, notes)
    return figure


def secant_ratios(sweep: xr.Dataset) -> FloatArray:
    """(n_directions, n_shapes, n_curvatures) energies over 1/2 k C k; nan at curvature 0."""
    units = unit_tensors(sweep["direction"].values[:, None], sweep["shape"].values)
    k = units * [1.0, 1.0, 2.0]
    tangent = sweep["tangent"].transpose("component", "other_component").values
    stiffness = np.einsum("dsi,ij,dsj->ds", k, tangent, k)
    kappa = np.asarray(sweep["curvature"].values, dtype=float)
    energy = sweep["energy_density"].transpose(*_SAMPLE).values
    reference = 0.5 * stiffness[..., None] * kappa**2
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(reference > 0.0, energy / reference, np.nan)


def contact_onsets(sweep: xr.Dataset) -> FloatArray:
    """(n_directions, n_shapes) mm-1, middle of the step in which scales first touch; nan for
    none."""
    touches = sweep["contact_pairs"].transpose(*_SAMPLE).values > 0
    kappa = np.asarray(sweep["curvature"].values, dtype=float)
    first = touches.argmax(axis=-1)
    middle = 0.5 * (kappa[first] + kappa[np.maximum(first - 1, 0)])
    return np.where(touches.any(axis=-1), middle, np.nan)


def draw_map(
    axes: Axes, sweep: xr.Dataset, values: FloatArray, title: str, *, logarithmic: bool = False
) -> None:
    """Values (n_directions, n_shapes) as cells around their samples, on the axes of a sweep."""
    axes.set_title(title)
    axes.xaxis.set_major_locator(MultipleLocator(30.0))
    axes.set_xlabel("direction of the larger curvature [°]")
    axes.grid(False)
    axes.set_facecolor(_MISSING)
    known = values[np.isfinite(values)]
    if not known.size:
        return
    low, high = float(known.min()), float(known.max())
    if not high > low:
        low, high = 0.99 * low, 1.01 * high + 1e-12
    norm: Normalize = LogNorm(low, high) if logarithmic and low > 0.0 else Normalize(low, high)
    cells = axes.pcolormesh(
        _edges(sweep["direction"].values),
        _edges(sweep["shape"].values),
        np.ma.masked_invalid(values.T),
        norm=norm,
        cmap=mpl.colormaps["cividis"],
        rasterized=True,
    )
    _add_bar(axes, cells, logarithmic)


def _add_bar(axes: Axes, cells: Any, logarithmic: bool) -> None:
    bar = axes.figure.colorbar(cells, ax=axes)
    if logarithmic:
        bar.ax.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        bar.ax.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
        bar.ax.yaxis.set_minor_locator(NullLocator())


def _edges(values: ArrayLike) -> FloatArray:
    """(n + 1,) between samples, and as far beyond the first and the last."""
    samples = np.asarray(values, dtype=float)
    steps = np.diff(samples) if len(samples) > 1 else np.array([1.0])
    middles = 0.5 * (samples[1:] + samples[:-1])
    ends = samples[0] - 0.5 * steps[0], samples[-1] + 0.5 * steps[-1]
    return np.concatenate([[ends[0]], middles, [ends[1]]])


def name_shapes(axes: Axes) -> None:
    """Names of domes, cylinders and saddles on the axis of shapes."""
    low, high = axes.get_ylim()
    named = {place: name for place, name in _NAMED.items() if low <= place <= high}
    axes.set_yticks(list(named), [f"{name}\n{place:g}°" for place, name in named.items()])

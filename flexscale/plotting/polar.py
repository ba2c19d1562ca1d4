"""Polar plots: bending moment (paper's Figs. 7, 8) and small-curvature stiffness by direction."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, cast

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from flexscale.checks import DATASET, checked, text
from flexscale.errors import BadInputError
from flexscale.plotting.polar_axes import PolarCurve, common_radius, draw_polar_curves, polar_axes
from flexscale.plotting.selection import (
    pick_sides,
    pick_values,
    require_variables,
    subject,
    unconverged,
)
from flexscale.plotting.style import (
    COLUMN_WIDTH,
    MARKERS,
    SIDE_LINESTYLES,
    add_note,
    curvature_colors,
    flexscale_style,
    moment_label,
    new_figure,
    unit_text,
)

# With more directions than this, dots would merge into the line.
_MAX_DOTS = 24


@checked(sweep=DATASET)
def polar(
    sweep: xr.Dataset,
    side: str | Sequence[str] = "closing",
    curvatures: float | Sequence[float] | None = None,
) -> Figure:
    """Bending moment against bending direction, one curve per curvature.

    Parameters
    ----------
    sweep : dataset of kind sweep/1.
    side : "closing", "opening", or both; each side gets its own axes, with one common radius.
    curvatures : mm-1; None takes up to six, evenly spread.

    Returns
    -------
    Figure; save it with `save_figure` or its own `savefig`.

    Raises
    ------
    UnknownNameError, BadInputError : a side or curvature the sweep does not have.
    SchemaError : not a sweep.
    """
    require_variables(
        sweep, ["moment", "direction", "curvature", "side"], "A polar moment plot", "sweep"
    )
    sides = pick_sides(sweep, side)
    chosen = pick_values(sweep["curvature"], curvatures, n_default=6, skip_zero=True)
    with flexscale_style():
        figure = new_figure(COLUMN_WIDTH * (0.35 + 0.85 * len(sides)), COLUMN_WIDTH)
        notes: list[str] = []
        all_curves = [moment_curves(sweep, name, chosen) for name in sides]
        radius = common_radius([curve for curves in all_curves for curve in curves])
        for column, (name, curves) in enumerate(zip(sides, all_curves, strict=True)):
            axes = polar_axes(figure, (1, len(sides), column + 1))
            notes += draw_polar_curves(axes, curves, radius)
            axes.set_title(f"{subject(sweep)}, {name}\n{moment_label(sweep)}".lstrip(", "))
        handles, labels = figure.axes[0].get_legend_handles_labels()
        figure.legend(
            handles[::-1],
            labels[::-1],
            loc="outside right center",
            title=f"curvature\n[{unit_text(str(sweep['curvature'].attrs.get('units', 'mm-1')))}]",
            title_fontsize=7,
        )
        add_note(figure, list(dict.fromkeys(notes)))
    return figure


def stiffness(tangent: xr.Dataset | Sequence[xr.Dataset] | Mapping[str, xr.Dataset]) -> Figure:
    """Bending stiffness a of the flat sheet against direction, one curve per dataset.

    Parameters
    ----------
    tangent : dataset of kind tangent, several, or several by the label to give each.

    Returns
    -------
    Figure with one polar axes; the legend gives each curve's range in N mm.
    """
    datasets = _labelled(tangent)
    with flexscale_style():
        figure = new_figure(COLUMN_WIDTH * 1.25, COLUMN_WIDTH * 1.05)
        axes = polar_axes(figure, (1, 1, 1))
        colors = mpl.rcParams["axes.prop_cycle"].by_key()["color"]
        curves = []
        for index, (label, dataset) in enumerate(datasets.items()):
            require_variables(dataset, ["stiffness", "direction"], "A stiffness plot", "tangent")
            values = np.asarray(dataset["stiffness"].values, dtype=float)
            low, high = np.nanmin(values), np.nanmax(values)
            span = f"{low:.4g}" if np.isclose(low, high, rtol=5e-4) else f"{low:.4g} – {high:.4g}"
            curves.append(
                _curve(
                    dataset["direction"],
                    values,
                    failed=np.isnan(values),
                    dotted=_sparse(len(values)),
                    color=colors[index % len(colors)],
                    marker=MARKERS[index % len(MARKERS)],
                    label=f"{label}\n{span}",
                )
            )
        units = unit_text(str(next(iter(datasets.values()))["stiffness"].attrs.get("units", "")))
        notes = draw_polar_curves(axes, curves, common_radius(curves))
        axes.set_title(f"bending stiffness of the flat sheet [{units}]")
        figure.legend(loc="outside right center")
        add_note(figure, notes)
    return figure


def moment_curves(
    sweep: xr.Dataset, side: str, curvature_indices: Sequence[int] | np.ndarray
) -> list[PolarCurve]:
    """Curves of one side of a sweep, one per chosen curvature, colored by curvature.

    Parameters
    ----------
    sweep : dataset of kind sweep/1.
    side : "closing" or "opening".
    curvature_indices : (k,) positions along the curvature axis.
    """
    one_side = sweep.sel(side=side)
    moment = one_side["moment"].transpose("direction", "curvature").values
    failed = unconverged(sweep).sel(side=side).transpose("direction", "curvature").values
    directions = np.asarray(sweep["direction"].values, dtype=float)
    dotted = _sparse(len(directions))
    if "symmetry_source" in sweep:
        source = np.asarray(one_side["symmetry_source"].values, dtype=float)
        computed = np.isclose(source, directions, atol=1e-6)
        # A copied direction never carries a dot; with all computed, dots only if they fit.
        dotted = computed if not computed.all() and computed.sum() <= _MAX_DOTS else dotted
    curvatures = sweep["curvature"].values[curvature_indices]
    return [
        _curve(
            sweep["direction"],
            moment[:, index],
            failed=failed[:, index],
            dotted=dotted,
            color=color,
            linestyle=SIDE_LINESTYLES[side],
            label=f"{curvature:g}",
        )
        for index, curvature, color in zip(
            curvature_indices, curvatures, curvature_colors(curvatures), strict=True
        )
    ]


def _sparse(n_directions: int) -> np.ndarray:
    return np.full(n_directions, n_directions <= _MAX_DOTS)


def _curve(direction: xr.DataArray, values: np.ndarray, **look: Any) -> PolarCurve:
    directions = np.asarray(direction.values, dtype=float)
    if directions.ndim != 1 or len(directions) == 0:
        raise BadInputError("A polar plot needs at least one direction; this dataset has none.")
    return PolarCurve(directions=directions, values=np.asarray(values, dtype=float), **look)


def _labelled(
    tangent: xr.Dataset | Sequence[xr.Dataset] | Mapping[str, xr.Dataset],
) -> dict[str, xr.Dataset]:
    if isinstance(tangent, xr.Dataset):
        return {subject(tangent) or "a(θ)": tangent}
    labelled: dict[str, xr.Dataset] = {}
    if isinstance(tangent, Mapping):
        named = cast("Mapping[str, xr.Dataset]", tangent)
        labelled.update({text(k, "label"): DATASET(v, "tangent") for k, v in named.items()})
    else:
        several = tangent if isinstance(tangent, list | tuple) else [tangent]
        for index, dataset in enumerate(several):
            DATASET(dataset, "tangent")
            label = subject(dataset) or f"dataset {index + 1}"
            labelled[label if label not in labelled else f"{label} ({index + 1})"] = dataset
    if not labelled:
        raise BadInputError("A stiffness plot needs at least one tangent dataset; none was given.")
    return labelled

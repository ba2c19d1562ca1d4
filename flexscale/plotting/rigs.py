"""Scales and macro models on the testing devices (paper's Figs. 9 to 11): mandrel and stage."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.projections.polar import PolarAxes

from flexscale.checks import DATASET, checked
from flexscale.errors import SchemaError
from flexscale.plotting.polar_axes import polar_axes, set_radius
from flexscale.plotting.selection import pick_sides, require_variables, subject
from flexscale.plotting.side_curves import SIDE_MARKERS, draw_side_curves
from flexscale.plotting.style import (
    COLUMN_WIDTH,
    FAILED_COLOR,
    MACRO_COLOR,
    NATIVE_COLOR,
    PAGE_WIDTH,
    SIDE_LINESTYLES,
    add_note,
    axis_label,
    flexscale_style,
    new_figure,
)

_NATIVE, _MACRO = "scales on joints", "macro model"
_FAILED_NOTE = "× at the rim: not converged, left out of the curve"
_NEEDED = {
    "mandrel": ["mandrel_force", "mandrel_status", "angle", "side", "mandrel_indentation"],
    "stage": ["stage_force", "stage_status", "shortening", "side", "stage_direction"],
}


@checked(tests=DATASET)
def rig(tests: xr.Dataset, sides: str | Sequence[str] | None = None) -> Figure:
    """Forces on the testing devices: around the mandrel, and against the stage's shortening.

    Parameters
    ----------
    tests : dataset of kind rig, or native_rig; one panel for each of its devices.
    sides : "closing", "opening" or both; None takes all the dataset has.

    Raises
    ------
    SchemaError : not a rig.
    UnknownNameError : a side that was not tested.
    """
    devices = [device for device in _NEEDED if f"{device}_force" in tests]
    if not devices:
        raise SchemaError(
            "A figure of testing devices needs mandrel_force or stage_force, which this dataset "
            "does not have; give it a dataset of kind rig."
        )
    for device in devices:
        require_variables(tests, _NEEDED[device], f"A figure of the {device}", "rig")
    shown = pick_sides(tests, sides)
    with flexscale_style():
        figure = new_figure(COLUMN_WIDTH * (0.25 + 0.95 * len(devices)), COLUMN_WIDTH * 0.85)
        notes: list[str] = []
        for column, device in enumerate(devices):
            place = (1, len(devices), column + 1)
            head = f"{subject(tests)}, {device}".lstrip(", ")
            if device == "mandrel":
                disc = polar_axes(figure, place)
                notes += draw_mandrel(disc, tests, shown)
                depth = float(tests["mandrel_indentation"])
                label = axis_label(tests["mandrel_force"])
                disc.set_title(f"{head}, {depth:g} mm\n{label}")
            else:
                axes = figure.add_subplot(*place)
                force, status = tests["stage_force"], tests["stage_status"]
                color, _ = _color_and_model(tests)
                notes += draw_side_curves(axes, force, status, "shortening", shown, color)
                axes.set_title(f"{head}\nalong {float(tests['stage_direction']):g}°")
        handles, labels = figure.axes[0].get_legend_handles_labels()
        kept = [k for k, label in enumerate(labels) if not label.startswith("_")]
        figure.legend(
            [handles[k] for k in kept],
            [labels[k] for k in kept],
            title=_color_and_model(tests)[1],
            loc="outside right center",
        )
        add_note(figure, list(dict.fromkeys(notes)))
    return figure


def mandrels(tests: Sequence[tuple[xr.Dataset, xr.Dataset]], side: str, columns: int = 3) -> Figure:
    """Forces around the mandrel to one side, one panel a pattern.

    Parameters
    ----------
    tests : datasets of kinds native_rig and rig; the latter's curve is thin.

    Raises
    ------
    SchemaError : a dataset without the mandrel.
    """
    for dataset in itertools.chain(*tests):
        require_variables(dataset, _NEEDED["mandrel"], "A figure of the mandrel")
    rows = -(-len(tests) // columns)
    with flexscale_style():
        figure = new_figure(PAGE_WIDTH, 0.41 * PAGE_WIDTH * rows)
        notes: list[str] = []
        for k, (dataset, macro) in enumerate(tests):
            axes = polar_axes(figure, (rows, columns, k + 1))
            thin = macro["mandrel_force"].sel(side=side).values.astype(float)
            turn = np.radians(macro["angle"].values)
            axes.plot([*turn, turn[0]], [*thin, thin[0]], color=MACRO_COLOR, linewidth=0.7)
            largest = float(np.nanmax(thin, initial=0.0))
            notes += draw_mandrel(axes, dataset, pick_sides(dataset, side), largest)
            label = axis_label(dataset["mandrel_force"])
            axes.set_title(f"{subject(dataset)}, {side}\n{label}")
        looks = ((_NATIVE, NATIVE_COLOR, 1.4, "o"), (_MACRO, MACRO_COLOR, 0.7, ""))
        handles = [
            Line2D([], [], color=color, linewidth=width, marker=marker, markersize=2.5, label=label)
            for label, color, width, marker in looks
        ]
        figure.legend(handles=handles, loc="outside upper center", ncols=len(handles))
        add_note(figure, list(dict.fromkeys(notes)))
    return figure


def draw_mandrel(
    axes: PolarAxes, tests: xr.Dataset, sides: Sequence[str], least: float = 0.0
) -> list[str]:
    """Draw the force against the angle, all around, on a radius for `least` or more, N; returns
    notes for `add_note`."""
    angles = np.deg2rad(tests["angle"].values.astype(float))
    chosen = tests[["mandrel_force", "mandrel_status"]].sel(side=list(sides))
    chosen = chosen.transpose("side", "angle")  # whatever a caller did to them
    force, failed = chosen["mandrel_force"], chosen["mandrel_status"].values != 0
    values = np.where(failed, np.nan, force.values.astype(float))
    largest = float(np.nanmax(values, initial=least))
    radius = 1.06 * largest if largest > 0.0 else 1.0
    set_radius(axes, radius)
    ring, (color, _) = _closed(angles), _color_and_model(tests)
    for side, line, missing in zip(sides, values, failed, strict=True):
        axes.plot(
            np.append(angles, angles[:1]) if ring else angles,
            np.append(line, line[:1]) if ring else line,
            color=color,
            linestyle=SIDE_LINESTYLES[side],
            marker=SIDE_MARKERS[side],
            markerfacecolor="white" if side == "opening" else color,
            markersize=2.5,
            label=side,
        )
        if missing.any():  # an empty line that is not clipped has no extent to lay out
            axes.plot(
                angles[missing],
                np.full(int(missing.sum()), 0.985 * radius),
                linestyle="none",
                marker="x",
                markersize=4.0,
                color=FAILED_COLOR,
                clip_on=False,
                label="_unconverged",
            )
    return [_FAILED_NOTE] if failed.any() else []


def _color_and_model(tests: xr.Dataset) -> tuple[str, str]:
    """Color and name of the model that a dataset is of: scales are counted in those of scales."""
    if any(str(name).endswith("_n_scales") for name in tests.data_vars):
        return NATIVE_COLOR, _NATIVE
    return MACRO_COLOR, _MACRO


def _closed(angles: np.ndarray) -> bool:
    """Whether the angles go all around, so that the last is joined to the first."""
    if len(angles) < 3:
        return False
    rest = 2.0 * np.pi - angles[-1] + angles[0]
    return bool(rest < 1.5 * np.median(np.diff(angles)))

"""Polar axes of the house and the closed curves drawn in them.

0 degree points right and angles run counter-clockwise. A response has period 180 degree, since
bending about an axis does not know the axis's sense: samples on [0, 180) are drawn with thick
lines and repeated, thinner, on the other half. The radius starts at 0.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.projections.polar import PolarAxes
from matplotlib.ticker import MaxNLocator

MIRROR_NOTE = "thin: the same samples repeated at direction + 180°"
FAILED_NOTE = "× at the rim: sample not converged, left out of the curve"
COMPUTED_NOTE = "dots: computed directions; the rest follows from the pattern's symmetry"
NEGATIVE_NOTE = "negative values are not drawn: {}"

# Samples farther apart than this many usual spacings are not joined by a line.
_JOIN_SPACINGS = 1.5
_LABEL_DIRECTION = 285.0  # degree


@dataclass(frozen=True)
class PolarCurve:
    """One closed curve r(direction) with its look.

    directions : (n,) degree in [0, 180), increasing; values : (n,), NaN where unknown;
    failed : (n,) bool, samples that did not converge; dotted : (n,) bool, samples with a dot.
    """

    directions: np.ndarray
    values: np.ndarray
    failed: np.ndarray
    dotted: np.ndarray
    color: Any
    linestyle: Any = "-"
    marker: str = "o"
    label: str = ""


def polar_axes(figure: Figure, position: Any) -> PolarAxes:
    """Empty polar axes in the house convention, at a subplot position of the figure."""
    where = position if isinstance(position, tuple) else (position,)
    axes = figure.add_subplot(*where, projection="polar")
    assert isinstance(axes, PolarAxes)
    axes.set_theta_zero_location("E")
    axes.set_theta_direction(1)
    axes.set_thetagrids(np.arange(0, 360, 30))
    axes.tick_params(axis="x", pad=-1)
    return axes


def set_radius(axes: PolarAxes, radius: float) -> None:
    """Radius from 0 to `radius`, with a few labelled circles.

    The labels stand between two spokes, in the half that is only a repetition, and above the
    curves with a white rim: tick labels would be hidden by them.
    """
    axes.set_rlim(0.0, radius)
    ticks = MaxNLocator(nbins=4, steps=[1, 2, 2.5, 5, 10]).tick_values(0.0, radius)
    ticks = [tick for tick in ticks if 0.0 < tick <= 0.97 * radius]
    axes.set_rgrids(ticks, labels=[""] * len(ticks))
    rim = [withStroke(linewidth=2.0, foreground="white")]
    for tick in ticks:
        axes.text(
            np.deg2rad(_LABEL_DIRECTION),
            tick,
            f"{tick:g}",
            size=6,
            ha="center",
            va="center",
            zorder=4,
            path_effects=rim,
        )


def common_radius(curves: Sequence[PolarCurve]) -> float:
    """Radius that holds all curves with a little air; 1 when there is nothing to draw."""
    finite = [curve.values[np.isfinite(curve.values)] for curve in curves]
    largest = max((float(np.max(values)) for values in finite if values.size), default=0.0)
    return 1.06 * largest if largest > 0.0 else 1.0


def draw_polar_curves(axes: PolarAxes, curves: Sequence[PolarCurve], radius: float) -> list[str]:
    """Draw curves and their mirrored halves into polar axes; radius from 0 to `radius`.

    Returns
    -------
    Notes for `add_note`: how the picture is to be read and what is missing in it.
    """
    set_radius(axes, radius)
    notes = [MIRROR_NOTE]
    n_negative = 0
    for rank, curve in enumerate(curves):
        negative = curve.values < 0.0
        n_negative += int(negative.sum())
        shown = replace(curve, values=np.where(negative, np.nan, curve.values))
        _draw_halves(axes, shown)
        if curve.failed.any():
            # Inner curves' crosses step inward, so that one direction can show several.
            _draw_crosses(axes, shown, radius * (0.985 - 0.045 * (len(curves) - 1 - rank)))
            notes.append(FAILED_NOTE)
    if any(curve.dotted.any() and not curve.dotted.all() for curve in curves):
        notes.append(COMPUTED_NOTE)
    if n_negative:
        notes.append(NEGATIVE_NOTE.format(f"{n_negative} samples"))
    return list(dict.fromkeys(notes))


def _draw_halves(axes: PolarAxes, curve: PolarCurve) -> None:
    directions, values = _with_breaks(curve.directions, curve.values)
    seam = _seam(curve.directions, curve.values)
    look = {"color": curve.color, "linestyle": curve.linestyle}
    for turn, width, label in ((0.0, 1.4, curve.label), (180.0, 0.6, "_mirrored")):
        # The seam joins the last sample before 180 to the first one of the next half.
        angles = np.concatenate([directions, seam[0]]) + turn
        radii = np.concatenate([values, seam[1]])
        axes.plot(np.deg2rad(angles), radii, linewidth=width, label=label, **look)
        shown = np.where(curve.dotted | _isolated(curve.values), curve.values, np.nan)
        axes.plot(
            np.deg2rad(curve.directions + turn),
            shown,
            linestyle="none",
            marker=curve.marker,
            markersize=2.2 if turn == 0.0 else 1.1,
            color=curve.color,
            label="_samples",
        )


def _draw_crosses(axes: PolarAxes, curve: PolarCurve, radius: float) -> None:
    at = np.deg2rad(curve.directions[curve.failed])
    for turn, size, width in ((0.0, 4.0, 1.0), (np.pi, 2.5, 0.6)):
        axes.plot(
            at + turn,
            np.full(len(at), radius),
            linestyle="none",
            marker="x",
            markersize=size,
            markeredgewidth=width,
            color=curve.color,
            clip_on=False,
            label="_unconverged",
        )


def _isolated(values: np.ndarray) -> np.ndarray:
    """Samples between two unknown neighbors (cyclic): without a dot they would be invisible."""
    unknown = np.isnan(values)
    return ~unknown & np.roll(unknown, 1) & np.roll(unknown, -1)


def _with_breaks(directions: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Insert NaN where neighbors are too far apart to be joined by a line."""
    gaps = np.diff(directions) > _longest_join(directions)
    where = np.flatnonzero(gaps) + 1
    return np.insert(directions, where, np.nan), np.insert(values, where, np.nan)


def _seam(directions: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The piece from the last sample to the first of the next half turn, if close enough."""
    first = directions[0] + 180.0
    if first - directions[-1] > _longest_join(directions):
        return np.array([]), np.array([])
    return np.array([first]), values[:1]


def _longest_join(directions: np.ndarray) -> float:
    """Longest step (degree) bridged by a line; beyond it nothing is known about the response."""
    if len(directions) < 3:
        return 0.0
    return float(_JOIN_SPACINGS * np.median(np.diff(directions)))

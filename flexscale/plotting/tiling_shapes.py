"""Tiles as filled polygons: one color for each aspect, stripes on mirror images.

The colors are those of Okabe and Ito, which most color-blind eyes can tell apart, in an order that
alternates light and dark. Stripes tell mirror images from turned ones. With more than seven aspects
a turned and a mirrored one share a color.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb

from flexscale.arrays import FloatArray
from flexscale.plotting.style import Color

ASPECT_COLORS = ("#56B4E9", "#E69F00", "#009E73", "#F0E442", "#0072B2", "#CC79A7", "#D55E00")
OUTLINE_COLOR = "#222222"
_PALE = 0.6  # lattice images are mixed with this share of white
_STRIPES = "////"


@dataclass(frozen=True)
class AspectLook:
    """How the tiles of one aspect are filled."""

    color: Color
    striped: bool


def aspect_looks(mirrored: Sequence[bool]) -> list[AspectLook]:
    """Looks of aspects, no two the same.

    Parameters
    ----------
    mirrored : for each aspect whether it is a mirror image; at most seven of either hand.
    """
    together = len(mirrored) <= len(ASPECT_COLORS)
    looks = []
    for number, striped in enumerate(mirrored):
        before = number if together else mirrored[:number].count(striped)
        looks.append(AspectLook(to_rgb(ASPECT_COLORS[before]), striped))
    return looks


def draw_tiles(
    axes: Axes,
    polygons: Sequence[FloatArray],
    look: AspectLook,
    *,
    pale: bool = False,
    linewidth: float = 0.5,
) -> None:
    """Filled polygons (n_i, 2) of one aspect; `pale` for those outside of the home cell."""
    share = _PALE if pale else 0.0
    color = tuple((1.0 - share) * channel + share for channel in look.color)
    axes.add_collection(
        PolyCollection(
            list(polygons), facecolors=[color], edgecolors=OUTLINE_COLOR, linewidths=linewidth
        )
    )
    if look.striped:
        # The stripes take the color of an outline: a second one, without width.
        stripe = (1.0, 1.0, 1.0, 0.75)
        axes.add_collection(
            PolyCollection(
                list(polygons),
                facecolors="none",
                edgecolors=[stripe],
                linewidths=0.0,
                hatch=_STRIPES,
            )
        )


def tiles_in_window(
    tile: FloatArray, lattice: FloatArray, window: tuple[float, float, float, float]
) -> list[FloatArray]:
    """Lattice images of a tile whose bounding boxes meet a window (left, right, bottom, top)."""
    left, right, bottom, top = window
    low, high = tile.min(axis=0), tile.max(axis=0)
    # Shifts d with low + d below the window's upper corner and high + d above the lower one.
    least, most = np.array([left, bottom]) - high, np.array([right, top]) - low
    corners = np.array([(x, y) for x in (least[0], most[0]) for y in (least[1], most[1])])
    steps = corners @ np.linalg.inv(lattice)
    ranges = [
        np.arange(np.floor(a), np.ceil(b) + 1.0)
        for a, b in zip(steps.min(axis=0), steps.max(axis=0), strict=True)
    ]
    shifts = np.stack(np.meshgrid(*ranges, indexing="ij"), axis=-1).reshape(-1, 2) @ lattice
    inside = np.all((shifts >= least) & (shifts <= most), axis=1)
    return [tile + shift for shift in shifts[inside]]

"""Preview of a printable sheet: plan, oblique view, and a section through the grooves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.path import Path

from flexscale.plotting.raster import Surfaces, View, render
from flexscale.plotting.style import (
    NOTE_COLOR,
    PAGE_WIDTH,
    SCALE_COLOR,
    SUBSTRATE_COLOR,
    Color,
    flexscale_style,
    new_figure,
)

Rings = Sequence[np.ndarray]  # outlines (n_i, 2) of an area, mm: outer ones turn left, holes right

_VIEW = View(azimuth=-62.0, elevation=38.0)
_OBLIQUE_PIXELS = 640  # across the picture
_INK = "#222222"


@dataclass(frozen=True, eq=False)
class PrintableBody:
    """Surface of one material: vertices (n, 3) mm, faces (m, 3) corners, color in 0..1."""

    vertices: np.ndarray
    faces: np.ndarray
    color: Color


@dataclass(frozen=True, eq=False)
class PrintablePicture:
    """What a preview shows; lengths in mm.

    Attributes
    ----------
    headings : lines of the title.
    remarks : lines under the picture.
    sheet, bars : outlines of the substrate, and of the hinge bars.
    whole, cut, grooves : outlines of the scales with the simulated shape, of pieces, of grooves.
    bodies : surfaces for the oblique view.
    section_y : where the section is cut.
    section : outlines (x, z) of the cut: of the substrate, and of the scales.
    window : (left, right) x of what the section shows.
    """

    headings: tuple[str, ...]
    remarks: tuple[str, ...]
    sheet: Rings
    bars: Rings
    whole: Sequence[Rings]
    cut: Sequence[Rings]
    grooves: Sequence[Rings]
    bodies: tuple[PrintableBody, ...]
    section_y: float
    section: tuple[Rings, Rings]
    window: tuple[float, float]


def printable(picture: PrintablePicture) -> Figure:
    """Plan and oblique view beside each other, the section below."""
    oblique, extent = _oblique_image(picture.bodies)
    with flexscale_style():
        width, depth = np.ptp(np.concatenate(picture.sheet), axis=0)
        plan_height = 0.8 + 0.38 * PAGE_WIDTH * float(depth / width)
        figure = new_figure(PAGE_WIDTH, plan_height + 2.4)
        grid = figure.add_gridspec(2, 2, height_ratios=(plan_height, 1.4))
        _draw_plan(figure.add_subplot(grid[0, 0]), picture)
        above = figure.add_subplot(grid[0, 1])
        above.imshow(oblique, extent=extent, interpolation="antialiased")
        above.set_aspect("equal")
        above.set_axis_off()
        _draw_section(figure.add_subplot(grid[1, :]), picture)
        figure.suptitle("\n".join(picture.headings), size=8)
        figure.legend(
            handles=[
                Patch(facecolor=SCALE_COLOR, edgecolor=_INK, label="scale, as simulated"),
                Patch(facecolor=_paler(SCALE_COLOR), edgecolor=_INK, label="cut at the border"),
                Patch(facecolor=SUBSTRATE_COLOR, edgecolor=_INK, label="substrate"),
            ],
            loc="outside lower center",
            ncols=3,
            title="\n".join(picture.remarks),
            title_fontproperties={"size": 6},
        ).get_title().set(color=NOTE_COLOR, multialignment="center")
    return figure


def _draw_plan(axes: Axes, picture: PrintablePicture) -> None:
    _fill(axes, [picture.sheet], SUBSTRATE_COLOR)
    _fill(axes, picture.whole, SCALE_COLOR)
    _fill(axes, picture.cut, _paler(SCALE_COLOR))
    _fill(axes, [[ring] for ring in picture.bars], SCALE_COLOR)
    _fill(axes, picture.grooves, (0.0, 0.0, 0.0, 0.12), linewidth=0.0)
    for x in picture.window:
        axes.plot([x], [picture.section_y], marker="|", color=_INK, markersize=6)
    axes.plot(picture.window, [picture.section_y] * 2, color=_INK, linewidth=0.8, dashes=(6, 2))
    axes.set(xlabel="x [mm]", ylabel="y [mm]", title="plan; grooves darker, section dashed")
    axes.set_aspect("equal")
    axes.autoscale_view()
    axes.grid(False)


def _draw_section(axes: Axes, picture: PrintablePicture) -> None:
    for rings, color in zip(picture.section, (SUBSTRATE_COLOR, SCALE_COLOR), strict=True):
        _fill(axes, [rings], color)
    heights = np.concatenate([ring[:, 1] for rings in picture.section for ring in rings])
    axes.set(
        xlim=picture.window,
        ylim=(-0.3, float(heights.max()) + 0.3),
        xlabel="x [mm]",
        ylabel="z [mm]",
        title=f"section at y = {picture.section_y:.2f} mm, through the grooves",
    )
    axes.set_aspect("equal")
    axes.grid(False)


def _fill(
    axes: Axes, areas: Sequence[Rings], color: str | tuple[float, ...], linewidth: float = 0.3
) -> None:
    """Filled areas; the holes of each stay open."""
    paths = [
        Path.make_compound_path(*(Path(ring, closed=False) for ring in _closed(rings)))
        for rings in areas
        if rings
    ]
    if paths:
        axes.add_collection(
            PathCollection(paths, facecolors=[color], edgecolors=_INK, linewidths=linewidth)
        )


def _closed(rings: Rings) -> list[np.ndarray]:
    return [np.vstack([ring, ring[:1]]) for ring in rings]


def _oblique_image(
    bodies: Sequence[PrintableBody],
) -> tuple[np.ndarray, tuple[float, float, float, float]]:
    """Shaded picture, and its window (left, right, bottom, top) in mm of the view."""
    corners = [_VIEW.project(body.vertices.astype(float))[body.faces] for body in bodies]
    counts = [len(body.faces) for body in bodies]
    surfaces = Surfaces(
        np.concatenate(corners),
        np.repeat([body.color for body in bodies], counts, axis=0),
        np.repeat(np.arange(len(bodies)), counts),
        np.ones(sum(counts), dtype=bool),
    )
    flat = surfaces.corners[..., :2].reshape(-1, 2)
    low, high = flat.min(axis=0) - 1.0, flat.max(axis=0) + 1.0
    window = (float(low[0]), float(high[0]), float(low[1]), float(high[1]))
    return render(surfaces, window, _OBLIQUE_PIXELS / (window[1] - window[0])), window


def _paler(color: str) -> Color:
    red, green, blue = (int(color[k : k + 2], 16) / 255.0 for k in (1, 3, 5))
    return tuple(0.5 + 0.5 * channel for channel in (red, green, blue))  # type: ignore[return-value]

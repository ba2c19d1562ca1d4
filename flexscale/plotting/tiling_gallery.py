"""Many tilings in one figure, each as a small square window of the plane."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flexscale.arrays import FloatArray
from flexscale.plotting.style import add_note, flexscale_style, new_figure
from flexscale.plotting.tiling_shapes import aspect_looks, draw_tiles, tiles_in_window

_PANEL = (0.86, 1.02)  # inch, with its title
_LINE = 0.12  # inch, of a title, beyond the first
_REMARKS = 0.45  # inch
_HALF_WINDOW = 2.1  # roots of the tile's area


@dataclass(frozen=True, eq=False)
class GalleryPanel:
    """One tiling of the gallery, with tiles of area 1.

    Attributes
    ----------
    title : above the panel.
    tiles : (n_i, 2) polygons, one of each aspect.
    mirrored : for each of them whether it is a mirror image of the first.
    lattice : (2, 2) rows.
    """

    title: str
    tiles: tuple[FloatArray, ...]
    mirrored: tuple[bool, ...]
    lattice: FloatArray


def gallery(
    panels: Sequence[GalleryPanel], remarks: Sequence[str] = (), n_columns: int = 12
) -> Figure:
    """Panels side by side, all at one scale, with lines of remarks under them."""
    n_rows = -(-len(panels) // n_columns)
    n_lines = max(panel.title.count("\n") for panel in panels) if panels else 0
    with flexscale_style():
        height = n_rows * (_PANEL[1] + _LINE * n_lines) + _REMARKS
        figure = new_figure(n_columns * _PANEL[0], height)
        engine = figure.get_layout_engine()
        if engine is not None:
            engine.set(w_pad=0.02, h_pad=0.02, wspace=0.03, hspace=0.03)  # type: ignore[call-arg]
        for number, panel in enumerate(panels):
            _draw_panel(figure.add_subplot(n_rows, n_columns, number + 1), panel)
        add_note(figure, remarks)
    return figure


def _draw_panel(axes: Axes, panel: GalleryPanel) -> None:
    window = (-_HALF_WINDOW, _HALF_WINDOW, -_HALF_WINDOW, _HALF_WINDOW)
    for tile, look in zip(panel.tiles, aspect_looks(panel.mirrored), strict=True):
        images = tiles_in_window(tile, panel.lattice, window)
        draw_tiles(axes, images, look, linewidth=0.4)
    axes.set(xlim=window[:2], ylim=window[2:], xticks=[], yticks=[])
    axes.set_aspect("equal")
    axes.set_title(panel.title, pad=2.0)
    for spine in axes.spines.values():
        spine.set_visible(False)

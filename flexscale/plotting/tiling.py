"""Picture of one tiling: a patch of tiles with the cell, and one tile with its edge classes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from flexscale.arrays import FloatArray
from flexscale.errors import BadInputError
from flexscale.plotting.cell_geometry import cell_offsets
from flexscale.plotting.style import NOTE_COLOR, PAGE_WIDTH, flexscale_style, new_figure
from flexscale.plotting.tiling_edges import TileEdge, draw_edges, kind_handles
from flexscale.plotting.tiling_shapes import AspectLook, aspect_looks, draw_tiles

_HEIGHT = 4.3  # inch
_PATCH_SHARE = (1.5, 1.0)  # widths of the two panels
_BEYOND = 0.25  # roots of the tile's area, from the tip of a lattice vector to its name
_UNIT = "root of the tile's area"


@dataclass(frozen=True, eq=False)
class TilingPicture:
    """What a picture of a tiling shows; lengths in roots of the tile's area.

    Attributes
    ----------
    headings : lines of the title.
    edges : of the tile, counterclockwise from vertex 0.
    tiles : (n_i, 2) polygons, one of each aspect; none where the outline is no tile.
    mirrored : for each of them whether it is a mirror image of the first.
    lattice : (2, 2) rows t1, t2.
    crossings : (n, 2) points where the outline meets itself.
    remarks : lines under the picture.
    """

    headings: tuple[str, ...]
    edges: tuple[TileEdge, ...]
    tiles: tuple[FloatArray, ...] = ()
    mirrored: tuple[bool, ...] = ()
    lattice: FloatArray = field(default_factory=lambda: np.eye(2))
    crossings: FloatArray = field(default_factory=lambda: np.empty((0, 2)))
    remarks: tuple[str, ...] = ()


def tiling(picture: TilingPicture, n_cells: int | None = None) -> Figure:
    """Patch of the tiling beside one tile; the tile alone where it is none.

    Parameters
    ----------
    picture : what to show.
    n_cells : cells along each lattice vector; 5 with a single aspect, else 3, if not given.

    Raises
    ------
    BadInputError : `n_cells` below 1.
    """
    if n_cells is None:
        n_cells = 5 if len(picture.tiles) == 1 else 3
    if n_cells < 1:
        raise BadInputError(f"Cannot draw {n_cells} cells: give at least 1.")
    looks = aspect_looks(picture.mirrored or (False,))
    with flexscale_style():
        figure = new_figure(PAGE_WIDTH, _HEIGHT)
        if picture.tiles:
            grid = figure.add_gridspec(1, 2, width_ratios=_PATCH_SHARE)
            patch, single = figure.add_subplot(grid[0]), figure.add_subplot(grid[1])
            _draw_patch(patch, picture, looks, cell_offsets(n_cells))
        else:
            single = figure.add_subplot()
        draw_edges(single, picture.edges, picture.crossings, looks[0])
        for axes in figure.axes:
            axes.grid(False)
            axes.set(xlabel=f"x [{_UNIT}]", ylabel=f"y [{_UNIT}]")
        figure.suptitle("\n".join(picture.headings), size=8)
        figure.legend(
            handles=kind_handles(picture.edges),
            loc="outside lower center",
            ncols=5,
            title="\n".join(picture.remarks),
            title_fontproperties={"size": 6},
        ).get_title().set(color=NOTE_COLOR, multialignment="center")
    return figure


def cell_corner(vertices: FloatArray, lattice: FloatArray, middle: FloatArray) -> FloatArray:
    """Lattice image of a vertex at which a cell begins whose center is nearest to a point.

    Parameters
    ----------
    vertices : (n, 2) vertices of the tile.
    lattice : (2, 2) rows.
    middle : (2,) where the center of the cell should be.
    """
    wanted = middle - 0.5 * lattice.sum(axis=0)
    steps = np.rint((wanted - vertices) @ np.linalg.inv(lattice))
    corners = vertices + steps @ lattice
    nearest = np.argmin(np.linalg.norm(corners - wanted, axis=1))
    return np.asarray(corners[nearest])


def _draw_patch(
    axes: Axes, picture: TilingPicture, looks: Sequence[AspectLook], offsets: FloatArray
) -> None:
    lattice = picture.lattice
    shifts = [offset @ lattice for offset in offsets if np.any(offset)]
    for tile, look in zip(picture.tiles, looks, strict=True):
        if shifts:
            draw_tiles(axes, [tile + shift for shift in shifts], look, pale=True)
    for number, (tile, look) in enumerate(zip(picture.tiles, looks, strict=True)):
        draw_tiles(axes, [tile], look, linewidth=0.9)
        _label(axes, _centroid(tile), str(number))
    vertices = np.array([edge.points[0] for edge in picture.edges])
    middle = np.mean([_centroid(tile) for tile in picture.tiles], axis=0)
    _draw_cell(axes, cell_corner(vertices, lattice, middle), lattice)
    axes.set_aspect("equal")
    axes.autoscale_view()


def _draw_cell(axes: Axes, corner: FloatArray, lattice: FloatArray) -> None:
    first, second = lattice
    around = np.array([corner, corner + first, corner + first + second, corner + second, corner])
    halo = [withStroke(linewidth=3.0, foreground="white")]
    axes.plot(*around.T, color="black", linewidth=1.3, path_effects=halo, zorder=5)
    for name, vector in (("t1", first), ("t2", second)):
        tip = corner + vector
        axes.annotate(
            "",
            tuple(tip),
            tuple(corner),
            arrowprops={"arrowstyle": "-|>", "color": "black", "shrinkA": 0, "shrinkB": 0},
            zorder=5,
        )
        _label(axes, tip + _BEYOND * vector / np.linalg.norm(vector), name)


def _label(axes: Axes, place: FloatArray, text: str) -> None:
    halo = [withStroke(linewidth=2.0, foreground="white")]
    axes.text(
        place[0], place[1], text, size=7, ha="center", va="center", path_effects=halo, zorder=6
    )


def _centroid(polygon: FloatArray) -> FloatArray:
    following = np.roll(polygon, -1, axis=0)
    cross = polygon[:, 0] * following[:, 1] - following[:, 0] * polygon[:, 1]
    return np.asarray(cross @ (polygon + following) / (3.0 * cross.sum()))

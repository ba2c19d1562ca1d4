"""Meshes of a cell: scales, substrate, and how the one conforms to the other (Fig. 2)."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from flexscale.plotting.cell_geometry import PATTERN_VARIABLES, cell_offsets
from flexscale.plotting.raster import View
from flexscale.plotting.selection import require_variables, subject
from flexscale.plotting.style import (
    PAGE_WIDTH,
    SCALE_COLOR,
    SUBSTRATE_COLOR,
    add_note,
    flexscale_style,
    new_figure,
)

_NEEDED = (*PATTERN_VARIABLES, "scale_positions", "tets", "base_triangles", "tile_points")
_DETAIL = 0.16  # width of the detail relative to that of the cell


def meshes(cell: xr.Dataset) -> Figure:
    """Scales of one cell (left), its substrate (middle), and both where scales meet (right).

    Parameters
    ----------
    cell : dataset of kind cell with tile polygons.

    Returns
    -------
    Figure; substrate triangles under scales are orange, those of the gap blue.

    Raises
    ------
    SchemaError : not a cell with its meshes.
    """
    require_variables(cell, _NEEDED, "A picture of the meshes")
    corners = substrate_corners(cell)
    size = float(np.ptp(corners.reshape(-1, 2), axis=0).max())
    with flexscale_style():
        figure = new_figure(PAGE_WIDTH, PAGE_WIDTH / 3 * 1.12)
        left, middle, right = (figure.add_subplot(1, 3, place) for place in (1, 2, 3))
        _draw_solid(left, cell)
        left.set_title("scales")
        _draw_substrate(middle, cell, corners, 0.1)
        middle.set_title("substrate")
        reach, center = 0.5 * _DETAIL * size, _meeting_point(cell)
        for shift in cell_offsets(3) @ cell["lattice"].values:
            _draw_substrate(right, cell, corners + shift, 0.3)
            outline = list(base_outline(cell) + shift)
            right.add_collection(LineCollection(outline, colors="black", linewidths=1.4))
        right.set(
            xlim=(center[0] - reach, center[0] + reach), ylim=(center[1] - reach, center[1] + reach)
        )
        window = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]) * reach + center
        middle.plot(*window.T, color="black", linewidth=0.8)
        right.set_title("detail, edges of scales in black")
        figure.suptitle(subject(cell))
        counts = f"{cell.sizes['tet']} tetrahedra, {cell.sizes['triangle']} triangles"
        add_note(figure, [f"{counts}; orange: under scales"])
    return figure


def substrate_corners(cell: xr.Dataset) -> np.ndarray:
    """(n_triangles, 3, 2) mm, corners of the substrate's triangles, lattice offsets included."""
    corners = cell["positions"].values[cell["triangles"].values]
    return np.asarray(corners + cell["triangle_offsets"].values @ cell["lattice"].values)


def base_outline(cell: xr.Dataset) -> np.ndarray:
    """(n_edges, 2, 2) mm, edges around the bases of the scales."""
    triangles = cell["base_triangles"].values[:, :3]
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    _, first, count = np.unique(
        np.sort(edges, axis=1), axis=0, return_index=True, return_counts=True
    )
    return np.asarray(cell["scale_positions"].values[edges[first[count == 1]]][:, :, :2])


def conformity(cell: xr.Dataset) -> float:
    """Largest distance (mm) of a base outline's vertex from the nearest substrate vertex."""
    own = base_outline(cell).reshape(-1, 2)
    lattice = cell["lattice"].values
    steps = np.stack(np.meshgrid([-1, 0, 1], [-1, 0, 1]), axis=-1).reshape(-1, 2)
    everywhere = (cell["positions"].values[None] + (steps @ lattice)[:, None]).reshape(-1, 2)
    gaps = np.linalg.norm(own[:, None] - everywhere[None], axis=-1)
    return float(gaps.min(axis=1).max())


def _draw_substrate(axes: Axes, cell: xr.Dataset, corners: np.ndarray, linewidth: float) -> None:
    covered = cell["triangle_scale"].values >= 0
    colors = [SCALE_COLOR if under else SUBSTRATE_COLOR for under in covered]
    axes.add_collection(
        PolyCollection(
            list(corners), facecolors=colors, edgecolors="0.25", linewidths=linewidth, alpha=0.75
        )
    )
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.set_axis_off()


def _draw_solid(axes: Axes, cell: xr.Dataset) -> None:
    """Faces of the tetrahedra on the scales' surfaces, those turned to the viewer."""
    tets = cell["tets"].values[:, :4]
    sides = np.concatenate([tets[:, [0, 2, 1]], tets[:, [0, 1, 3]], tets[:, [1, 2, 3]]])
    sides = np.concatenate([sides, tets[:, [0, 3, 2]]])
    _, first, count = np.unique(
        np.sort(sides, axis=1), axis=0, return_index=True, return_counts=True
    )
    positions = View(-70.0, 38.0).project(cell["scale_positions"].values)
    faces = positions[sides[first[count == 1]]]
    normal = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    front = normal[:, 2] > 0.0
    faces, normal = faces[front], normal[front]
    order = np.argsort(faces[:, :, 2].mean(axis=1))
    light = 0.55 + 0.45 * np.clip(normal @ np.array([-0.42, 0.62, 0.66]), 0.0, 1.0)
    colors = np.clip(light[:, None] * np.array(to_rgb(SCALE_COLOR)), 0.0, 1.0)
    axes.add_collection(
        PolyCollection(
            list(faces[order][:, :, :2]),
            facecolors=colors[order],
            edgecolors="0.25",
            linewidths=0.08,
        )
    )
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.set_axis_off()


def _meeting_point(cell: xr.Dataset) -> np.ndarray:
    """(2,) mm: the corner of a tile that is nearest to the middle of the cell."""
    corners = cell["tile_points"].values
    middle = cell["positions"].values.mean(axis=0)
    return np.asarray(corners[int(np.argmin(np.linalg.norm(corners - middle, axis=1)))])

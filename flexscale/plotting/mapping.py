"""From curvilinear to world space: a flat cell, and one in equilibrium under the bend (Fig. 3).

The curvature map of the paper [Eqs. 2, 14] takes (q1, q2, w3), lengths along and across the bending
direction and height, to the cylinder of curvature kappa.
"""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from flexscale.arrays import FloatArray
from flexscale.plotting.cell_geometry import SHAPE_VARIABLES, cell_offsets, shape_surfaces
from flexscale.plotting.raster import View
from flexscale.plotting.scene import draw_panel, draw_ruler, half_window
from flexscale.plotting.selection import require_variables, subject
from flexscale.plotting.style import PAGE_WIDTH, add_note, flexscale_style, new_figure

_ROWS = ("planar start", "in equilibrium under the bend")
_COLUMNS = ("curvilinear space", "world space")


def bend_points(points: FloatArray, direction: float, curvature: float) -> FloatArray:
    """World positions of curvilinear points.

    Parameters
    ----------
    points : (n, 3) mm; direction : degree; curvature : mm-1, not 0, closing positive.
    """
    along, across = _frame(direction)
    turn = curvature * (points @ along)
    radius = 1.0 / curvature - points[:, 2]
    return np.asarray(
        np.outer(radius * np.sin(turn), along)
        + np.outer(points @ across, across)
        + np.outer(1.0 / curvature - radius * np.cos(turn), [0.0, 0.0, 1.0])
    )


def unbend_points(points: FloatArray, direction: float, curvature: float) -> FloatArray:
    """Curvilinear positions of world points: the inverse of `bend_points`, within half a turn."""
    along, across = _frame(direction)
    sign = np.sign(curvature)
    side, down = sign * (points @ along), sign * (1.0 / curvature - points[:, 2])
    height = 1.0 / curvature - sign * np.hypot(side, down)
    return np.asarray(
        np.outer(np.arctan2(side, down) / curvature, along)
        + np.outer(points @ across, across)
        + np.outer(height, [0.0, 0.0, 1.0])
    )


def mapping_states(shape: xr.Dataset, sample: int) -> list[xr.Dataset]:
    """Four shapes of one sample: planar start and equilibrium, each in curvilinear and world space.

    Parameters
    ----------
    shape : dataset of kind shape; sample : one with a curvature.

    Returns
    -------
    Datasets of kind shape with one sample, row by row of the figure.
    """
    one = shape.isel(sample=[sample]).drop_vars("contact_force", errors="ignore")
    bend = float(one["sample_direction"].values[0]), float(one["sample_curvature"].values[0])
    rest = one["points"].transpose("point", "space").values
    world = rest + one["displacement"].transpose("sample", "point", "space").values[0]
    planar = one.assign(stretch=one["stretch"].copy(data=[[1.0, 1.0, 0.0]]))
    return [
        _state(planar, rest, rest, 0.0),
        _state(planar, rest, bend_points(rest, *bend), bend[1]),
        _state(one, rest, unbend_points(world, *bend), 0.0),
        _state(one, rest, world, bend[1]),
    ]


def mapping(shape: xr.Dataset, sample: int = 0) -> Figure:
    """Planar start (top) and equilibrium (bottom), in curvilinear (left) and world space (right).

    Parameters
    ----------
    shape : dataset of kind shape; sample : position along its sample axis.

    Returns
    -------
    Figure of four pictures at one length scale.

    Raises
    ------
    SchemaError : not a shape.
    """
    require_variables(shape, SHAPE_VARIABLES, "A picture of the mapping")
    direction = float(shape["sample_direction"].values[sample])
    camera = View(direction - 78.0, 12.0)  # nearly along the cylinder's axis
    offsets = cell_offsets(3)
    panels = [shape_surfaces(state, 0, offsets, camera) for state in mapping_states(shape, sample)]
    half = half_window(panels)
    with flexscale_style():
        width = PAGE_WIDTH / 2
        figure = new_figure(PAGE_WIDTH, 2 * width * half[1] / half[0] + 0.9)
        for place, surfaces in enumerate(panels):
            axes = figure.add_subplot(2, 2, place + 1)
            draw_panel(axes, surfaces, half, width)
            row, column = divmod(place, 2)
            axes.set_title(f"{_ROWS[row]}, {_COLUMNS[column]}")
            if place == 0:
                draw_ruler(axes, camera, half)
        curvature = float(shape["sample_curvature"].values[sample])
        figure.suptitle(f"{subject(shape)}: curvature {curvature:g} mm⁻¹, direction {direction:g}°")
        add_note(figure, ["strong: one unit cell; pale: lattice images of it"])
    return figure


def scale_strain(shape: xr.Dataset, sample: int = 0) -> tuple[float, float]:
    """Root mean square strain of the scales: mapped from the planar start, and in equilibrium.

    Taken over the corners of the tetrahedra, weighted by volume: Frobenius norm of
    (FᵀF - 1)/2, dimensionless.
    """
    states = mapping_states(shape, sample)
    rest = shape["points"].transpose("point", "space").values
    tets = shape["tets"].values[:, :4]
    found = []
    for state in (states[1], states[3]):
        now = rest + state["displacement"].transpose("sample", "point", "space").values[0]
        before, after = (p[tets[:, 1:]] - p[tets[:, :1]] for p in (rest, now))
        gradient = np.linalg.solve(before, after)
        strain = 0.5 * (gradient @ gradient.transpose(0, 2, 1) - np.eye(3))
        volume = np.abs(np.linalg.det(before))
        squares = np.einsum("nij,nij->n", strain, strain)
        found.append(float(np.sqrt(volume @ squares / volume.sum())))
    return found[0], found[1]


def _state(
    shape: xr.Dataset, rest: FloatArray, positions: FloatArray, curvature: float
) -> xr.Dataset:
    moved = (("sample", "point", "space"), (positions - rest)[None])
    return shape.assign(displacement=moved).assign_coords(sample_curvature=("sample", [curvature]))


def _frame(direction: float) -> tuple[FloatArray, FloatArray]:
    """Unit vectors along and across the bending direction."""
    angle = np.deg2rad(direction)
    return (
        np.array([np.cos(angle), np.sin(angle), 0.0]),
        np.array([-np.sin(angle), np.cos(angle), 0.0]),
    )

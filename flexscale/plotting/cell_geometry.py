"""Triangles of the deformed cell, its lattice images and the flat pattern, ready to be drawn."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.colors import to_rgb

from flexscale.errors import BadInputError
from flexscale.plotting.raster import Surfaces, View
from flexscale.plotting.selection import require_variables
from flexscale.plotting.style import CONTACT_COLOR, SCALE_COLOR, SUBSTRATE_COLOR

SHAPE_VARIABLES = (
    "lattice",
    "stretch",
    "points",
    "displacement",
    "triangles",
    "surface_triangles",
    "surface_scale",
    "sample_direction",
    "sample_curvature",
)
PATTERN_VARIABLES = ("lattice", "positions", "triangles", "triangle_offsets", "triangle_scale")
_PALE = 0.45  # lattice images are mixed with this share of white


def lattice_motions(
    shifts: np.ndarray, direction: float, curvature: float
) -> tuple[np.ndarray, np.ndarray]:
    """Rigid motions that carry the bent cell to its lattice images.

    A shift d in curvilinear space, split into d1 along and d2 across the bending direction, turns
    the image of the curvature map [Eqs. 2, 14] about the cylinder's axis by curvature * d1 and
    moves it by d2 along the axis: with x(q1, q2, w3) = (sin(k q1)/k - w3 sin(k q1), q2,
    (1 - cos k q1)/k + w3 cos(k q1)), x(q + d) = R x(q) + t exactly.

    Parameters
    ----------
    shifts : (n, 2) mm, stretched lattice vectors F (m t1 + n t2) in pattern coordinates.
    direction : degree; curvature : mm-1, closing positive, 0 is an ordinary value.

    Returns
    -------
    rotations (n, 3, 3) and translations (n, 3) mm: image point = R @ point + t.
    """
    angle = np.deg2rad(direction)
    frame = np.eye(3)
    frame[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    along, across = (np.asarray(shifts, dtype=float) @ frame[:2, :2]).T
    turn = curvature * along
    rotation = np.zeros((len(along), 3, 3))
    rotation[:, 0, 0] = rotation[:, 2, 2] = np.cos(turn)
    rotation[:, 0, 2], rotation[:, 2, 0] = -np.sin(turn), np.sin(turn)
    rotation[:, 1, 1] = 1.0
    # numpy's sinc(x) is sin(pi x)/(pi x); (1 - cos t)/k = k d1^2/2 sinc^2(t/2).
    rise = 0.5 * curvature * (along * np.sinc(turn / (2.0 * np.pi))) ** 2
    translation = np.stack([along * np.sinc(turn / np.pi), across, rise], axis=1)
    return frame @ rotation @ frame.T, translation @ frame.T


def shape_surfaces(shape: xr.Dataset, sample: int, offsets: np.ndarray, camera: View) -> Surfaces:
    """All lattice images of one sample in view coordinates; none if it has no result.

    Faces of scales on which others press are marked.
    """
    displacement = shape["displacement"].transpose("sample", "point", "space").values[sample]
    points = shape["points"].transpose("point", "space").values + displacement
    sheet, solid_faces = shape["triangles"].values, shape["surface_triangles"].values
    triangles = np.concatenate([sheet, solid_faces])
    scale = np.concatenate([np.full(len(sheet), -1), shape["surface_scale"].values])
    if not np.all(np.isfinite(points)):
        triangles, scale = triangles[:0], scale[:0]
    xx, yy, xy = shape["stretch"].transpose("sample", "component").values[sample]
    shifts = offsets @ shape["lattice"].values @ np.array([[xx, xy], [xy, yy]])
    motions = lattice_motions(
        shifts,
        float(shape["sample_direction"].values[sample]),
        float(shape["sample_curvature"].values[sample]),
    )
    kind = (scale >= 0).astype(int)
    if "contact_force" in shape:
        pressed = shape["contact_force"].transpose("sample", "point").values[sample] > 0.0
        kind[(scale >= 0) & pressed[triangles].any(axis=1)] = 2
    palette = np.array([to_rgb(c) for c in (SUBSTRATE_COLOR, SCALE_COLOR, CONTACT_COLOR)])
    strong = palette[kind]
    corners, colors, bodies = [], [], []
    n_scales = int(scale.max(initial=-1)) + 1
    for image, (offset, turn, shift) in enumerate(zip(offsets, *motions, strict=True)):
        corners.append(camera.project(points @ turn.T + shift)[triangles])
        colors.append((1.0 - _PALE) * strong + _PALE if np.any(offset) else strong)
        bodies.append(np.where(scale >= 0, scale + image * n_scales, -1))
    solid = np.tile(scale >= 0, len(corners))
    return Surfaces(np.concatenate(corners), np.concatenate(colors), np.concatenate(bodies), solid)


def pattern_surfaces(cell_dataset: xr.Dataset, n_cells: int) -> Surfaces:
    """Flat substrate triangles of n_cells x n_cells cells, colored by what covers them.

    Parameters
    ----------
    cell_dataset : dataset of kind cell/1.
    n_cells : number of cells along each lattice vector.
    """
    require_variables(cell_dataset, PATTERN_VARIABLES, "A picture of the pattern")
    lattice = cell_dataset["lattice"].values
    offsets = cell_dataset["triangle_offsets"].values
    corners = cell_dataset["positions"].values[cell_dataset["triangles"].values]
    corners = corners + offsets @ lattice
    scale = cell_dataset["triangle_scale"].values
    colors = np.array([to_rgb(SUBSTRATE_COLOR), to_rgb(SCALE_COLOR)])[(scale >= 0).astype(int)]
    steps = cell_offsets(n_cells)
    shifted = (corners[None] + (steps @ lattice)[:, None, None, :]).reshape(-1, 3, 2)
    flat = np.concatenate([shifted, np.zeros((*shifted.shape[:2], 1))], axis=-1)
    bodies = np.zeros(len(flat), dtype=int)  # drawn in plain colors, without outlines
    return Surfaces(flat, np.tile(colors, (len(steps), 1)), bodies, bodies.astype(bool))


def cell_offsets(n_cells: int) -> np.ndarray:
    """(n_cells**2, 2) lattice offsets around the home cell, which is one of them."""
    if n_cells < 1:
        raise BadInputError(f"Cannot draw {n_cells} cells: n_cells must be at least 1.")
    steps = np.arange(n_cells) - (n_cells - 1) // 2
    return np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)

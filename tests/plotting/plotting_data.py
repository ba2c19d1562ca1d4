"""Synthetic labelled datasets for the plotting tests: closed forms with known symmetry."""

from __future__ import annotations

import numpy as np
import xarray as xr

COMPONENTS = ["xx", "yy", "xy"]


def two_regime_sweep(
    fold: int = 4,
    *,
    directions: np.ndarray | None = None,
    curvatures: np.ndarray | None = None,
    pattern: str = "square",
    family: str = "IH76",
) -> xr.Dataset:
    """Sweep of a two-regime law whose contact curvature has `fold`-fold symmetry.

    fold 2 gives an orthotropic sheet, 4 a tetragonal one, 6 a sheet that starts isotropic.
    """
    directions = np.arange(0.0, 180.0, 7.5) if directions is None else directions
    curvatures = np.linspace(0.0, 0.025, 11) if curvatures is None else curvatures
    angle = np.deg2rad(directions)[:, None]
    initial = 60.0 * (1.0 + (0.0 if fold == 6 else 0.4) * np.cos(fold * angle))
    onset = 0.010 * (1.0 + 0.25 * np.cos(fold * angle))
    kappa = curvatures[None, :]
    closing = initial * kappa + 240.0 * np.maximum(kappa - onset, 0.0)
    moment = np.stack([closing, initial * kappa * 0.9])
    energy = np.stack([np.asarray(initial * kappa**2 / 2.0)] * 2)
    energy[0] += 120.0 * np.maximum(kappa - onset, 0.0) ** 2
    dims = ("side", "direction", "curvature")
    return xr.Dataset(
        {
            "moment": (dims, moment, {"units": "N", "long_name": "bending moment per unit width"}),
            "energy_density": (dims, energy, {"units": "N mm-1", "long_name": "energy density"}),
            "status": (dims, np.zeros(moment.shape, dtype=np.int8), {"long_name": "status"}),
            "symmetry_source": (
                ("side", "direction"),
                np.broadcast_to(directions, (2, len(directions))).copy(),
                {"units": "degree", "long_name": "direction computed"},
            ),
        },
        coords={
            "side": ["closing", "opening"],
            "direction": ("direction", directions, {"units": "degree", "long_name": "direction"}),
            "curvature": ("curvature", curvatures, {"units": "mm-1", "long_name": "curvature"}),
            "family": family,
            "pattern": pattern,
        },
    )


def with_failures(sweep: xr.Dataset, failures: list[tuple[str, int, int]]) -> xr.Dataset:
    """Copy of a sweep in which (side, direction index, curvature index) did not converge."""
    broken = sweep.copy(deep=True)
    for side, direction, curvature in failures:
        row = {"side": ["closing", "opening"].index(side)}
        where = {**row, "direction": direction, "curvature": curvature}
        broken["status"][where] = 1
        for name in ("moment", "energy_density"):
            broken[name][where] = np.nan
    return broken


def tangent_dataset(matrix: np.ndarray, pattern: str, family: str = "custom") -> xr.Dataset:
    """Tangent stiffness dataset: a(θ) = kᵀ C k with k = (cos², sin², 2 sin cos)."""
    directions = np.arange(0.0, 180.0, 1.5)
    angle = np.deg2rad(directions)
    cos, sin = np.cos(angle), np.sin(angle)
    k = np.stack([cos**2, sin**2, 2.0 * sin * cos])
    return xr.Dataset(
        {
            "stiffness": (
                ("direction",),
                np.einsum("id,ij,jd->d", k, matrix, k),
                {"units": "N mm", "long_name": "bending stiffness per unit width"},
            )
        },
        coords={
            "direction": ("direction", directions, {"units": "degree", "long_name": "direction"}),
            "family": family,
            "pattern": pattern,
        },
    )


def prism_shape(
    n_corners: int,
    samples: list[tuple[float, float]],
    *,
    failed: tuple[int, ...] = (),
    pattern: str = "square",
) -> xr.Dataset:
    """Shape dataset of one rigid prism (4: square, 6: hexagon) per cell on a bent substrate.

    Parameters
    ----------
    samples : direction (degree) and signed curvature (mm-1) of each sample.
    failed : samples without a result.
    """
    lattice, corner = regular_tile(n_corners)
    n = n_corners
    base = np.column_stack([4.8 * corner, np.zeros(n)])
    top = base + np.array([0.0, 0.0, 4.0])
    sheet_points = np.column_stack([5.0 * corner, np.zeros(n)])
    rest = np.concatenate([base, top, sheet_points, np.zeros((1, 3))])
    around, fan = np.arange(n), np.arange(1, n - 1)
    after, first = (around + 1) % n, np.zeros(n - 2, dtype=int)
    surface = np.concatenate(
        [
            np.stack([around, after, after + n], 1),
            np.stack([around, after + n, around + n], 1),
            np.stack([first + n, fan + n, fan + n + 1], 1),
            np.stack([first, fan + 1, fan], 1),
        ]
    )
    sheet = 2 * n + np.stack([around, after, np.full(n, n)], 1)
    is_sheet = np.arange(len(rest)) >= 2 * n
    displacement = np.stack(
        [np.where(is_sheet[:, None], bend(rest, *sample) - rest, 0.0) for sample in samples]
    )
    displacement[list(failed)] = np.nan
    return xr.Dataset(
        {
            "lattice": (("lattice_vector", "plane"), lattice, {"units": "mm"}),
            "stretch": (("sample", "component"), np.tile([1.0, 1.0, 0.0], (len(samples), 1))),
            "points": (("point", "space"), rest, {"units": "mm"}),
            "displacement": (("sample", "point", "space"), displacement, {"units": "mm"}),
            "triangles": (("triangle", "corner"), sheet.astype(np.int32)),
            "surface_triangles": (("surface_triangle", "corner"), surface.astype(np.int32)),
            "surface_scale": (("surface_triangle",), np.zeros(len(surface), dtype=np.int32)),
        },
        coords={
            "sample_direction": ("sample", [s[0] for s in samples], {"units": "degree"}),
            "sample_curvature": ("sample", [s[1] for s in samples], {"units": "mm-1"}),
            "family": "custom",
            "pattern": pattern,
        },
    )


def bend(points: np.ndarray, direction: float, curvature: float) -> np.ndarray:
    """Curvature map of (n, 3) curvilinear points for a curvature that is not tiny."""
    if curvature == 0.0:
        return points.copy()
    angle = np.deg2rad(direction)
    along = np.array([np.cos(angle), np.sin(angle), 0.0])
    across = np.array([-np.sin(angle), np.cos(angle), 0.0])
    q1, q2, w3 = points @ along, points @ across, points[:, 2]
    radius = 1.0 / curvature - w3
    x1 = radius * np.sin(curvature * q1)
    x3 = 1.0 / curvature - radius * np.cos(curvature * q1)
    return np.asarray(np.outer(x1, along) + np.outer(q2, across) + np.outer(x3, [0.0, 0.0, 1.0]))


def regular_tile(n_corners: int) -> tuple[np.ndarray, np.ndarray]:
    """Lattice (2, 2) mm, rows t1, t2, and corners (n, 2) of the tile with apothem 1."""
    lattice = 10.0 * np.eye(2)
    if n_corners == 6:
        lattice = 10.0 * np.array([[1.0, 0.0], [0.5, np.sqrt(0.75)]])
    angle = (np.arange(n_corners) + 0.5) * 2.0 * np.pi / n_corners
    corner = np.column_stack([np.cos(angle), np.sin(angle)]) / np.cos(np.pi / n_corners)
    return lattice, corner


def flat_cell(n_corners: int) -> xr.Dataset:
    """Cell dataset of a regular square (4) or hexagon (6) with a 0.4 mm gap."""
    lattice, corner = regular_tile(n_corners)
    around, after = np.arange(n_corners), (np.arange(n_corners) + 1) % n_corners
    center = np.full(n_corners, 2 * n_corners)
    under = np.stack([around, after, center], 1)
    ring = np.concatenate(
        [
            np.stack([around + n_corners, after + n_corners, after], 1),
            np.stack([around + n_corners, after, around], 1),
        ]
    )
    triangles = np.concatenate([under, ring])
    scale = np.where(np.arange(len(triangles)) < n_corners, 0, -1)
    positions = np.concatenate([4.8 * corner, 5.0 * corner, np.zeros((1, 2))])
    return xr.Dataset(
        {
            "lattice": (("lattice_vector", "component"), lattice),
            "positions": (("vertex", "component"), positions),
            "triangles": (("triangle", "corner"), triangles),
            "triangle_offsets": (
                ("triangle", "corner", "lattice_vector"),
                np.zeros((len(triangles), 3, 2), dtype=int),
            ),
            "triangle_scale": (("triangle",), scale),
        }
    )

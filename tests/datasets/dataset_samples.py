"""Small valid datasets for the tests of flexscale.datasets."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from flexscale.datasets.build import build_dataset
from flexscale.datasets.identity import Recipe
from flexscale.datasets.kinds.cell import CELL
from flexscale.datasets.kinds.shape import SHAPE
from flexscale.datasets.kinds.sweep import build_sweep_dataset
from flexscale.status import SolveStatus

SCALARS = {"family": "IH20", "pattern": "hexagon", "gap": 0.4, "scale_height": 4.0}


def recipe(**parameters: Any) -> Recipe:
    return Recipe("sweep", 1, {"gap": 0.4, **parameters})


def sweep_arrays(shape: tuple[int, int, int], curvatures: np.ndarray) -> dict[str, Any]:
    """Arrays of a plausible sweep; energies are zero at curvature 0 and parts sum."""
    rng = np.random.default_rng(7)
    parts = {
        f"energy_density_{part}": rng.random(shape) * curvatures**2
        for part in ("membrane", "bending", "scales")
    }
    return {
        "energy_density": sum(parts.values()),
        **parts,
        "moment": rng.random(shape) * curvatures,
        "stretch": 1.0 + 0.01 * rng.random((*shape, 3)),
        "newton_iterations": np.full(shape, 3),
        "negative_eigenvalues": np.ones(shape, dtype=int),
        "residual_norm": rng.random(shape) * 1e-9,
        "mean_offset": rng.random(shape) * 1e-12,
        "status": np.zeros(shape, dtype=int),
    }


def sweep(*, failed: bool = False, factor: float = 1.0, **scalars: Any) -> xr.Dataset:
    """Sweep of 2 sides, directions 0, 45, 90 degree and curvatures 0 to 0.02 mm-1."""
    directions, curvatures = np.array([0.0, 45.0, 90.0]), np.array([0.0, 0.01, 0.02])
    arrays = sweep_arrays((2, 3, 3), curvatures)
    arrays["moment"] *= factor
    if failed:
        arrays["status"][0, 1, 2] = SolveStatus.stalled
    return build_sweep_dataset(
        ["closing", "opening"],
        directions,
        curvatures,
        arrays,
        scalars={**SCALARS, **scalars},
        config={"pattern": {"gap": 0.4}, "names": None},
    )


def cell(**scalars: Any) -> xr.Dataset:
    """Cell of two triangles on a torus with one tetrahedron; only sizes and types matter."""
    two, one = np.zeros((2, 3), dtype=int), np.zeros((1, 3), dtype=int)
    arrays = {
        "lattice": np.diag([10.0, 10.0]),
        "positions": np.zeros((1, 2)),
        "triangles": two,
        "triangle_offsets": np.zeros((2, 3, 2), dtype=int),
        "triangle_scale": [-1, 0],
        "vertex_scale": [-1],
        "vertex_kind": [0],
        "outline_tangent": np.zeros((1, 2)),
        "edges": np.zeros((3, 2), dtype=int),
        "edge_shift": [[1, 0], [0, 1], [1, 1]],
        "triangle_edges": [[0, 1, 2], [0, 1, 2]],
        "triangle_edge_offsets": np.zeros((2, 3, 2), dtype=int),
        "edge_scale": [-1, -1, -1],
        "scale_positions": np.vstack([np.zeros(3), np.eye(3)]),
        "tets": [[0, 1, 2, 3]],
        "tet_scale": [0],
        "base_triangles": one,
        "base_scale": [0],
        "surface_triangles": one,
        "surface_scale": [0],
        "n_scales": 1,
    }
    return build_dataset(CELL, arrays, scalars={**SCALARS, **scalars}, config={"across": 2})


def shape() -> xr.Dataset:
    """Two samples of one triangle and one tetrahedron."""
    arrays = {
        "sample_direction": [0.0, 45.0],
        "sample_curvature": [0.01, -0.01],
        "lattice": np.diag([10.0, 10.0]),
        "stretch": np.tile([1.0, 1.0, 0.0], (2, 1)),
        "points": np.vstack([np.zeros(3), np.eye(3)]),
        "displacement": np.ones((2, 4, 3)),
        "triangles": [[0, 1, 2]],
        "triangle_scale": [-1],
        "tets": [[0, 1, 2, 3]],
        "tet_scale": [0],
        "surface_triangles": [[0, 2, 1]],
        "surface_scale": [0],
    }
    return build_dataset(SHAPE, arrays, scalars=SCALARS, config={"samples": 2})

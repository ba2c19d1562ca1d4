"""Step `cell`: geometry and mesh of one periodic cell."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from flexscale.datasets.build import array_names, build_dataset
from flexscale.homogenize.labels import pattern_scalars
from flexscale.mesh.torus import build_mesh
from flexscale.steps.base import Resources
from flexscale.steps.catalog import CellParameters

if TYPE_CHECKING:
    import xarray as xr


def compute(
    parameters: CellParameters, inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind cell/1: the arrays of the `PeriodicMesh`, and the polygons it came from."""
    pattern, options = parameters.build_pattern(), parameters.build_mesh_options()
    mesh = build_mesh(pattern, options)
    mesh.validate()
    arrays: dict[str, Any] = {name: getattr(mesh, name) for name in array_names("cell")}
    arrays["tile_points"], arrays["tile_of_point"] = _joined(pattern.tiles)
    arrays["outline_points"], arrays["outline_of_point"] = _joined(pattern.outlines())
    return build_dataset(
        "cell",
        arrays,
        scalars=pattern_scalars(pattern, options),
        config=parameters.model_dump(mode="json"),
    )


def _joined(polygons: tuple[np.ndarray, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Points of all polygons (n, 2), and which polygon each belongs to (n,)."""
    counts = [len(polygon) for polygon in polygons]
    return np.concatenate(polygons), np.repeat(np.arange(len(polygons)), counts)

"""Step `cell`: geometry and mesh of one periodic cell."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from flexscale.errors import ConfigError
from flexscale.homogenize.native_model import NativeModel
from flexscale.mesh.estimate import require_moderate_mesh
from flexscale.patterns.pattern import Pattern
from flexscale.steps.step import Resources, Step, StepBlock, Task

if TYPE_CHECKING:
    import numpy as np
    import xarray as xr

    from flexscale.steps.experiment import Experiment


class CellBlock(StepBlock):
    """Geometry and mesh of one periodic cell: the pattern and the mesh say it all."""

    def refuse_in(self, experiment: Experiment) -> None:
        """A native model that has no mesh."""
        if experiment.model.input != "cell":
            raise ConfigError(
                f"The native model {experiment.native!r} has no mesh: leave `cell` out, or say "
                "native: shell."
            )

    def refuse_of(self, pattern: Pattern, native: NativeModel) -> None:
        """A mesh that is too large."""
        require_moderate_mesh(pattern, native.mesh)


def compute(
    task: Task[CellBlock], inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind cell: the arrays of the `PeriodicMesh`, and the polygons it came from."""
    from flexscale.datasets.build import array_names, build_dataset
    from flexscale.datasets.kinds.cell import CELL
    from flexscale.homogenize.labels import pattern_scalars
    from flexscale.mesh.torus import build_mesh

    mesh = build_mesh(task.pattern, task.native.mesh, task.native.solid_options)
    mesh.validate()
    arrays: dict[str, Any] = {name: getattr(mesh, name) for name in array_names(CELL)}
    arrays["tile_points"], arrays["tile_of_point"] = _joined(task.pattern.tiles)
    arrays["outline_points"], arrays["outline_of_point"] = _joined(task.pattern.outlines())
    scalars = pattern_scalars(task.pattern, task.native)
    return build_dataset(CELL, arrays, scalars=scalars, config=task.config)


def _joined(polygons: tuple[np.ndarray, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Points of all polygons (n, 2), and which polygon each belongs to (n,)."""
    import numpy as np

    counts = [len(polygon) for polygon in polygons]
    return np.concatenate(polygons), np.repeat(np.arange(len(polygons)), counts)


CELL = Step("cell", 1, CellBlock, "the mesh alone; {}", compute, implied=True)

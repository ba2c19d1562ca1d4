"""Step `shape`: deformed cells to look at."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from flexscale.homogenize.shape import solve_shapes
from flexscale.mechanics.contact_options import ContactOptions
from flexscale.solve.solver_options import SolverOptions
from flexscale.steps.base import Resources
from flexscale.steps.catalog import ShapeParameters

if TYPE_CHECKING:
    import xarray as xr


def compute(
    parameters: ShapeParameters, inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind shape/1; a state that did not converge has no displacement (nan)."""
    return solve_shapes(
        parameters.build_pattern(),
        [(sample.side, sample.direction, sample.curvature) for sample in parameters.samples],
        mesh=parameters.build_mesh_options(),
        solver=SolverOptions(**parameters.solver),
        contact=ContactOptions(**parameters.contact),
        substrate=parameters.build_substrate_options(),
        scales=parameters.build_scale_options(),
    )

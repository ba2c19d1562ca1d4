"""Step `native_rig`: a strip of whole and cut scales on the stage."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from flexscale.homogenize.native_stage_dataset import simulate_native_stage
from flexscale.mechanics.contact_options import ContactOptions
from flexscale.solve.solver_options import SolverOptions
from flexscale.steps.base import Resources
from flexscale.steps.catalog import NativeRigParameters

if TYPE_CHECKING:
    import xarray as xr


def compute(
    parameters: NativeRigParameters, inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind native_rig; values are nan where the strip did not converge."""
    return simulate_native_stage(
        parameters.build_pattern(),
        length=parameters.length,
        width=parameters.width,
        shortenings=parameters.shortenings,
        direction=parameters.direction,
        sides=parameters.sides,
        mesh=parameters.build_mesh_options(),
        contact=ContactOptions(**parameters.contact),
        substrate=parameters.build_substrate_options(),
        scales=parameters.build_scale_options(),
        solver=SolverOptions(**parameters.solver),
        checkpoint=resources.checkpoint,
        on_sample=resources.on_sample,
    )

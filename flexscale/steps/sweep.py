"""Step `sweep`: a pattern bent in many directions, to both sides, to many curvatures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from flexscale.homogenize.sweep import sweep
from flexscale.mechanics.contact_options import ContactOptions
from flexscale.solve.solver_options import SolverOptions
from flexscale.steps.base import Resources
from flexscale.steps.catalog import SweepParameters

if TYPE_CHECKING:
    import xarray as xr


def compute(
    parameters: SweepParameters, inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind sweep/1; samples that did not converge carry a status and no numbers."""
    return sweep(
        parameters.build_pattern(),
        parameters.directions,
        parameters.curvatures,
        sides=parameters.sides,
        mesh=parameters.build_mesh_options(),
        solver=SolverOptions(**parameters.solver),
        contact=ContactOptions(**parameters.contact),
        substrate=parameters.build_substrate_options(),
        scales=parameters.build_scale_options(),
        symmetry=parameters.symmetry,
        workers=resources.workers,
        checkpoint=resources.checkpoint,
        on_sample=resources.on_sample,
    )

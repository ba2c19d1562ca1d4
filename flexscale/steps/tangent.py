"""Step `tangent`: stiffness of the flat sheet, in bending and in its plane."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from flexscale.datasets.build import build_tangent_dataset
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.labels import pattern_scalars
from flexscale.homogenize.mesh_error import estimate_mesh_error, note_mesh_error
from flexscale.homogenize.tangent import solve_tangent
from flexscale.mechanics.contact_options import ContactOptions
from flexscale.steps.base import Resources
from flexscale.steps.catalog import TangentParameters

if TYPE_CHECKING:
    import xarray as xr


def compute(
    parameters: TangentParameters, inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind tangent."""
    pattern, options = parameters.build_pattern(), parameters.build_mesh_options()
    substrate = parameters.build_substrate_options()
    scales = parameters.build_scale_options()
    contact = ContactOptions(enabled=False)
    problem = CellProblem.from_pattern(
        pattern, options, contact=contact, substrate=substrate, scales=scales
    )
    tangent = solve_tangent(problem)
    dataset = build_tangent_dataset(
        tangent.matrix,
        tangent.in_plane,
        parameters.directions,
        scalars=pattern_scalars(pattern, options),
        config=parameters.model_dump(mode="json"),
    )
    note_mesh_error(dataset, estimate_mesh_error(pattern, options, problem.model, tangent))
    return dataset

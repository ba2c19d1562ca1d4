"""Step `tangent`: stiffness of the flat sheet, in bending and in its plane."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from flexscale.datasets.build import build_tangent_dataset
from flexscale.homogenize import tangent_stiffness
from flexscale.homogenize.labels import pattern_scalars
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
    tangent = tangent_stiffness(pattern, mesh=options, substrate=substrate, scales=scales)
    return build_tangent_dataset(
        tangent.matrix,
        tangent.in_plane,
        parameters.directions,
        scalars=pattern_scalars(pattern, options),
        config=parameters.model_dump(mode="json"),
    )

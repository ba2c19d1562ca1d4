"""Step `fit`: the macro model, from a sweep and the stiffness of the flat sheet."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import TYPE_CHECKING

from flexscale.macro.fit import fit
from flexscale.steps.base import Resources
from flexscale.steps.catalog import FitParameters

if TYPE_CHECKING:
    import xarray as xr


def compute(
    parameters: FitParameters, inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind fit; samples of the sweep that did not converge are left out."""
    model = fit(
        inputs["sweep"],
        inputs["tangent"],
        variant=parameters.variant,
        weighting=parameters.weighting,
        w_biaxial=parameters.w_biaxial,
    )
    return dataclasses.replace(model, config=parameters.model_dump(mode="json")).to_dataset()

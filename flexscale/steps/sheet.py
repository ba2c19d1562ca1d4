"""Step `sheet`: a sheet of the fitted model, bent between end strips."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from flexscale.datasets.build_sheets import build_sheet_dataset
from flexscale.macro.bent_sheet import BendingRig, SheetOptions
from flexscale.macro.model import MacroModel
from flexscale.macro.rigs import side_sign
from flexscale.steps.base import Resources
from flexscale.steps.catalog import SheetParameters

if TYPE_CHECKING:
    import xarray as xr

#: Variable of the dataset -> attribute of a bent sheet.
ARRAYS = {
    "energy": "energy",
    "energy_density": "energy_density",
    "moment": "moment",
    "slide": "slide",
    "largest_curvature": "largest_curvature",
    "newton_iterations": "iterations",
    "negative_eigenvalues": "negative_eigenvalues",
    "status": "status",
}


def compute(
    parameters: SheetParameters, inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind sheet; values are nan where the sheet did not converge."""
    model = MacroModel.from_dataset(inputs["fit"])
    rig = BendingRig(
        model.sheet_law(),
        length=parameters.length,
        width=parameters.width,
        direction=parameters.direction,
        options=SheetOptions(size=parameters.size),
        curvature_range=model.largest_curvature,
    )
    bent = [
        [rig.bend(side_sign(side) * curvature) for curvature in parameters.curvatures]
        for side in parameters.sides
    ]
    arrays = {
        name: np.array([[getattr(sheet, attribute) for sheet in row] for row in bent])
        for name, attribute in ARRAYS.items()
    }
    # Bent sheets have it along the signed curvature; sides have their own, positive moments.
    arrays["moment"] *= np.array([[side_sign(side)] for side in parameters.sides])
    return build_sheet_dataset(
        parameters.sides,
        parameters.curvatures,
        arrays,
        length=parameters.length,
        width=parameters.width,
        direction=parameters.direction,
        scalars=model.labels,
        config=parameters.model_dump(mode="json"),
    )

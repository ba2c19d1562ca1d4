"""Step `turned_sheet`: sheets between end strips, with the pattern turned on them (Fig. 14)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from flexscale.datasets.build_sheets import build_turned_sheet_dataset
from flexscale.macro.bent_sheet import SheetOptions
from flexscale.macro.fit import fit
from flexscale.macro.rigs import side_sign
from flexscale.macro.simulate import simulate_sheet
from flexscale.steps.base import Resources
from flexscale.steps.catalog import TurnedSheetParameters
from flexscale.steps.sheet import ARRAYS

if TYPE_CHECKING:
    import xarray as xr


def compute(
    parameters: TurnedSheetParameters, inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind turned_sheet; values are nan where a sheet did not converge.

    Models are fitted here, as the step `fit` does by default, since a fit is of one energy.
    """
    sides, directions = parameters.sides, np.array(parameters.directions)
    models = [
        fit(inputs["sweep"], inputs["tangent"], variant=variant) for variant in parameters.variants
    ]
    options = SheetOptions(size=parameters.size)
    bent = [
        [
            [
                simulate_sheet(
                    model,
                    length=parameters.length,
                    width=parameters.width,
                    curvature=side_sign(side) * parameters.curvature,
                    direction=float(direction),
                    options=options,
                )
                for direction in directions
            ]
            for side in sides
        ]
        for model in models
    ]
    arrays = {
        name: np.array([[[getattr(one, attribute) for one in row] for row in of] for of in bent])
        for name, attribute in ARRAYS.items()
    }
    # Bent sheets have it along the signed curvature; sides have their own, positive moments.
    arrays["moment"] *= np.array([[side_sign(side)] for side in sides])
    laws = [[of.energy(parameters.curvature, directions, side) for side in sides] for of in models]
    arrays["law_energy_density"] = np.array(laws)
    return build_turned_sheet_dataset(
        parameters.variants,
        sides,
        directions,
        arrays,
        curvature=parameters.curvature,
        length=parameters.length,
        width=parameters.width,
        scalars=models[0].labels,
        config=parameters.model_dump(mode="json"),
    )

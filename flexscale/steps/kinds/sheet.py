"""Step `sheet`: a sheet of a macro model, bent between end strips."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Self

from pydantic import model_validator

from flexscale.steps.blocks import Size
from flexscale.steps.kinds.native_sheet import StripsBlock
from flexscale.steps.macro_blocks import MacroBlock, refuse_many_triangles
from flexscale.steps.quantities import declared
from flexscale.steps.step import Figure, Resources, Step, Task

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


class SheetBlock(StripsBlock, MacroBlock):
    """A rectangular sheet of a macro model bent between end strips."""

    size: Size = declared(5.0, "sides of the triangles", gt=0.0)

    @model_validator(mode="after")
    def _not_too_fine(self) -> Self:
        refuse_many_triangles("sheet", self.length, self.width, self.size)
        return self


def compute(
    task: Task[SheetBlock], inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind sheet; values are nan where the sheet did not converge."""
    import numpy as np

    from flexscale.datasets.kinds.sheet import SHEET as KIND
    from flexscale.datasets.sheet_variables import build_sheet_dataset
    from flexscale.sheets.bent_sheet import BendingRig, SheetOptions
    from flexscale.sides import side_sign

    block, model = task.block, task.block.read_model(inputs)
    rig = BendingRig(
        model.sheet_law(),
        length=block.length,
        width=block.width,
        direction=block.direction,
        options=SheetOptions(size=block.size),
        curvature_range=model.largest_curvature,
    )
    bent = [
        [rig.bend(side_sign(side) * curvature) for curvature in block.curvatures]
        for side in block.sides
    ]
    arrays = {
        name: np.array([[getattr(sheet, attribute) for sheet in row] for row in bent])
        for name, attribute in ARRAYS.items()
    }
    # Bent sheets have it along the signed curvature; sides have their own, positive moments.
    arrays["moment"] *= np.array([[side_sign(side)] for side in block.sides])
    return build_sheet_dataset(
        KIND,
        block.sides,
        block.curvatures,
        arrays,
        length=block.length,
        width=block.width,
        direction=block.direction,
        scalars=model.labels,
        config=task.config,
    )


SHEET = Step(
    "sheet",
    1,
    SheetBlock,
    "a macro model between end strips; {} for defaults",
    compute,
    figures=(
        Figure(
            "sheet",
            ("sheet",),
            lambda plot, sheet: plot.sheet(sheet),
            "Energy of a sheet between end strips against their curvature.",
        ),
    ),
)

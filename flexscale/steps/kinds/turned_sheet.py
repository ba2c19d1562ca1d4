"""Step `turned_sheet`: sheets between end strips, with the pattern turned on them (Fig. 14)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, ClassVar, Self

from pydantic import field_validator, model_validator
from pydantic_core import PydanticCustomError

from flexscale.datasets.variables import VARIANTS, Variant
from flexscale.patterns.pattern import Pattern
from flexscale.steps.blocks import Size
from flexscale.steps.kinds.fit import require_sweep_to_fit
from flexscale.steps.kinds.native_turned_sheet import TurnedBlock
from flexscale.steps.kinds.sheet import ARRAYS
from flexscale.steps.macro_blocks import refuse_many_triangles
from flexscale.steps.quantities import declared, several
from flexscale.steps.step import Figure, Resources, Step, Task

if TYPE_CHECKING:
    import xarray as xr

    from flexscale.steps.experiment import Experiment


class TurnedSheetBlock(TurnedBlock):
    """Rectangular sheets between end strips, each with the pattern turned another way on it.

    Models are fitted to the sweep, one for each energy of a curvature tensor.
    """

    takes: ClassVar[tuple[str, ...]] = ("sweep", "tangent")

    variants: Annotated[tuple[Variant, ...], several] = declared(
        VARIANTS, "energies of a curvature tensor: tangent, paper", min_length=1
    )
    size: Size = declared(5.0, "sides of the triangles", gt=0.0)

    @field_validator("variants")
    @classmethod
    def _variants_once(cls, values: tuple[str, ...]) -> tuple[str, ...]:
        if len(set(values)) != len(values):
            raise PydanticCustomError("twice", "an energy is named twice", {})
        return values

    @model_validator(mode="after")
    def _not_too_fine(self) -> Self:
        refuse_many_triangles("turned_sheet", self.length, self.width, self.size)
        return self

    def n_samples(self, pattern: Pattern) -> int:
        """One for each energy, side and direction."""
        return len(self.variants) * super().n_samples(pattern)

    def refuse_in(self, experiment: Experiment) -> None:
        """A sweep that is too small."""
        require_sweep_to_fit(experiment)


def compute(
    task: Task[TurnedSheetBlock], inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind turned_sheet; values are nan where a sheet did not converge.

    Models are fitted here, as the step `fit` does by default, since a fit is of one energy.
    """
    import numpy as np

    from flexscale.datasets.kinds.turned_sheet import TURNED_SHEET as KIND
    from flexscale.datasets.sheet_variables import build_turned_dataset
    from flexscale.macro.fit import fit
    from flexscale.sheets.bent_sheet import SheetOptions
    from flexscale.sheets.simulate import simulate_sheet
    from flexscale.sides import side_sign

    block = task.block
    sides, directions = block.sides, np.array(block.directions)
    models = [fit(inputs["sweep"], inputs["tangent"], variant=name) for name in block.variants]
    options = SheetOptions(size=block.size)
    bent = [
        [
            [
                simulate_sheet(
                    model,
                    length=block.length,
                    width=block.width,
                    curvature=side_sign(side) * block.curvature,
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
    laws = [[of.energy(block.curvature, directions, side) for side in sides] for of in models]
    arrays["law_energy_density"] = np.array(laws)
    arrays["variant"] = np.array(block.variants)
    return build_turned_dataset(
        KIND,
        sides,
        directions,
        arrays,
        curvature=block.curvature,
        length=block.length,
        width=block.width,
        scalars=models[0].labels,
        config=task.config,
    )


TURNED_SHEET = Step(
    "turned_sheet",
    1,
    TurnedSheetBlock,
    "sheets between end strips, with the pattern turned on them; {} for defaults",
    compute,
    figures=(
        Figure(
            "turned_sheet",
            ("turned_sheet", "sweep"),
            lambda plot, turned, sweep: plot.turned_sheet(turned, sweep),
            "Energy density of sheets against the direction of the pattern on them, and of the "
            "cell.",
        ),
    ),
)

"""Step `gap_model`: the macro model of the flat cell, in seconds; a sweep may soften it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

from flexscale.errors import ConfigError
from flexscale.steps.blocks import BendingDirections, DoubleBending
from flexscale.steps.native_inputs import native_of
from flexscale.steps.quantities import declared
from flexscale.steps.step import FLAT, Figure, Resources, Step, StepBlock, Task

if TYPE_CHECKING:
    import xarray as xr

    from flexscale.steps.experiment import Experiment


class GapModelBlock(StepBlock):
    """Macro model of the flat cell: its stiffness, and gaps that close."""

    takes: ClassVar[tuple[str, ...]] = ("cell",)

    softened: bool = declared(False, "fit two softenings to the block `sweep`; false needs none")
    w_biaxial: DoubleBending | None = declared(
        None, "resistance to double curvature, from the tile's size if left out", ge=0.0
    )
    directions: BendingDirections = declared(
        tuple(5.0 * index for index in range(36)),
        "directions at which the onset of contact is tabulated",
        min_length=1,
    )

    @property
    def inputs(self) -> tuple[str, ...]:
        """The sweep too, where it softens the model."""
        return ("cell", "sweep") if self.softened else ("cell",)

    def refuse_in(self, experiment: Experiment) -> None:
        """Scales that pass through one another."""
        if not experiment.contact.enabled:
            raise ConfigError("gap_model: its gaps close by contact: leave contact.enabled true.")


def compute(
    task: Task[GapModelBlock], inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind gap_model."""
    from flexscale.macro.gap_model import gap_model

    block = task.block
    model = gap_model(
        task.pattern, inputs.get("sweep"), model=native_of(task, inputs), w_biaxial=block.w_biaxial
    )
    return model.to_dataset(block.directions, config=task.config)


GAP_MODEL = Step(
    "gap_model",
    1,
    GapModelBlock,
    "macro model of the flat cell; {} for defaults",
    compute,
    native=(*FLAT, "contact"),
    figures=(
        Figure(
            "gap_model",
            ("gap_model",),
            lambda plot, model: plot.gap_model(model),
            "Stiffness of the flat cell and curvature of first contact against direction.",
        ),
    ),
)

"""Step `native_turned_sheet`: sheets of scales between end strips, with the pattern turned on them
(Fig. 14)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar, Self

from pydantic import model_validator

from flexscale.homogenize.native_model import NativeModel, require_joints
from flexscale.patterns.pattern import Pattern
from flexscale.sides import SIDES
from flexscale.steps.blocks import BendingDirections, Curvature, Sides, Size
from flexscale.steps.folds import require_open
from flexscale.steps.native_inputs import native_of
from flexscale.steps.quantities import declared
from flexscale.steps.step import BENT, Figure, Resources, Step, StepBlock, Task

if TYPE_CHECKING:
    import xarray as xr

    from flexscale.steps.experiment import Experiment


class TurnedBlock(StepBlock):
    """Rectangular sheets between end strips, each with the pattern turned another way on it."""

    length: Size = declared(100.0, "length, along which they are bent", gt=0.0)
    width: Size = declared(50.0, "width", gt=0.0)
    curvature: Curvature = declared(0.02, "curvature of the end strips", gt=0.0)
    directions: BendingDirections = declared(
        tuple(15.0 * index for index in range(12)),
        "of their length in the pattern's coordinates, increasing, from 0 to below 180",
        min_length=1,
    )
    sides: Sides = declared(SIDES, "sides to bend to: closing, opening", min_length=1)

    @model_validator(mode="after")
    def _does_not_meet_itself(self) -> Self:
        require_open(self.curvature, self.length)
        return self

    def n_samples(self, pattern: Pattern) -> int:
        """One for each side and direction."""
        return len(self.sides) * len(self.directions)


class NativeTurnedSheetBlock(TurnedBlock):
    """Rectangular sheets of scales between end strips, the pattern turned another way on each."""

    takes: ClassVar[tuple[str, ...]] = ("cell",)

    def refuse_in(self, experiment: Experiment) -> None:
        """Native models that have no whole sheets."""
        require_joints(experiment.model)

    def refuse_of(self, pattern: Pattern, native: NativeModel) -> None:
        """More scales than memory holds, or sheets that cannot be cut from the pattern."""
        from flexscale.finite.native_sheet import require_sheet

        for direction in self.directions:
            require_sheet(pattern, self.length, self.width, direction)


def compute(
    task: Task[NativeTurnedSheetBlock], inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind native_turned_sheet; values are nan where a sheet did not converge."""
    from flexscale.finite.native_turned_sheets import turn_native_sheets

    block = task.block
    return turn_native_sheets(
        task.pattern,
        (block.length, block.width),
        block.curvature,
        block.directions,
        block.sides,
        native_of(task, inputs),
        checkpoint=resources.checkpoint,
        on_sample=resources.on_sample,
    )


NATIVE_TURNED_SHEET = Step(
    "native_turned_sheet",
    1,
    NativeTurnedSheetBlock,
    "the scales themselves between end strips, the pattern turned on them; {} for defaults",
    compute,
    native=BENT,
    resumable=True,
    figures=(
        Figure(
            "native_turned_sheet",
            ("native_turned_sheet",),
            lambda plot, sheets: plot.native_turned_sheet(sheets),
            "Energy density of sheets of scales against the direction of the pattern on them.",
        ),
    ),
)

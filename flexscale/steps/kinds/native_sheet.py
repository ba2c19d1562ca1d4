"""Step `native_sheet`: a sheet of scales, bent between end strips."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, ClassVar, Self

from pydantic import field_validator, model_validator
from pydantic_core import PydanticCustomError

from flexscale.checks import place
from flexscale.homogenize.native_model import NativeModel, require_joints
from flexscale.patterns.pattern import Pattern
from flexscale.sides import SIDES
from flexscale.steps.blocks import Curvatures, Direction, Point, Sides, Size, increasing
from flexscale.steps.folds import require_open
from flexscale.steps.native_inputs import native_of
from flexscale.steps.quantities import declared, within
from flexscale.steps.step import BENT, Figure, Resources, Step, StepBlock, Task

if TYPE_CHECKING:
    import xarray as xr

    from flexscale.steps.experiment import Experiment


class StripsBlock(StepBlock):
    """A rectangular sheet between end strips, of scales or of a macro model."""

    length: Size = declared(100.0, "length, along which it is bent", gt=0.0)
    width: Size = declared(50.0, "width", gt=0.0)
    curvatures: Curvatures = declared(
        (0.0, 0.005, 0.01, 0.015, 0.02, 0.025), "curvatures, increasing", min_length=1
    )
    direction: Direction = declared(0.0, "of its length in the pattern's coordinates")
    sides: Sides = declared(SIDES, "sides to bend to: closing, opening", min_length=1)

    @field_validator("curvatures")
    @classmethod
    def _curvatures_increase(cls, values: tuple[float, ...]) -> tuple[float, ...]:
        if values[0] < 0.0:
            raise PydanticCustomError(
                "range", "curvatures are not negative: `sides` says to which side to bend", {}
            )
        return increasing(values)

    @model_validator(mode="after")
    def _does_not_meet_itself(self) -> Self:
        require_open(self.curvatures[-1], self.length)
        return self

    def n_samples(self, pattern: Pattern) -> int:
        """One for each side and curvature."""
        return len(self.sides) * len(self.curvatures)


class NativeSheetBlock(StripsBlock):
    """A sheet of scales bent between end strips."""

    takes: ClassVar[tuple[str, ...]] = ("cell",)
    silent: ClassVar[tuple[str, ...]] = ("offset", "outline")

    offset: Annotated[Point, within(place, "offset")] = declared(
        (0.0, 0.0), "point of the pattern that lies in the middle of its length and width"
    )
    outline: tuple[Point, ...] | None = declared(
        None, "corners, if it is no rectangle; it fills length and width, with edges at both ends"
    )

    def refuse_in(self, experiment: Experiment) -> None:
        """Native models that have no whole sheets."""
        require_joints(experiment.model)

    def refuse_of(self, pattern: Pattern, native: NativeModel) -> None:
        """More scales than memory holds, or a sheet that cannot be cut from the pattern."""
        from flexscale.finite.native_sheet import require_sheet

        size = (self.length, self.width, self.direction, self.offset, self.outline)
        require_sheet(pattern, *size)


def compute(
    task: Task[NativeSheetBlock], inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind native_sheet; values are nan where the sheet did not converge."""
    from flexscale.finite.native_sheet_dataset import simulate_native_sheet

    block = task.block
    return simulate_native_sheet(
        task.pattern,
        block.length,
        block.width,
        curvatures=block.curvatures,
        direction=block.direction,
        side=block.sides,
        offset=block.offset,
        outline=block.outline,
        model=native_of(task, inputs),
        checkpoint=resources.checkpoint,
        on_sample=resources.on_sample,
    )


NATIVE_SHEET = Step(
    "native_sheet",
    2,
    NativeSheetBlock,
    "the scales themselves between end strips; {} for defaults",
    compute,
    native=BENT,
    resumable=True,
    figures=(
        Figure(
            "native_sheet",
            ("native_sheet",),
            lambda plot, sheet: plot.sheet(sheet),
            "Energy of a sheet of scales between end strips against their curvature.",
        ),
    ),
)

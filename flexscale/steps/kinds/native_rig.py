"""Step `native_rig`: scales on the testing devices."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar, Self

from pydantic import model_validator
from pydantic_core import PydanticCustomError

from flexscale.homogenize.native_model import NativeModel, require_joints
from flexscale.mechanics.load_series import RIM_ANGLES
from flexscale.patterns.pattern import Pattern
from flexscale.sides import SIDES
from flexscale.steps.blocks import Directions, Sides
from flexscale.steps.kinds.rig import MandrelBlock, StageBlock
from flexscale.steps.native_inputs import native_of
from flexscale.steps.quantities import declared
from flexscale.steps.step import BENT, Figure, Resources, Step, StepBlock, Task

if TYPE_CHECKING:
    import xarray as xr

    from flexscale.steps.experiment import Experiment


class NativeMandrelBlock(MandrelBlock):
    """A disc of scales clamped at its hub and pushed around its rim."""

    angles: Directions = declared(
        RIM_ANGLES, "where it is pushed, increasing, from 0 to below 360", min_length=1
    )


class NativeStageBlock(StageBlock):
    """A strip of scales between two hinges that come closer."""

    _place = "native_rig.stage"


class NativeRigBlock(StepBlock):
    """Scales on the testing devices, one or both."""

    takes: ClassVar[tuple[str, ...]] = ("cell",)

    sides: Sides = declared(SIDES, "sides to bend to: closing, opening", min_length=1)
    mandrel: NativeMandrelBlock | None = declared(None, "disc on the mandrel; {} for defaults")
    stage: NativeStageBlock | None = declared(None, "strip on the stage; {} for defaults")

    @model_validator(mode="after")
    def _some_device(self) -> Self:
        if self.mandrel is None and self.stage is None:
            raise PydanticCustomError("empty", "`native_rig` needs `mandrel`, `stage`, or both", {})
        return self

    def n_samples(self, pattern: Pattern) -> int:
        """One for each side and angle, or shortening."""
        angles = len(self.mandrel.angles) if self.mandrel else 0
        shortenings = len(self.stage.shortenings) if self.stage else 0
        return len(self.sides) * (angles + shortenings)

    def refuse_in(self, experiment: Experiment) -> None:
        """Native models that have no whole sheets."""
        require_joints(experiment.model)

    def refuse_of(self, pattern: Pattern, native: NativeModel) -> None:
        """More scales than memory holds, or what cannot be cut from the pattern."""
        from flexscale.finite.native_disc import lay_disc
        from flexscale.finite.native_sheet import require_sheet

        if self.stage is not None:
            require_sheet(pattern, self.stage.length, self.stage.width, self.stage.direction)
        if self.mandrel is not None:
            lay_disc(pattern, self.mandrel.radius, self.mandrel.hub)


def compute(
    task: Task[NativeRigBlock], inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind native_rig; values are nan where no equilibrium was found."""
    from flexscale.finite.native_rigs import Progress, mandrel_arrays, rig_dataset, stage_arrays

    block, native = task.block, native_of(task, inputs)
    progress = Progress(block.n_samples(task.pattern), resources.on_sample)
    given = (block.sides, native, resources.checkpoint, progress)
    devices = {}
    if block.mandrel is not None:
        disc = block.mandrel.model_dump()
        devices["mandrel"] = mandrel_arrays(task.pattern, disc.pop("angles"), *given, **disc)
    if block.stage is not None:
        strip = block.stage.model_dump()
        devices["stage"] = stage_arrays(task.pattern, strip.pop("shortenings"), *given, **strip)
    return rig_dataset(task.pattern, native, block.sides, devices)


NATIVE_RIG = Step(
    "native_rig",
    2,
    NativeRigBlock,
    "the scales themselves on the testing devices",
    compute,
    native=BENT,
    resumable=True,
    figures=(
        Figure(
            "native_rig",
            ("native_rig",),
            lambda plot, rig: plot.rig(rig),
            "Force on the scales on the testing devices: around the mandrel, and against the "
            "stage's shortening.",
        ),
    ),
)

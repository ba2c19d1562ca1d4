"""Step `native_rig`: a strip of whole and cut scales on the stage."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

from flexscale.homogenize.native_model import NativeModel, require_finite_sheet
from flexscale.mesh.estimate import require_moderate_sheet
from flexscale.patterns.pattern import Pattern
from flexscale.sides import SIDES
from flexscale.steps.blocks import Sides
from flexscale.steps.kinds.rig import StageBlock
from flexscale.steps.quantities import declared
from flexscale.steps.step import BENT, Figure, Resources, Step, StepBlock, Task

if TYPE_CHECKING:
    import xarray as xr

    from flexscale.steps.experiment import Experiment


class NativeRigBlock(StageBlock, StepBlock):
    """A strip of scales between two hinges that come closer."""

    _place: ClassVar[str] = "native_rig"

    sides: Sides = declared(SIDES, "sides to bend to: closing, opening", min_length=1)

    def n_samples(self, pattern: Pattern) -> int:
        """One for each side and shortening."""
        return len(self.sides) * len(self.shortenings)

    def refuse_in(self, experiment: Experiment) -> None:
        """Options that only a periodic cell has."""
        require_finite_sheet(experiment.model)

    def refuse_of(self, pattern: Pattern, native: NativeModel) -> None:
        """A mesh that is too large."""
        require_moderate_sheet(pattern, native.mesh, self.length, self.width)


def compute(
    task: Task[NativeRigBlock], inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind native_rig; values are nan where the strip did not converge."""
    from flexscale.finite.native_stage_dataset import simulate_native_stage

    block = task.block
    return simulate_native_stage(
        task.pattern,
        length=block.length,
        width=block.width,
        shortenings=block.shortenings,
        direction=block.direction,
        sides=block.sides,
        model=task.native,
        checkpoint=resources.checkpoint,
        on_sample=resources.on_sample,
    )


NATIVE_RIG = Step(
    "native_rig",
    1,
    NativeRigBlock,
    "the scales themselves on the stage; {} for defaults, which take hours",
    compute,
    native=BENT,
    resumable=True,
    figures=(
        Figure(
            "native_rig",
            ("native_rig",),
            lambda plot, rig: plot.rig(rig),
            "Force on a strip of scales on the stage, against its shortening.",
        ),
    ),
)

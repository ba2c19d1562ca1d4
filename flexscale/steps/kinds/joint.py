"""Step `joint`: the law of a pattern's joints, from their cross-section as a solid."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic_core import PydanticCustomError

from flexscale.homogenize.native_model import NativeModel
from flexscale.joints.key import VERSION
from flexscale.patterns.pattern import Pattern
from flexscale.steps.blocks import Size
from flexscale.steps.quantities import declared
from flexscale.steps.step import Figure, Resources, Step, StepBlock, Task

if TYPE_CHECKING:
    import xarray as xr

    from flexscale.joints.compute import SolvedJoint
    from flexscale.joints.key import JointKey
    from flexscale.steps.experiment import Experiment


class JointBlock(StepBlock):
    """Law of the joints between scales: energy per length of their relative pose."""

    silent: ClassVar[tuple[str, ...]] = ("gap",)

    groove: bool = declared(False, "the sheet has the grooves that `flexscale fabricate` cuts")
    gap: Size | None = declared(
        None, "the gap of a joint, where a pattern has several; each of them if left out"
    )

    def one_by_one(self, pattern: Pattern) -> tuple[JointBlock, ...]:
        """A block for each gap of the pattern's joints."""
        from flexscale.patterns.joint_lines import joint_gaps

        gaps = joint_gaps(pattern)
        if self.gap is not None or len(gaps) == 1:
            return (self,)
        return tuple(self.model_copy(update={"gap": gap}) for gap in gaps)

    def refuse_in(self, experiment: Experiment) -> None:
        """The law of one gap, where cells need those of all."""
        takers = [
            step.name for step, block in experiment.asked() if "joint" in experiment.inputs(block)
        ]
        if self.gap is not None and takers:
            raise PydanticCustomError(
                "gap",
                "`joint` asks for the law of one gap, {gap} mm, but `{taker}` takes those of all "
                "joints: leave joint.gap out",
                {"gap": f"{self.gap:g}", "taker": takers[0]},
            )

    def refuse_of(self, pattern: Pattern, native: NativeModel) -> None:
        """Sizes for which no joint can be computed."""
        for block in self.one_by_one(pattern):
            block.key(pattern)

    def key(self, pattern: Pattern) -> JointKey:
        """What the law depends on."""
        from flexscale.joints.key import JointGroove
        from flexscale.joints.library import pattern_key

        return pattern_key(pattern, JointGroove() if self.groove else None, self.gap)


def compute(
    task: Task[JointBlock], inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind joint."""
    from flexscale.datasets.kinds.joint import build_joint_dataset
    from flexscale.homogenize.labels import pattern_scalars
    from flexscale.joints.library import solved_joint

    joint = solved_joint(task.block.key(task.pattern))
    scalars = pattern_scalars(task.pattern, task.native)
    if task.block.gap is not None:
        scalars["gap"] = task.block.gap
    return build_joint_dataset(_arrays(joint), scalars=scalars, config=task.config)


def _arrays(joint: SolvedJoint) -> dict[str, Any]:
    law = joint.law(1.0, 1.0)
    slope, below, above, before = law.band
    found = {
        "exponents": joint.exponents,
        "coefficients": joint.coefficients,
        "stiffness": law.stiffness,
        "energy_error": joint.errors[0],
        "force_error": joint.errors[1:],
        "mesh_error": joint.mesh_errors[:4],
        "lowest": law.bounds[:, 0],
        "highest": law.bounds[:, 1],
        "touching_slope": slope,
        "below_touching": below,
        "above_touching": above,
        "before_touching": before,
        "state_poses": joint.poses,
        "state_energies": joint.energies,
        "state_forces": joint.forces,
        "held_out": joint.held_out,
        "n_missing": joint.n_missing,
        "gap_ratio": joint.key.gap,
        "height_ratio": joint.key.height,
        "groove_depth_ratio": joint.key.groove_depth,
    }
    if joint.key.modulus_ratio is not None:
        found["modulus_ratio"] = joint.key.modulus_ratio
    return found


JOINT = Step(
    "joint",
    VERSION,
    JointBlock,
    "law of the joints between scales; {} for defaults",
    compute,
    native=(),
    implied=True,
    figures=(
        Figure(
            "joint",
            ("joint",),
            lambda plot, joint: plot.joint(joint),
            "Forces of a joint per length against its pose: law, and states of the solid.",
        ),
    ),
)

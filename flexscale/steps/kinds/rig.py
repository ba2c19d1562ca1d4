"""Step `rig`: a macro model on the testing devices."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Self

from pydantic import field_validator, model_validator
from pydantic_core import PydanticCustomError

from flexscale.mechanics.load_series import SHORTENINGS, require_shortenings
from flexscale.mesh.sheet import require_moderate_triangles
from flexscale.patterns.pattern import Pattern
from flexscale.sheets.rim import ANGLES, Rim
from flexscale.sides import SIDES
from flexscale.steps.blocks import Block, Direction, Directions, Lengths, Sides, Size, increasing
from flexscale.steps.macro_blocks import MacroBlock, named, refuse_many_triangles
from flexscale.steps.quantities import declared
from flexscale.steps.step import Figure, Resources, Step, Task

if TYPE_CHECKING:
    import numpy as np
    import xarray as xr

    from flexscale.sheets.mandrel import MandrelTest
    from flexscale.sheets.rigs import RigOptions
    from flexscale.sheets.sheet_model import SheetModel
    from flexscale.sheets.stage import StageTest

#: Variable of the dataset, without its device -> attribute of a test.
_ARRAYS = {
    "force": "force",
    "energy": "energy",
    "largest_curvature": "largest_curvature",
    "newton_iterations": "iterations",
    "negative_eigenvalues": "negative_eigenvalues",
    "status": "status",
}


class MandrelBlock(Block):
    """A disc clamped at its hub and pushed around its rim."""

    radius: Size = declared(Rim.radius, "radius of the disc", gt=0.0)
    hub: Size = declared(Rim.hub, "radius of the hub that holds it", gt=0.0)
    indentation: Size = declared(15.0, "push on its rim, normal to the disc", gt=0.0)
    angles: Directions = declared(
        ANGLES, "where it is pushed, increasing, from 0 to below 360", min_length=1
    )

    @field_validator("angles")
    @classmethod
    def _angles_in_range(cls, values: tuple[float, ...]) -> tuple[float, ...]:
        if values[0] < 0.0 or values[-1] >= 360.0:
            raise PydanticCustomError("range", "angles lie in [0, 360) degree", {})
        return increasing(values)


class StageBlock(Block):
    """A strip between two hinges that come closer."""

    _place: ClassVar[str] = "rig.stage"

    length: Size = declared(100.0, "length between the hinges", gt=0.0)
    width: Size = declared(50.0, "width", gt=0.0)
    direction: Direction = declared(0.0, "of its length in the pattern's coordinates")
    shortenings: Lengths = declared(
        SHORTENINGS, "by which the hinges come closer, increasing from above 0", min_length=1
    )

    @model_validator(mode="after")
    def _shortenings_in_range(self) -> Self:
        with named(self._place):
            require_shortenings(self.shortenings, self.length)
        return self


class RigBlock(MacroBlock):
    """A macro model on the testing devices, one or both."""

    sides: Sides = declared(SIDES, "sides to bend to: closing, opening", min_length=1)
    size: Size = declared(Rim.size, "sides of the triangles", gt=0.0)
    mandrel: MandrelBlock | None = declared(None, "disc on the mandrel; {} for defaults")
    stage: StageBlock | None = declared(None, "strip on the stage; {} for defaults")

    @model_validator(mode="after")
    def _some_device_that_can_work(self) -> Self:
        if self.mandrel is None and self.stage is None:
            raise PydanticCustomError("empty", "`rig` needs `mandrel`, `stage`, or both", {})
        if self.mandrel is not None:
            with named("rig.mandrel"):
                rim = Rim(self.mandrel.radius, self.mandrel.hub, self.size)
                rim.require_indentation(self.mandrel.indentation)
                require_moderate_triangles(6.0 * rim.rings**2, self.size)
                for angle in self.mandrel.angles:
                    rim.place(angle)
        if self.stage is not None:
            refuse_many_triangles("rig.stage", self.stage.length, self.stage.width, self.size)
        return self

    def n_samples(self, pattern: Pattern) -> int:
        """One for each side and angle, or shortening."""
        angles = len(self.mandrel.angles) if self.mandrel else 0
        shortenings = len(self.stage.shortenings) if self.stage else 0
        return len(self.sides) * (angles + shortenings)


def compute(
    task: Task[RigBlock], inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind rig; values are nan where a device's sheet did not converge."""
    from flexscale.datasets.device_variables import build_rig_dataset
    from flexscale.datasets.kinds.rig import RIG as KIND
    from flexscale.sheets.rigs import RigOptions

    block, model = task.block, task.block.read_model(inputs)
    options = RigOptions(size=block.size)
    devices: dict[str, dict[str, Any]] = {}
    if block.mandrel is not None:
        devices["mandrel"] = _mandrel(model, block.mandrel, block.sides, options)
    if block.stage is not None:
        devices["stage"] = _stage(model, block.stage, block.sides, options)
    return build_rig_dataset(KIND, block.sides, devices, scalars=model.labels, config=task.config)


def _mandrel(
    model: SheetModel, disc: MandrelBlock, sides: Sequence[str], options: RigOptions
) -> dict[str, Any]:
    from flexscale.sheets.mandrel import simulate_mandrel

    settings = disc.model_dump()
    tests = [simulate_mandrel(model, **settings, side=side, options=options) for side in sides]
    return {**_stacked(tests, _ARRAYS), "angle": settings.pop("angles"), **settings}


def _stage(
    model: SheetModel, strip: StageBlock, sides: Sequence[str], options: RigOptions
) -> dict[str, Any]:
    from flexscale.sheets.stage import simulate_stage

    settings = strip.model_dump()
    tests = [simulate_stage(model, **settings, side=side, options=options) for side in sides]
    arrays = _stacked(tests, {**_ARRAYS, "deflection": "deflection"})
    return {**arrays, "shortening": settings.pop("shortenings"), **settings}


def _stacked(
    tests: Sequence[MandrelTest | StageTest], arrays: Mapping[str, str]
) -> dict[str, np.ndarray]:
    """(n_sides, n) of each variable."""
    import numpy as np

    return {
        name: np.stack([getattr(test, attribute) for test in tests])
        for name, attribute in arrays.items()
    }


RIG = Step(
    "rig",
    1,
    RigBlock,
    "a macro model on the testing devices",
    compute,
    figures=(
        Figure(
            "rig",
            ("rig",),
            lambda plot, rig: plot.rig(rig),
            "Force on the testing devices: around the mandrel, and against the stage's shortening.",
        ),
    ),
)

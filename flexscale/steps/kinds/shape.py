"""Step `shape`: deformed cells to look at."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import model_validator

from flexscale.homogenize.native_model import NativeModel
from flexscale.patterns.pattern import Pattern
from flexscale.steps.blocks import Block, Curvature, Direction, Side
from flexscale.steps.folds import refuse_folds
from flexscale.steps.native_inputs import native_of
from flexscale.steps.quantities import declared
from flexscale.steps.step import BENT, Figure, Resources, Step, StepBlock, Task

if TYPE_CHECKING:
    import xarray as xr


class ShapeSample(Block):
    """One deformed state."""

    side: Side = declared("closing", "side to bend to: closing, opening")
    direction: Direction = declared(0.0, "along which the sheet curves", ge=0.0, lt=180.0)
    curvature: Curvature = declared(..., "curvature", gt=0.0)


class ShapeBlock(StepBlock):
    """Deformed cells to look at: a list of states."""

    takes: ClassVar[tuple[str, ...]] = ("cell",)

    samples: tuple[ShapeSample, ...] = declared(..., "states to show", min_length=1)

    @model_validator(mode="before")
    @classmethod
    def _list_of_states(cls, data: Any) -> Any:
        return {"samples": data} if isinstance(data, list | tuple) else data

    def n_samples(self, pattern: Pattern) -> int:
        """One for each state."""
        return len(self.samples)

    def refuse_of(self, pattern: Pattern, native: NativeModel) -> None:
        """Curvatures at which the sheet folds through its scales."""
        closing = [sample.curvature for sample in self.samples if sample.side == "closing"]
        refuse_folds(pattern, max(closing, default=0.0))


def compute(
    task: Task[ShapeBlock], inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind shape; a state that did not converge has no displacement (nan)."""
    from flexscale.homogenize.shape import solve_shapes

    bends = [(one.side, one.direction, one.curvature) for one in task.block.samples]
    return solve_shapes(task.pattern, bends, native_of(task, inputs))


SHAPE = Step(
    "shape",
    4,
    ShapeBlock,
    "deformed cells, a list of states",
    compute,
    native=BENT,
    figures=(
        Figure(
            "shape",
            ("shape",),
            lambda plot, shape: plot.cell(shape),
            "The deformed cell with its lattice images.",
        ),
    ),
)

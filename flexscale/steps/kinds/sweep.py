"""Step `sweep`: a pattern bent in many directions, to both sides, to many curvatures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

from flexscale.homogenize.native_model import NativeModel
from flexscale.patterns.pattern import Pattern
from flexscale.steps.blocks import BendingDirections, CurvaturesFromFlat, Sides
from flexscale.steps.folds import refuse_folds
from flexscale.steps.native_inputs import native_of
from flexscale.steps.quantities import declared
from flexscale.steps.step import BENT, Figure, Resources, Step, StepBlock, Task

if TYPE_CHECKING:
    import xarray as xr


class SweepBlock(StepBlock):
    """Bending in many directions to many curvatures."""

    takes: ClassVar[tuple[str, ...]] = ("cell",)

    sides: Sides = declared(
        ("closing", "opening"), "sides to bend to: closing, opening", min_length=1
    )
    directions: BendingDirections = declared(
        ...,
        "directions along which the sheet curves, fold lines run across; increasing, from 0 to "
        "below 180",
        min_length=1,
    )
    curvatures: CurvaturesFromFlat = declared(..., "curvatures, increasing from 0", min_length=1)
    symmetry: bool = declared(True, "solve equivalent directions once; false solves all")

    def n_samples(self, pattern: Pattern) -> int:
        """Those of directions that symmetry does not fill."""
        from flexscale.homogenize.symmetry import find_sources

        sources = find_sources(pattern, self.directions, self.symmetry)
        solved = {source.direction for source in sources}
        return len(self.sides) * len(solved) * len(self.curvatures)

    def refuse_of(self, pattern: Pattern, native: NativeModel) -> None:
        """Curvatures at which the sheet folds through its scales."""
        if "closing" in self.sides:
            refuse_folds(pattern, self.curvatures[-1])


def compute(
    task: Task[SweepBlock], inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind sweep; samples that did not converge carry a status and no numbers."""
    from flexscale.homogenize.sweep import sweep

    return sweep(
        task.pattern,
        task.block.directions,
        task.block.curvatures,
        sides=task.block.sides,
        model=native_of(task, inputs),
        symmetry=task.block.symmetry,
        workers=resources.workers,
        checkpoint=resources.checkpoint,
        on_sample=resources.on_sample,
    )


SWEEP = Step(
    "sweep",
    3,
    SweepBlock,
    "bending sweep",
    compute,
    native=BENT,
    parallel=True,
    resumable=True,
    figures=(
        Figure(
            "polar",
            ("sweep",),
            lambda plot, sweep: plot.polar(sweep, side=[str(s) for s in sweep["side"].values]),
            "Bending moment against bending direction, one curve per curvature.",
        ),
        Figure(
            "curves",
            ("sweep",),
            lambda plot, sweep: plot.curves(sweep),
            "Bending moment against curvature, one line per direction.",
        ),
    ),
)

"""Step `tensor_sweep`: a pattern bent by curvature tensors, dome, cylinder and saddle."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from pydantic import AfterValidator
from pydantic_core import PydanticCustomError

from flexscale.datasets.variables import CLOSING_DOME, OPENING_DOME
from flexscale.homogenize.native_model import NativeModel, require_joints
from flexscale.mechanics.load_series import RAY_CURVATURES, RAY_DIRECTIONS, RAY_SHAPES
from flexscale.patterns.pattern import Pattern
from flexscale.steps.blocks import BendingDirections, CurvaturesFromFlat, Directions, increasing
from flexscale.steps.folds import refuse_folds
from flexscale.steps.native_inputs import native_of
from flexscale.steps.quantities import declared
from flexscale.steps.step import BENT, Figure, Resources, Step, StepBlock, Task

if TYPE_CHECKING:
    import xarray as xr

    from flexscale.steps.experiment import Experiment


def _of_ordered_curvatures(values: tuple[float, ...]) -> tuple[float, ...]:
    """Validator of shapes (degree): increasing, the first principal curvature the larger one."""
    if values and (values[0] < OPENING_DOME or values[-1] > CLOSING_DOME):
        raise PydanticCustomError(
            "range", "shapes lie in [-135, 45] degree: the first curvature is the larger one", {}
        )
    return increasing(values)


Shapes = Annotated[Directions, AfterValidator(_of_ordered_curvatures)]


class TensorSweepBlock(StepBlock):
    """Bending by curvature tensors, along rays from the flat sheet."""

    takes: ClassVar[tuple[str, ...]] = ("cell",)

    directions: BendingDirections = declared(
        RAY_DIRECTIONS,
        "directions of the larger principal curvature; increasing, from 0 to below 180",
        min_length=1,
    )
    shapes: Shapes = declared(
        RAY_SHAPES,
        "angles of the principal curvatures: -135 opening dome, -90 opening cylinder, -45 saddle, "
        "0 closing cylinder, 45 closing dome; increasing",
        min_length=1,
    )
    curvatures: CurvaturesFromFlat = declared(
        RAY_CURVATURES,
        "roots of the sum of squares of the principal curvatures, increasing from 0",
        min_length=1,
    )
    in_plane: Literal["free", "held"] = declared(
        "free", "the lattice in its plane: free to stretch, or held at its rest lengths"
    )
    symmetry: bool = declared(True, "solve equivalent directions once; false solves all")

    def n_samples(self, pattern: Pattern) -> int:
        """Those of rays that symmetry does not fill."""
        from flexscale.homogenize.tensor_sweep import ray_sources

        sources = ray_sources(pattern, self.directions, self.shapes, self.symmetry)
        solved = {
            (source.direction, shape)
            for row in sources
            for source, shape in zip(row, self.shapes, strict=True)
        }
        return len(solved) * len(self.curvatures)

    def refuse_in(self, experiment: Experiment) -> None:
        """Native models that are not bent two ways."""
        require_joints(experiment.model, "Tensor sweeps")

    def refuse_of(self, pattern: Pattern, native: NativeModel) -> None:
        """Curvatures at which the sheet folds through its scales."""
        first = max(math.cos(math.radians(shape)) for shape in self.shapes)
        refuse_folds(pattern, first * self.curvatures[-1])


def compute(
    task: Task[TensorSweepBlock], inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind tensor_sweep; samples that did not converge have a status and no numbers."""
    from flexscale.homogenize.tensor_sweep import tensor_sweep

    return tensor_sweep(
        task.pattern,
        task.block.directions,
        task.block.shapes,
        task.block.curvatures,
        in_plane=task.block.in_plane,
        model=native_of(task, inputs),
        symmetry=task.block.symmetry,
        workers=resources.workers,
        checkpoint=resources.checkpoint,
        on_sample=resources.on_sample,
    )


TENSOR_SWEEP = Step(
    "tensor_sweep",
    1,
    TensorSweepBlock,
    "bending by curvature tensors; {} for defaults",
    compute,
    native=BENT,
    parallel=True,
    resumable=True,
    figures=(
        Figure(
            "tensor_sweep",
            ("tensor_sweep",),
            lambda plot, sweep: plot.tensor_sweep(sweep),
            "Stiffening of the sheet under curvature tensors, and curvature of first contact, "
            "over direction and shape.",
        ),
    ),
)

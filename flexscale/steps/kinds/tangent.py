"""Step `tangent`: stiffness of the flat sheet, in bending and in its plane."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

from pydantic import field_validator

from flexscale.steps.blocks import Directions, increasing
from flexscale.steps.native_inputs import native_of
from flexscale.steps.quantities import declared
from flexscale.steps.step import FLAT, Figure, Resources, Step, StepBlock, Task

if TYPE_CHECKING:
    import xarray as xr


class TangentBlock(StepBlock):
    """Bending stiffness of the flat sheet."""

    takes: ClassVar[tuple[str, ...]] = ("cell",)

    directions: Directions = declared(
        tuple(1.5 * index for index in range(120)),
        "directions at which a is tabulated",
        min_length=1,
    )

    @field_validator("directions")
    @classmethod
    def _directions_increase(cls, values: tuple[float, ...]) -> tuple[float, ...]:
        return increasing(values)


def compute(
    task: Task[TangentBlock], inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind tangent."""
    from flexscale.datasets.kinds.tangent import build_tangent_dataset
    from flexscale.homogenize.build import build_problem
    from flexscale.homogenize.errors_at_rest import note_errors
    from flexscale.homogenize.labels import pattern_scalars
    from flexscale.homogenize.tangent import solve_tangent

    pattern, native = task.pattern, native_of(task, inputs).without_contact
    problem = build_problem(pattern, native)
    tangent = solve_tangent(problem)
    dataset = build_tangent_dataset(
        tangent.matrix,
        tangent.in_plane,
        task.block.directions,
        scalars=pattern_scalars(pattern, native),
        config=task.config,
    )
    note_errors(dataset, pattern, native, problem, tangent)
    return dataset


TANGENT = Step(
    "tangent",
    4,
    TangentBlock,
    "stiffness of the flat sheet; {} for defaults",
    compute,
    native=FLAT,
    implied=True,
    figures=(
        Figure(
            "tangent",
            ("tangent",),
            lambda plot, tangent: plot.stiffness(tangent),
            "Bending stiffness of the flat sheet against direction.",
        ),
    ),
)

"""Step `tensor_model`: the macro model of any bending, from a tensor sweep and a gap model."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar

from flexscale.errors import ConfigError
from flexscale.steps.step import Figure, Resources, Step, StepBlock, Task

if TYPE_CHECKING:
    import xarray as xr

    from flexscale.steps.experiment import Experiment


class TensorModelBlock(StepBlock):
    """Macro model of any bending, fitted to the tensor sweep."""

    takes: ClassVar[tuple[str, ...]] = ("tensor_sweep", "gap_model")

    def refuse_in(self, experiment: Experiment) -> None:
        """A sheet that is held in its plane."""
        if experiment.block("tensor_sweep").in_plane != "free":
            raise ConfigError(
                "tensor_model: it is fitted to sheets that are free in their plane: write "
                "tensor_sweep: {in_plane: free}."
            )


def compute(
    task: Task[TensorModelBlock], inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind tensor_model; samples that did not converge are left out."""
    from flexscale.macro.gap_model import GapModel
    from flexscale.macro.tensor_model import tensor_model

    gaps = GapModel.from_dataset(inputs["gap_model"])
    return tensor_model(inputs["tensor_sweep"], gaps).to_dataset(config=task.config)


TENSOR_MODEL = Step(
    "tensor_model",
    1,
    TensorModelBlock,
    "macro model of any bending; {} for defaults",
    compute,
    figures=(
        Figure(
            "tensor_model",
            ("tensor_model",),
            lambda plot, model: plot.tensor_model(model),
            "Errors of the model's energies over direction, shape and curvature, and at rays that "
            "were held out.",
        ),
    ),
)

"""What blocks on sheets of a macro model share."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from flexscale.errors import BadInputError
from flexscale.mesh.sheet import rectangle_triangles, require_moderate_triangles
from flexscale.steps.quantities import declared
from flexscale.steps.step import StepBlock

if TYPE_CHECKING:
    import xarray as xr

    from flexscale.macro.bending_model import BendingModel
    from flexscale.macro.model import MacroModel


class MacroBlock(StepBlock):
    """On sheets of one macro model: the fit, the gap model, or the tensor model."""

    silent: ClassVar[tuple[str, ...]] = ("model",)

    model: Literal["fit", "gap_model", "tensor_model"] = declared(
        "fit", "block of the macro model: fit, gap_model, tensor_model"
    )

    @property
    def inputs(self) -> tuple[str, ...]:
        """The step whose dataset is the model."""
        return (self.model,)

    def read_model(self, inputs: Mapping[str, xr.Dataset]) -> MacroModel | BendingModel:
        """The model, from the datasets that the step is given."""
        from flexscale.macro.gap_model import GapModel
        from flexscale.macro.model import MacroModel
        from flexscale.macro.tensor_model import TensorModel

        made: dict[str, Any] = {
            "fit": MacroModel,
            "gap_model": GapModel,
            "tensor_model": TensorModel,
        }
        return made[self.model].from_dataset(inputs[self.model])


@contextmanager
def named(place: str) -> Iterator[None]:
    """Names the place in the file where a check of the simulation refuses a value."""
    try:
        yield
    except BadInputError as error:
        raise type(error)(f"{place}: {error}") from error


def refuse_many_triangles(place: str, length: float, width: float, size: float) -> None:
    """Refuse a sheet [mm] of very many triangles."""
    with named(place):
        require_moderate_triangles(rectangle_triangles(length, width, size), size)

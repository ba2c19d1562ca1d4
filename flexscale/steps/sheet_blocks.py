"""Blocks of an experiment file on whole sheets of the fit: between end strips, and on devices.

They check themselves with what the simulations check with, so that bad input is refused before
anything is computed.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated, ClassVar, Self

from pydantic import field_validator, model_validator
from pydantic_core import PydanticCustomError

from flexscale.datasets.variables import VARIANTS
from flexscale.errors import BadInputError
from flexscale.macro.mandrel import ANGLES
from flexscale.macro.polar import Variant
from flexscale.macro.rigs import RigOptions
from flexscale.macro.rim import Rim
from flexscale.mechanics.load_series import SHORTENINGS, require_shortenings
from flexscale.mesh.sheet import rectangle_triangles, require_moderate_triangles
from flexscale.steps.blocks import (
    BendingDirections,
    Block,
    Curvature,
    Curvatures,
    Direction,
    Directions,
    Lengths,
    Sides,
    Size,
    increasing,
)
from flexscale.steps.quantities import declared, several

BOTH = ("closing", "opening")


@contextmanager
def _named(place: str) -> Iterator[None]:
    """Names the place in the file where a check of the simulation refuses a value."""
    try:
        yield
    except BadInputError as error:
        raise type(error)(f"{place}: {error}") from error


def _require_open(curvature: float, length: float) -> None:
    """Refuse a sheet of `length` (mm) that closes to a ring."""
    limit = 2.0 * math.pi / length
    if curvature >= limit:
        raise PydanticCustomError(
            "range",
            "at {kappa} mm-1 a sheet of {length} mm runs into its own end: stay below {limit}",
            {
                "kappa": f"{curvature:g}",
                "length": f"{length:g}",
                "limit": f"{limit:.4g} mm-1",
            },
        )


def _require_moderate(place: str, length: float, width: float, size: float) -> None:
    """Refuse a sheet [mm] of very many triangles."""
    with _named(place):
        require_moderate_triangles(rectangle_triangles(length, width, size), size)


class NativeSheetBlock(Block):
    """A rectangular sheet of scales bent between end strips."""

    length: Size = declared(100.0, "length, along which it is bent", gt=0.0)
    width: Size = declared(50.0, "width", gt=0.0)
    curvatures: Curvatures = declared(
        (0.0, 0.005, 0.01, 0.015, 0.02, 0.025), "curvatures, increasing", min_length=1
    )
    direction: Direction = declared(0.0, "of its length in the pattern's coordinates")
    sides: Sides = declared(BOTH, "sides to bend to: closing, opening", min_length=1)

    @field_validator("curvatures")
    @classmethod
    def _curvatures_increase(cls, values: tuple[float, ...]) -> tuple[float, ...]:
        if values[0] < 0.0:
            raise PydanticCustomError(
                "range", "curvatures are not negative: `sides` says to which side to bend", {}
            )
        return increasing(values)

    @model_validator(mode="after")
    def _does_not_meet_itself(self) -> Self:
        _require_open(self.curvatures[-1], self.length)
        return self


class SheetBlock(NativeSheetBlock):
    """A rectangular sheet of the fit bent between end strips."""

    size: Size = declared(5.0, "sides of the triangles", gt=0.0)

    @model_validator(mode="after")
    def _not_too_fine(self) -> Self:
        _require_moderate("sheet", self.length, self.width, self.size)
        return self


class TurnedSheetBlock(Block):
    """Rectangular sheets between end strips, each with the pattern turned another way on it.

    Models are fitted to the sweep, one for each energy of a curvature tensor.
    """

    length: Size = declared(100.0, "length, along which they are bent", gt=0.0)
    width: Size = declared(50.0, "width", gt=0.0)
    curvature: Curvature = declared(0.02, "curvature of the end strips", gt=0.0)
    directions: BendingDirections = declared(
        tuple(15.0 * index for index in range(12)),
        "of their length in the pattern's coordinates, increasing, from 0 to below 180",
        min_length=1,
    )
    sides: Sides = declared(BOTH, "sides to bend to: closing, opening", min_length=1)
    variants: Annotated[tuple[Variant, ...], several] = declared(
        VARIANTS, "energies of a curvature tensor: tangent, paper", min_length=1
    )
    size: Size = declared(5.0, "sides of the triangles", gt=0.0)

    @field_validator("variants")
    @classmethod
    def _variants_once(cls, values: tuple[str, ...]) -> tuple[str, ...]:
        if len(set(values)) != len(values):
            raise PydanticCustomError("twice", "an energy is named twice", {})
        return values

    @model_validator(mode="after")
    def _does_not_meet_itself(self) -> Self:
        _require_open(self.curvature, self.length)
        _require_moderate("turned_sheet", self.length, self.width, self.size)
        return self


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

    _place: ClassVar[str] = "rigs.stage"

    length: Size = declared(100.0, "length between the hinges", gt=0.0)
    width: Size = declared(50.0, "width", gt=0.0)
    direction: Direction = declared(0.0, "of its length in the pattern's coordinates")
    shortenings: Lengths = declared(
        SHORTENINGS, "by which the hinges come closer, increasing from above 0", min_length=1
    )

    @model_validator(mode="after")
    def _shortenings_in_range(self) -> Self:
        with _named(self._place):
            require_shortenings(self.shortenings, self.length)
        return self


class NativeRigBlock(StageBlock):
    """A strip of scales between two hinges that come closer."""

    _place: ClassVar[str] = "native_rig"

    sides: Sides = declared(BOTH, "sides to bend to: closing, opening", min_length=1)


class RigsBlock(Block):
    """The testing devices, one or both."""

    sides: Sides = declared(BOTH, "sides to bend to: closing, opening", min_length=1)
    size: Size = declared(RigOptions.size, "sides of the triangles", gt=0.0)
    mandrel: MandrelBlock | None = declared(None, "disc on the mandrel; {} for defaults")
    stage: StageBlock | None = declared(None, "strip on the stage; {} for defaults")

    @model_validator(mode="after")
    def _some_device_that_can_work(self) -> Self:
        if self.mandrel is None and self.stage is None:
            raise PydanticCustomError("empty", "`rigs` needs `mandrel`, `stage`, or both", {})
        if self.mandrel is not None:
            with _named("rigs.mandrel"):
                rim = Rim(self.mandrel.radius, self.mandrel.hub, self.size)
                rim.require_indentation(self.mandrel.indentation)
                require_moderate_triangles(6.0 * rim.rings**2, self.size)
                for angle in self.mandrel.angles:
                    rim.place(angle)
        if self.stage is not None:
            _require_moderate("rigs.stage", self.stage.length, self.stage.width, self.size)
        return self

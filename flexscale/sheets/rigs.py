"""What the two virtual testing devices, mandrel and stage, share."""

from __future__ import annotations

from dataclasses import dataclass

from flexscale.checks import checked, choice, length, whole
from flexscale.mechanics.substrate_options import SUBSTRATE_ELEMENTS


@checked(
    element=choice("substrate element", SUBSTRATE_ELEMENTS),
    size=length("element size"),
    steps=whole(1, 1000, "load steps"),
)
@dataclass(frozen=True)
class RigOptions:
    """Options of the mandrel and the stage.

    Attributes
    ----------
    element : "c1", or the paper's linear triangles with "edge_angle".
    size : mm, sides of the triangles.
    steps : equal load steps from the flat disc to the full indentation of the mandrel; the stage
        goes from one shortening to the next.

    Raises
    ------
    UnitRangeError : a size that is not positive, or steps that are not a whole number from 1 on.
    """

    element: str = "c1"
    size: float = 5.0
    steps: int = 2

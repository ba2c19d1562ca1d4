"""Lines of bends from the flat sheet on: what those who follow one ask of it, and the usual one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

import numpy as np

from flexscale.embedding.bends import Bend
from flexscale.sides import SIDE_SIGNS


class BendLine(Protocol):
    """Bends along which a cell or a sheet is followed, from flat to the last one asked for."""

    @property
    def curvatures(self) -> tuple[float, ...]:
        """mm-1, magnitudes of the samples, non-negative and increasing."""

    @property
    def sign(self) -> float:
        """Derivative of the curvature of `bend` by its magnitude: 1 or -1."""

    @property
    def key(self) -> str:
        """Name of the line in a checkpoint."""

    @property
    def measured(self) -> tuple[str, ...]:
        """Names of what `measure` tells."""

    def bend(self, curvature: float) -> Any:
        """The bend at a magnitude of the curvature, mm-1."""

    def measure(self, cell: Any, state: Any) -> dict[str, float]:
        """Numbers of a state of the bent cell that samples have beyond those of all lines."""


AnyLine = TypeVar("AnyLine", bound=BendLine)


@dataclass(frozen=True)
class Line:
    """Samples of one direction and side.

    Attributes
    ----------
    side : "closing" or "opening".
    direction : degrees.
    curvatures : mm-1, non-negative and increasing.
    """

    side: str
    direction: float
    curvatures: tuple[float, ...]

    @property
    def key(self) -> str:
        """Name of the line in a checkpoint."""
        return f"{self.side}-{self.direction!r}"

    @property
    def sign(self) -> float:
        """Of the curvature: closing is positive."""
        return SIDE_SIGNS[self.side]

    @property
    def measured(self) -> tuple[str, ...]:
        """Nothing beyond what samples of all lines have."""
        return ()

    def bend(self, curvature: float) -> Bend:
        """The bend of a sample of this line."""
        return Bend(self.sign * curvature, float(np.radians(self.direction)))

    def measure(self, cell: Any, state: Any) -> dict[str, float]:
        """Nothing, likewise."""
        return {}

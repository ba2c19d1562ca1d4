"""What a line of bends from the flat sheet on is to those who follow it."""

from __future__ import annotations

from typing import Any, Protocol, TypeVar


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

    def accepts(self, cell: Any, state: Any) -> bool:
        """Whether a state found for a sample can be one of the bent cell."""

    def measure(self, cell: Any, state: Any) -> dict[str, float]:
        """Numbers of a state of the bent cell that samples have beyond those of all lines."""


AnyLine = TypeVar("AnyLine", bound=BendLine)

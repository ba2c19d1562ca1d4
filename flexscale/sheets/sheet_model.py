"""What sheets and rigs ask of a macro model."""

from __future__ import annotations

from typing import Protocol

from flexscale.mechanics.sheet_law import SheetLaw


class SheetModel(Protocol):
    """A model fitted to a sweep (`MacroModel`), or of the flat cell alone (`GapModel`)."""

    @property
    def largest_curvature(self) -> float:
        """mm-1, up to which the model is known to hold."""

    def sheet_law(self) -> SheetLaw:
        """Energy per rest area for sheets of the model; BadInputError if it cannot be told."""

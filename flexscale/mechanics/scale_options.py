"""How scales are modeled, by name."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from flexscale.errors import ConfigError, suggest
from flexscale.units import require_positive

SCALE_MODELS = ("modes", "tets")


@dataclass(frozen=True)
class ScaleOptions:
    """How scales are modeled.

    Attributes
    ----------
    model : "modes" (an affine motion and the scale's own responses to loads from sheet and contact,
        from its finite elements at rest) or "tets" (finite elements throughout, as the paper).
    cutoff : a mode is kept if the scale is so much as this, relative to the sheet, that gives way
        along it; smaller takes in more modes.
    """

    model: str = "modes"
    cutoff: float = 1e-2

    def __post_init__(self) -> None:
        if self.model not in SCALE_MODELS:
            raise ConfigError(
                f"There is no scale model '{self.model}'. {suggest(self.model, SCALE_MODELS)}"
            )
        require_positive(self.cutoff, "cutoff of the scale's modes", "1")

    def to_config(self) -> dict[str, Any]:
        """The options as plain numbers and text; `ScaleOptions(**config)` makes them again."""
        return asdict(self)

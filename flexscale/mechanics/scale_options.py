"""How scales are modeled, by name."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from flexscale.checks import checked, choice, number

SCALE_MODELS = ("modes", "tets", "rigid")


@checked(
    model=choice("scale model", SCALE_MODELS),
    cutoff=number("1", 1e-9, 1e9, above=0.0, name="cutoff of the scale's modes"),
)
@dataclass(frozen=True)
class ScaleOptions:
    """How scales are modeled.

    Attributes
    ----------
    model : "modes" (an affine motion and the scale's own responses to loads from sheet and contact,
        from its finite elements at rest), "tets" (finite elements throughout, as the paper) or
        "rigid" (so stiff that it makes no difference).
    cutoff : a mode is kept if the scale is so much as this, relative to the sheet, that gives way
        along it; smaller takes in more modes.
    """

    model: str = "modes"
    cutoff: float = 1e-2

    def to_config(self) -> dict[str, Any]:
        """The options as plain numbers and text; `ScaleOptions(**config)` makes them again."""
        return asdict(self)

"""How the substrate is discretized: what a user may choose."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from flexscale.checks import checked, choice
from flexscale.errors import ConfigError

SUBSTRATE_ELEMENTS = ("c1", "edge_angle")
#: Energies of `shell_law` and of `layered_law`.
BENDING_MEASURES = ("turn", "layers")
DEFAULT_MEASURE = "layers"


@checked(
    element=choice("substrate element", SUBSTRATE_ELEMENTS),
    bending_measure=choice("bending measure", BENDING_MEASURES),
)
@dataclass(frozen=True)
class SubstrateOptions:
    """How the substrate is discretized.

    Attributes
    ----------
    element : "c1" smooth triangles; or the paper's linear triangles, bent by "edge_angle" (one
        normal angle per edge), for comparison: they need many more.
    bending_measure : of "c1" triangles: "layers" integrates the material's energy over the
        thickness, so that no fiber can be pressed to nothing; with "turn" a bending energy is
        added to that of the midsurface, quadratic in the turn of the normal per rest length. They
        differ where the sheet is bent or stretched much.
    """

    element: str = "c1"
    bending_measure: str | None = None

    def __post_init__(self) -> None:
        if self.element == "c1" and self.bending_measure is None:
            object.__setattr__(self, "bending_measure", DEFAULT_MEASURE)
        if self.element != "c1" and self.bending_measure is not None:
            raise ConfigError(
                f"The bending measure {self.bending_measure!r} is for the element 'c1'; the "
                f"element {self.element!r} has its own, leave bending_measure out."
            )

    def to_config(self) -> dict[str, Any]:
        """Plain text, only what the element has; `SubstrateOptions(**config)` makes them again."""
        return {name: value for name, value in asdict(self).items() if value is not None}

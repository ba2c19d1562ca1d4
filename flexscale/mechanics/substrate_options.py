"""How the substrate is discretized: what a user may choose."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from flexscale.errors import ConfigError, UnknownNameError, suggest

SUBSTRATE_ELEMENTS = ("c1", "edge_angle", "averaged_normals")
BENDING_MEASURES = ("turn", "form", "curvature")  # numbered as in `shell_law`


@dataclass(frozen=True)
class SubstrateOptions:
    """How the substrate is discretized.

    Attributes
    ----------
    element : "c1" smooth triangles; the paper's linear triangles, bent by "edge_angle" (one normal
        angle per edge) or by "averaged_normals" (none), for comparison: they need many more.
    bending_measure : of "c1" triangles, what the bending energy is quadratic in: "turn" of the
        normal per rest length, second "form", or "curvature", the turn per deformed length; they
        differ where the sheet is stretched much.
    """

    element: str = "c1"
    bending_measure: str = "turn"

    def __post_init__(self) -> None:
        for what, given, known in (
            ("substrate element", self.element, SUBSTRATE_ELEMENTS),
            ("bending measure", self.bending_measure, BENDING_MEASURES),
        ):
            if given not in known:
                raise UnknownNameError(f"There is no {what} {given!r}. {suggest(given, known)}")
        if self.element != "c1" and self.bending_measure != "turn":
            raise ConfigError(
                f"The bending measure {self.bending_measure!r} is for the element 'c1'; the "
                f"element {self.element!r} has its own, leave bending_measure out."
            )

    def to_config(self) -> dict[str, Any]:
        """Plain text; `SubstrateOptions(**config)` makes them again."""
        return asdict(self)

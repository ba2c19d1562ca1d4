"""How the substrate is discretized: what a user may choose."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from flexscale.errors import UnknownNameError, suggest

SUBSTRATE_ELEMENTS = ("c1", "edge_angle", "averaged_normals")


@dataclass(frozen=True)
class SubstrateOptions:
    """How the substrate is discretized.

    Attributes
    ----------
    element : "c1" smooth triangles; the paper's linear triangles, bent by "edge_angle" (one normal
        angle per edge) or by "averaged_normals" (none), for comparison: they need many more.
    """

    element: str = "c1"

    def __post_init__(self) -> None:
        if self.element not in SUBSTRATE_ELEMENTS:
            raise UnknownNameError(
                f"There is no substrate element {self.element!r}. "
                f"{suggest(self.element, SUBSTRATE_ELEMENTS)}"
            )

    def to_config(self) -> dict[str, Any]:
        """Plain text; `SubstrateOptions(**config)` makes them again."""
        return asdict(self)

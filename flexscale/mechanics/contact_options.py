"""How scales touch: what a user may choose."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

from flexscale.errors import ConfigError, UnitRangeError
from flexscale.units import require_positive, require_range


@dataclass(frozen=True)
class ContactOptions:
    """How scales touch.

    Attributes
    ----------
    enabled : False leaves contact out; scales may then pass through each other.
    activation : d_hat as a fraction of the gap.
    stiffness : factor on the barrier stiffness chosen from the sheet's own forces.
    edge : mm, radius of the part of a scale's surface over which a neighbor that touches a point of
        it presses: a printed edge is rounded by about the width of the nozzle. 0 presses at points;
        scales then give way the more the finer their mesh.
    """

    enabled: bool = True
    activation: float = 0.005
    stiffness: float = 1.0
    edge: float = 0.4

    def __post_init__(self) -> None:
        if not isinstance(self.enabled, bool):
            raise ConfigError(f"Contact option enabled is {self.enabled!r}: give true or false.")
        require_positive(self.activation, "contact activation", "gap")
        require_positive(self.stiffness, "contact stiffness", "1")
        require_range(self.edge, "contact edge", "mm", 0.0, math.inf)
        if self.activation >= 1.0:
            raise UnitRangeError(
                f"The contact activation is {self.activation:g} gaps, so that scales would touch "
                "at rest: give less than 1 (0.005 to 0.01 keeps the onset within 1 %)."
            )

    def to_config(self) -> dict[str, Any]:
        """Plain numbers; `ContactOptions(**config)` makes them again."""
        return asdict(self)

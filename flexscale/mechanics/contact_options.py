"""How scales touch: what a user may choose."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from flexscale.errors import ConfigError, UnitRangeError
from flexscale.units import require_positive


@dataclass(frozen=True)
class ContactOptions:
    """How scales touch.

    Attributes
    ----------
    enabled : False leaves contact out; scales may then pass through each other.
    activation : d_hat as a fraction of the gap.
    stiffness : factor on the barrier stiffness chosen from the sheet's own forces.
    """

    enabled: bool = True
    activation: float = 0.005
    stiffness: float = 1.0

    def __post_init__(self) -> None:
        if not isinstance(self.enabled, bool):
            raise ConfigError(f"Contact option enabled is {self.enabled!r}: give true or false.")
        require_positive(self.activation, "contact activation", "gap")
        require_positive(self.stiffness, "contact stiffness", "1")
        if self.activation >= 1.0:
            raise UnitRangeError(
                f"The contact activation is {self.activation:g} gaps, so that scales would touch "
                "at rest: give less than 1 (0.005 to 0.01 keeps the onset within 1 %)."
            )

    def to_config(self) -> dict[str, Any]:
        """Plain numbers; `ContactOptions(**config)` makes them again."""
        return asdict(self)

"""How scales touch: what a user may choose."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from flexscale.checks import checked, flag, number
from flexscale.units import LENGTHS


def _enabled(value: Any, label: str) -> bool:
    """Check of whether there is contact, which says what the flag is of."""
    return flag(value, "contact option enabled")


@checked(
    enabled=_enabled,
    activation=number("gap", 1e-6, 0.9, above=0.0, name="contact activation"),
    stiffness=number("1", 1e-6, 1e6, above=0.0, name="contact stiffness"),
    edge=number("mm", 0.0, LENGTHS[1], name="contact edge"),
)
@dataclass(frozen=True)
class ContactOptions:
    """How scales touch.

    Attributes
    ----------
    enabled : False leaves contact out; scales may then pass through each other.
    activation : d_hat as a fraction of the gap, at most 0.9, since at 1 scales would touch at rest;
        0.005 to 0.01 keeps the onset within 1 %.
    stiffness : factor on the barrier stiffness chosen from the sheet's own forces.
    edge : mm, radius of the part of a scale's surface over which a neighbor that touches a point of
        it presses: a printed edge is rounded by about the width of the nozzle. 0 presses at points;
        scales then give way the more the finer their mesh.
    """

    enabled: bool = True
    activation: float = 0.005
    stiffness: float = 1.0
    edge: float = 0.4

    def to_config(self) -> dict[str, Any]:
        """Plain numbers; `ContactOptions(**config)` makes them again."""
        return asdict(self)

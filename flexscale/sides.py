"""The two sides to which a sheet is bent: closing towards the scales, opening away from them."""

from __future__ import annotations

from typing import Any

from flexscale.checks import choice, choices, require_choice

#: Sign of the curvature, scales on +n.
SIDE_SIGNS = {"closing": 1.0, "opening": -1.0}
SIDES = tuple(SIDE_SIGNS)
#: Checks of a side, and of one or both.
ONE_SIDE = choice("side", SIDES)
SOME_SIDES = choices("side", SIDES)


def one_side_or_some(given: Any, name: str) -> str | tuple[str, ...]:
    """A check of one side by its name, or of several."""
    check = ONE_SIDE if isinstance(given, str) else SOME_SIDES
    found: str | tuple[str, ...] = check(given, name)
    return found


def side_sign(side: str) -> float:
    """+1 for "closing", -1 for "opening"; UnknownNameError for any other side."""
    return SIDE_SIGNS[require_choice(side, "side", SIDES)]

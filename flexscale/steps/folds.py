"""Curvatures that no sheet can have, whatever it is computed with."""

from __future__ import annotations

import math

from pydantic_core import PydanticCustomError

from flexscale.errors import UnitRangeError
from flexscale.patterns.pattern import Pattern


def refuse_folds(pattern: Pattern, curvature: float) -> None:
    """Refuse a closing curvature [mm-1] at which the bending center lies inside the scales."""
    limit = 1.0 / pattern.scale_height
    if curvature >= limit:
        raise UnitRangeError(
            f"at a closing curvature of {curvature:g} mm-1 the bending center lies inside the "
            f"scales, which are {pattern.scale_height:g} mm high: stay below {limit:g} mm-1."
        )


def require_open(curvature: float, length: float) -> None:
    """Refuse a sheet of a length [mm] that a curvature [mm-1] closes to a ring."""
    limit = 2.0 * math.pi / length
    if curvature >= limit:
        raise PydanticCustomError(
            "range",
            "at {kappa} mm-1 a sheet of {length} mm runs into its own end: stay below {limit}",
            {
                "kappa": f"{curvature:g}",
                "length": f"{length:g}",
                "limit": f"{limit:.4g} mm-1",
            },
        )

"""Series of loads as a user asks for them: what is refused before anything is computed."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from flexscale.errors import BadInputError, UnitRangeError
from flexscale.mechanics.energy import FloatArray
from flexscale.units import require_finite, require_positive

#: mm, how far the hinges of a stage have come closer if nothing else is said.
SHORTENINGS = (0.5, 1.0, 2.0, 4.0, 7.0, 10.0, 15.0, 20.0, 25.0, 30.0)


def finite_series(values: ArrayLike, name: str, unit: str) -> FloatArray:
    """(n,) floats from one number or a list; UnitRangeError for none, or one that is not finite."""
    series = np.atleast_1d(np.asarray(values, dtype=float))
    if series.ndim != 1 or not len(series):
        raise UnitRangeError(f"{name} must be one or more numbers in {unit}, not {values!r}.")
    for value in series.tolist():
        require_finite(value, name, unit)
    return series


def require_shortenings(shortenings: ArrayLike, length: float) -> FloatArray:
    """(n,) shortenings [mm] of a strip of a length [mm].

    Raises
    ------
    UnitRangeError : none, or one that is not finite, or the first is not positive.
    BadInputError : they do not increase, or reach the length.
    """
    asked = finite_series(shortenings, "shortening", "mm")
    require_positive(float(asked[0]), "shortening", "mm")  # flat strips carry any force
    if (np.diff(asked) <= 0.0).any():
        raise BadInputError(
            f"Shortenings must increase, in mm, not {asked.tolist()}: the strip is followed from "
            "one to the next."
        )
    if asked[-1] >= length:
        raise BadInputError(
            f"A shortening of {asked[-1]:.12g} mm is more than a strip of {length:.12g} mm has: "
            "stay below its length."
        )
    return asked

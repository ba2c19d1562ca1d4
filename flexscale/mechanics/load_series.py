"""Series of loads as a user asks for them: what is refused before anything is computed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from flexscale.arrays import FloatArray
from flexscale.errors import BadInputError, UnitRangeError
from flexscale.units import require_increasing, require_positive, require_series

#: mm, how far the hinges of a stage have come closer if nothing else is said.
SHORTENINGS = (0.5, 1.0, 2.0, 4.0, 7.0, 10.0, 15.0, 20.0, 25.0, 30.0)
#: degree, where the mandrel pushes the rim of a disc of scales if nothing else is said.
RIM_ANGLES = tuple(5.0 * k for k in range(72))

#: Rays of a tensor sweep if nothing else is said: degree, degree and mm-1. Directions map to
#: themselves by the symmetry of two-, three-, four- and sixfold patterns; shapes have cylinders,
#: domes and saddles.
RAY_DIRECTIONS = tuple(10.0 * k for k in range(18))
RAY_SHAPES = tuple(-135.0 + 9.0 * k for k in range(21))
RAY_CURVATURES = tuple(round(0.001 * k, 3) for k in range(31))


def finite_series(values: ArrayLike, name: str, unit: str) -> FloatArray:
    """(n,) floats from one number or a list; UnitRangeError for none, or one that is not finite."""
    return np.array(require_series(values, name, unit))


def require_bends(curvatures: Sequence[float]) -> None:
    """Refuse curvatures [mm-1] that do not increase from 0 or more on."""
    require_increasing(curvatures, "curvatures", "mm-1")
    if curvatures[0] < 0.0:
        raise UnitRangeError(
            f"A curvature of {curvatures[0]:g} mm-1 is negative: the side says to which side the "
            "sheet is bent."
        )


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

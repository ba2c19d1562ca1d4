"""One warning where a law is asked beyond the curvatures that it was fitted to."""

from __future__ import annotations

import logging

import numpy as np
from numpy.typing import ArrayLike

log = logging.getLogger(__name__)

_ROUNDING = 1e-9  # relative; curvatures that are typed and those that are computed may differ so


def warn_beyond(what: str, curvatures: ArrayLike, limit: float, where: str = "") -> None:
    """Log one warning if a curvature is beyond the data of the law.

    Parameters
    ----------
    what : what bends, for people: "The disc on the mandrel bends".
    curvatures : mm-1, magnitudes; nan, for what did not converge, does not count.
    limit : mm-1, the largest curvature that the law was fitted to.
    where : place of the largest curvature, such as "at (1.0, 2.0) mm".
    """
    values = np.asarray(curvatures, dtype=float)
    largest = float(np.nanmax(values, initial=0.0))
    if largest > limit * (1.0 + _ROUNDING):
        log.warning(
            "%s to %.4g mm-1%s, but the law was fitted up to %.4g mm-1: what lies beyond is "
            "extrapolated.", what, largest, f" {where}" if where else "", limit,
        )  # fmt: skip

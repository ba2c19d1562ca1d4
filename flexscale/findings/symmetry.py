"""The symmetry of a pattern as its sweep made use of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr


@dataclass(frozen=True)
class DirectionSymmetry:
    """period : degree after which the response repeats, 180 for any sheet, 90 for four-fold, 60
    for three- and six-fold patterns; mirrors : degree in [0, 90), axes of reflection (that at
    +90 degree is one too).
    """

    period: float
    mirrors: tuple[float, ...]


def direction_symmetry(sweep: xr.Dataset) -> DirectionSymmetry:
    """Rotations and reflections that map directions of a sweep onto equivalent ones.

    Parameters
    ----------
    sweep : dataset of kind sweep at even steps on [0, 180). Its `symmetry_source` names the
        direction that was solved for each one; a sweep that solved all shows no symmetry.
    """
    direction = np.asarray(sweep["direction"].values, dtype=float)
    source = np.round(sweep["symmetry_source"].transpose("side", "direction").values, 6)
    n = len(direction)
    places = np.arange(n)
    period = next(
        step
        for step in range(1, n + 1)
        if n % step == 0 and np.array_equal(np.roll(source, step, axis=1), source)
    )
    mirrors = {
        round((direction[0] + 90.0 * turn / n) % 90.0, 6)
        for turn in range(n)
        if np.array_equal(source[:, (turn - places) % n], source)
    }
    # With one sample a period, every direction is its own image.
    return DirectionSymmetry(180.0 * period / n, tuple(sorted(mirrors)))

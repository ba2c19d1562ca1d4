"""Numbers that tell what a response looks like over directions and curvatures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from flexscale.arrays import FloatArray

LEAST_LOBE = 0.05
_ORDER = ("side", "direction", "curvature")


def spread(values: FloatArray) -> float:
    """Largest minus smallest value, relative to the mean; 0 is isotropic."""
    return float(np.ptp(values) / np.mean(values))


def lobes(directions: FloatArray, values: FloatArray) -> list[float]:
    """Directions (degree) of the maxima of a response of period 180 degree.

    Parameters
    ----------
    directions : (n,) degree in [0, 180), increasing.
    values : (n,). A maximum counts if it rises by LEAST_LOBE of the mean above both valleys that
        part it from higher ones.
    """
    n = len(values)
    least = LEAST_LOBE * float(np.mean(values))
    found = []
    for i in range(n):
        if values[i] <= values[i - 1] or values[i] < values[(i + 1) % n]:
            continue  # of equal neighbors the first one counts
        valleys = []
        for step in (-1, 1):
            lowest = values[i]
            for k in range(1, n):
                other = values[(i + step * k) % n]
                if other > values[i]:
                    break
                lowest = min(lowest, other)
            valleys.append(lowest)
        if values[i] - max(valleys) >= least:
            found.append(float(directions[i]))
    return found


def harmonic_shares(values: FloatArray) -> FloatArray:
    """Amplitudes of cos and sin of 2 k direction, k = 1, 2, …, relative to the mean.

    Parameters
    ----------
    values : (n,) at even steps of direction on [0, 180).
    """
    amplitudes = np.abs(np.fft.rfft(values)) / len(values)
    return np.asarray(2.0 * amplitudes[1:] / amplitudes[0])


@dataclass(frozen=True)
class Stiffening:
    """What contact does to the slope of the moment in one direction.

    gain : largest slope in contact over that of the last interval free of it; rest_gain : over the
    slope at rest; 1 is no stiffening, nan where scales do not touch (or already do at rest).
    """

    direction: float
    touches: bool
    gain: float
    rest_gain: float


def stiffening(sweep: xr.Dataset, side: str) -> list[Stiffening]:
    """Per direction of one side of a sweep, from converged samples."""
    one = sweep.sel(side=side)
    moments = one["moment"].transpose(*_ORDER[1:]).values
    pairs = one["contact_pairs"].transpose(*_ORDER[1:]).values
    kappa = np.asarray(sweep["curvature"].values, dtype=float)
    return [
        _stiffening(float(direction), kappa, moments[row], pairs[row] > 0)
        for row, direction in enumerate(sweep["direction"].values)
    ]


def _stiffening(
    direction: float, kappa: FloatArray, moment: FloatArray, touching: NDArray[np.bool_]
) -> Stiffening:
    done = np.isfinite(moment)
    kappa, moment, touching = kappa[done], moment[done], touching[done]
    first = int(np.argmax(touching)) if touching.any() else 0
    if first < 2:  # no contact, or no interval free of it
        return Stiffening(direction, bool(touching.any()), np.nan, np.nan)
    slopes = np.diff(moment) / np.diff(kappa)
    # Contact begins somewhere in the interval first - 1, whose slope mixes both regimes.
    largest = float(slopes[first - 1 :].max())
    return Stiffening(
        direction, True, largest / float(slopes[first - 2]), largest / float(slopes[0])
    )


def contact_curvatures(sweep: xr.Dataset, side: str) -> list[float]:
    """Curvatures (mm-1) at which all directions have results and scales touch in at least one."""
    one = sweep.sel(side=side)
    known = one["moment"].notnull().all("direction").values
    touching = (one["contact_pairs"] > 0).any("direction").values
    return [float(value) for value in sweep["curvature"].values[known & touching]]


def moments(sweep: xr.Dataset, side: str, curvature: float) -> FloatArray:
    """(n_directions,) N at a stored curvature (mm-1)."""
    return np.asarray(sweep["moment"].sel(side=side, curvature=curvature).values, dtype=float)


def smallest_curvature(sweep: xr.Dataset, side: str) -> float:
    """Least stored curvature (mm-1) above 0 that has results in all directions."""
    return _known(sweep, side)[0]


def largest_curvature(sweep: xr.Dataset, side: str) -> float:
    """Largest stored curvature (mm-1) that has results in all directions."""
    return _known(sweep, side)[-1]


def _known(sweep: xr.Dataset, side: str) -> list[float]:
    done = sweep["moment"].sel(side=side).notnull().all("direction").values
    kappa = sweep["curvature"].values
    return [float(value) for value in kappa[done & (kappa > 0.0)]]

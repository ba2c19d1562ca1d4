"""How contact sets in, direction by direction, read off a sweep's moments.

The two-regime law [Eq. 10] has one curvature kappa_0 at which the stiffness jumps from a to b.
Where scales meet face to face at once it does; where they meet at corners first, or one neighbor
after the other, stiffness grows over a range of curvatures, which the paper names as a limit of its
law. Here that range is measured: from where the slope of the moment has gained a tenth of what
contact adds to it in all to where it has gained nine tenths.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from flexscale.arrays import FloatArray
from flexscale.checks import DATASET, checked
from flexscale.datasets.given import require_variables
from flexscale.errors import MissingDataError

BEGUN, DONE = 0.1, 0.9  # shares of the gain in slope
_LEAST_GAIN = 0.1  # of the slope before contact; less is no stiffening by contact

_NEEDED = ("moment", "min_gap", "contact_pairs", "side", "direction", "curvature")
_VARIABLES = {
    "free_until": ("mm-1", "largest sampled curvature before scales touch"),
    "touches_from": ("mm-1", "smallest sampled curvature at which scales touch"),
    "onset_begin": ("mm-1", "curvature at which a tenth of the stiffening by contact is reached"),
    "onset_end": ("mm-1", "curvature at which nine tenths of it are reached"),
    "onset_spread": ("1", "range of curvatures over which contact sets in, relative to its middle"),
    "onset_resolution": ("1", "the spread that the sweep's samples show of a sudden onset"),
}


@checked(sweep=DATASET)
def contact_onset(sweep: xr.Dataset) -> xr.Dataset:
    """When and how gradually scales touch, per side and direction.

    Parameters
    ----------
    sweep : dataset of kind sweep/1 with contact.

    Returns
    -------
    Dataset over (side, direction) with the variables free_until, touches_from, onset_begin,
    onset_end [mm-1], onset_spread and onset_resolution [1]. All nan where scales do not touch; the
    last four also where contact stiffens the sheet by less than a tenth, or where fewer than two
    samples follow the first one in contact. A spread no larger than the resolution is a sudden
    onset as far as the samples tell.

    Raises
    ------
    MissingDataError : the sweep was made without contact.
    """
    require_variables(sweep, _NEEDED, "The onset of contact", "sweep")
    # Without contact there are no distances, and the counts of pairs are zeros.
    solved = sweep["moment"].notnull()
    if solved.any() and sweep["min_gap"].isnull().all():
        raise MissingDataError("This sweep was made without contact: there is no onset to measure.")
    order = ("side", "direction", "curvature")
    moment = sweep["moment"].transpose(*order).values
    touches = sweep["contact_pairs"].transpose(*order).values > 0
    kappa = sweep["curvature"].values.astype(float)
    found = np.full((len(_VARIABLES), *moment.shape[:2]), np.nan)
    for i, j in np.ndindex(*moment.shape[:2]):
        done = np.isfinite(moment[i, j])
        found[:, i, j] = _onset(kappa[done], moment[i, j][done], touches[i, j][done])
    result = xr.Dataset(coords={name: sweep[name] for name in ("side", "direction")})
    for (name, (units, long_name)), values in zip(_VARIABLES.items(), found, strict=True):
        result[name] = (("side", "direction"), values, {"units": units, "long_name": long_name})
    return result


def _onset(kappa: FloatArray, moment: FloatArray, touches: np.ndarray) -> list[float]:
    """The variables of one line, in order."""
    nothing = [np.nan] * len(_VARIABLES)
    if not touches.any() or touches[0]:
        return nothing
    first = int(np.argmax(touches))
    bounds = [float(kappa[first - 1]), float(kappa[first])]
    if first < 2 or len(kappa) - first < 3:
        return bounds + nothing[2:]
    slopes = np.diff(moment) / np.diff(kappa)
    middles = 0.5 * (kappa[1:] + kappa[:-1])
    # Slopes from the last interval without contact on; waves that strips make do not undo contact.
    before = slopes[first - 2]
    gains = np.maximum.accumulate(slopes[first - 2 :] - before)
    if gains[-1] < _LEAST_GAIN * abs(before):
        return bounds + nothing[2:]
    shares = gains / gains[-1]
    begin, end = (float(_crossing(middles[first - 2 :], shares, share)) for share in (BEGUN, DONE))
    middle = 0.5 * (begin + end)
    steps = np.diff(middles[first - 2 :])
    # A kink inside an interval shows in the slopes of that and of the next one.
    sudden = (DONE - BEGUN) * float(steps[:2].sum())
    return [*bounds, begin, end, (end - begin) / middle, sudden / middle]


def _crossing(places: FloatArray, shares: FloatArray, share: float) -> float:
    """Where a rising, piecewise linear function first reaches `share`."""
    k = int(np.argmax(shares >= share))
    rise = shares[k] - shares[k - 1]
    return places[k - 1] + (share - shares[k - 1]) / rise * (places[k] - places[k - 1])

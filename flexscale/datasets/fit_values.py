"""What the numbers of a fit mean: the paper's two-regime law and its circular harmonics.

Plots read fits from here without the model; the model (`flexscale.macro`) evaluates the same lines.
"""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from flexscale.arrays import FloatArray

PARAMETERS = ("a", "b", "kappa_0")
#: What the harmonics of kappa_0 interpolate: itself, its inverse (0 = no contact), or nothing.
ONSET_QUANTITIES = ("kappa_0", "1/kappa_0", "none")


def two_regime_moment(
    curvature: ArrayLike,
    a: ArrayLike,
    b: ArrayLike,
    kappa_0: ArrayLike,
    softening: ArrayLike = 0.0,
) -> FloatArray:
    """Bending moment per width [Eq. 10]; all arguments broadcast.

    Parameters
    ----------
    curvature : mm-1, non-negative.
    a, b : N mm, stiffness before and after contact.
    kappa_0 : mm-1, contact curvature; nan where there is no contact, b is then not used.
    softening : mm N-1, s: what comes before contact, of energy E = a κ²/2, goes as log(1 + s E)/s.
        0 is Eq. 10.

    Returns
    -------
    N, continuous at kappa_0; its slope is not.
    """
    kappa = np.asarray(curvature, dtype=float)
    beyond, extra = _beyond(kappa, a, b, kappa_0)
    linear = np.asarray(a) * kappa
    return np.asarray(
        linear / (1.0 + 0.5 * np.asarray(softening) * linear * kappa) + extra * beyond
    )


def two_regime_energy(
    curvature: ArrayLike,
    a: ArrayLike,
    b: ArrayLike,
    kappa_0: ArrayLike,
    softening: ArrayLike = 0.0,
) -> FloatArray:
    """Energy per area, N mm-1: the integral of `two_regime_moment` over the curvature."""
    kappa = np.asarray(curvature, dtype=float)
    beyond, extra = _beyond(kappa, a, b, kappa_0)
    energy = 0.5 * np.asarray(a) * kappa**2
    s = np.asarray(softening, dtype=float)
    soft = np.where(s > 0.0, np.log1p(s * energy) / np.where(s > 0.0, s, 1.0), energy)
    return np.asarray(soft + 0.5 * extra * beyond**2)


def _beyond(
    kappa: FloatArray, a: ArrayLike, b: ArrayLike, kappa_0: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Curvature beyond contact, and the stiffness that contact adds; 0 where there is none."""
    onset = np.asarray(kappa_0, dtype=float)
    touches = ~np.isnan(onset)
    beyond = np.maximum(kappa - np.where(touches, onset, np.inf), 0.0)
    return beyond, np.where(touches, np.asarray(b, dtype=float) - np.asarray(a, dtype=float), 0.0)


def harmonic_sum(cosine: ArrayLike, sine: ArrayLike, directions: ArrayLike) -> FloatArray:
    """Sum of cosine_k cos(2 k d) + sine_k sin(2 k d), which is Eq. 11 in linear form.

    Parameters
    ----------
    cosine, sine : (n + 1,) coefficients of order k = 0 … n.
    directions : any shape, degree.
    """
    order = np.arange(np.size(cosine))
    angle = 2.0 * np.deg2rad(np.asarray(directions, dtype=float))[..., None] * order
    return np.asarray(np.cos(angle) @ np.asarray(cosine) + np.sin(angle) @ np.asarray(sine))


def onset_curvature(quantity: str, harmonics: FloatArray, largest: float = np.inf) -> FloatArray:
    """kappa_0 (mm-1) from its evaluated harmonics; nan where there is no contact.

    Parameters
    ----------
    quantity : of ONSET_QUANTITIES.
    harmonics : evaluated in each direction; mm-1 for kappa_0, mm for its inverse.
    largest : mm-1, contact beyond it counts as none.
    """
    if quantity == "none":
        return np.full(np.shape(harmonics), np.nan)
    if quantity == "1/kappa_0":
        safe = np.where(harmonics > 0.0, harmonics, 1.0)
        harmonics = np.where(harmonics > 0.0, 1.0 / safe, np.inf)
    return np.where((harmonics < largest) & np.isfinite(harmonics), harmonics, np.nan)


def fit_parameters(fit: xr.Dataset, side: str, directions: ArrayLike) -> dict[str, FloatArray]:
    """Fitted a, b (N mm) and kappa_0 (mm-1) of one side in any directions.

    Parameters
    ----------
    fit : dataset of kind fit.
    side : one the fit has.
    directions : degree.

    Returns
    -------
    By parameter, shaped as `directions`; b and kappa_0 are nan where no contact was seen. With the
    fit's `softening` they are the arguments of `two_regime_moment`.
    """
    one = fit.sel(side=side)
    values = {
        name: harmonic_sum(
            one["cos_coefficient"].sel(parameter=name).values,
            one["sin_coefficient"].sel(parameter=name).values,
            directions,
        )
        for name in PARAMETERS
    }
    values["kappa_0"] = onset_curvature(
        str(one["onset_quantity"].values), values["kappa_0"], float(fit["largest_curvature"])
    )
    values["b"] = np.where(np.isnan(values["kappa_0"]), np.nan, values["b"])
    return values

"""How far a fit is from its samples, also from samples that it was not given."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.datasets.variables import ASSESSMENTS, STATISTICS, Weighting
from flexscale.macro.flat_response import FlatResponse
from flexscale.macro.polar import DirectionalLaws, PolarLaw, fit_directions
from flexscale.macro.refine import fit_refined
from flexscale.macro.samples import Samples
from flexscale.macro.uniaxial import UniaxialLaw

__all__ = ["ASSESSMENTS", "STATISTICS", "FitErrors", "assess"]


@dataclass(frozen=True)
class FitErrors:
    """Errors over samples at curvatures above 0, for (t) assessments.

    The assessments are "law" (Eq. 10 in each sampled direction), "model" (with the harmonics of
    Eq. 11), "held_out_curvature" (the model refitted without each inner curvature, at the
    curvature left out) and "held_out_direction" (refitted without each direction and its copies
    by symmetry, at the directions left out). The statistics (q) of the relative moment error
    |fit − native| / |native| are "median", "percentile_95" and "worst". Nan where nothing could
    be assessed, as when too few directions remain.

    Attributes
    ----------
    energy_rmse, moment_rmse : (t, s, d) N mm-1, N, per side and direction.
    moment_error : (t, s, d, q) relative, per side and direction.
    overall_energy_rmse, overall_moment_rmse : (t, s) over all directions.
    overall_moment_error : (t, s, q) over all directions.
    """

    energy_rmse: FloatArray
    moment_rmse: FloatArray
    moment_error: FloatArray
    overall_energy_rmse: FloatArray
    overall_moment_rmse: FloatArray
    overall_moment_error: FloatArray


def assess(
    samples: Samples,
    laws: DirectionalLaws,
    polar: PolarLaw,
    weighting: Weighting,
    flat: FlatResponse | None = None,
) -> FitErrors:
    """All errors of a fit; refits it once per curvature and per computed direction.

    `flat` : response without contact, where the fit was given it.
    """
    predictions = {
        "law": _predict(samples, lambda side: laws.law(side)),
        "model": _predict_polar(samples, polar),
        "held_out_curvature": _without_curvatures(samples, laws, weighting, flat),
        "held_out_direction": _without_directions(samples, laws, weighting, flat),
    }
    energy, moment = (
        np.stack([predictions[name][part] for name in ASSESSMENTS]) for part in (0, 1)
    )
    used = samples.used
    energy_off = np.where(used, energy - samples.energy, np.nan)
    moment_off = np.where(used, moment - samples.moment, np.nan)
    relative = np.abs(moment_off) / np.where(used, np.abs(samples.moment), np.nan)
    by_side = (len(ASSESSMENTS), len(samples.sides), -1)
    return FitErrors(
        _rms(energy_off),
        _rms(moment_off),
        _statistics(relative),
        _rms(energy_off.reshape(by_side)),
        _rms(moment_off.reshape(by_side)),
        _statistics(relative.reshape(by_side)),
    )


Prediction = tuple[FloatArray, FloatArray]


def _predict(samples: Samples, law_of: Callable[[int], UniaxialLaw]) -> Prediction:
    """Energies and moments (s, d, c) of laws with one entry per sampled direction."""
    energy, moment = [], []
    for side in range(len(samples.sides)):
        law = law_of(side)
        a, b, kappa_0 = (np.asarray(x)[:, None] for x in (law.a, law.b, law.kappa_0))
        columns = UniaxialLaw(a, b, kappa_0, law.softening)
        energy.append(columns.energy(samples.curvatures))
        moment.append(columns.moment(samples.curvatures))
    return np.stack(energy), np.stack(moment)


def _predict_polar(samples: Samples, polar: PolarLaw) -> Prediction:
    return _predict(samples, lambda side: polar.law(samples.directions, side))


def _without_curvatures(
    samples: Samples, laws: DirectionalLaws, weighting: Weighting, flat: FlatResponse | None
) -> Prediction:
    """At each curvature but the last (beyond it would be extrapolation), the model without it."""
    energy, moment = np.full_like(samples.energy, np.nan), np.full_like(samples.moment, np.nan)
    contact = np.isfinite(laws.kappa_0)
    for index in range(len(samples.curvatures) - 1):
        fewer = samples.without_curvature(index)
        again = fit_directions(fewer, weighting, flat, contact)
        polar = fit_refined(again, fewer, weighting, flat)
        if polar is None:
            continue
        # Lines that lost their only sample before the onset no longer know it.
        known = again.n_before > 0
        guess = _predict_polar(samples, polar)
        energy[..., index] = np.where(known, guess[0][..., index], np.nan)
        moment[..., index] = np.where(known, guess[1][..., index], np.nan)
    return energy, moment


def _without_directions(
    samples: Samples, laws: DirectionalLaws, weighting: Weighting, flat: FlatResponse | None
) -> Prediction:
    """In each computed direction and its copies, the model without them."""
    energy, moment = np.full_like(samples.energy, np.nan), np.full_like(samples.moment, np.nan)
    for source in np.unique(samples.sources):
        left_out = samples.sources == source
        polar = fit_refined(laws, samples, weighting, flat, ~left_out)
        if polar is not None:
            guess = _predict_polar(samples, polar)
            energy[:, left_out], moment[:, left_out] = guess[0][:, left_out], guess[1][:, left_out]
    return energy, moment


def _rms(off: FloatArray) -> FloatArray:
    """Root mean square over the last axis, nan ignored; nan where there is nothing else."""
    count = np.isfinite(off).sum(axis=-1)
    total = np.where(np.isfinite(off), off, 0.0)
    mean = np.sum(total**2, axis=-1) / np.maximum(count, 1)
    return np.where(count > 0, np.sqrt(mean), np.nan)


def _statistics(values: FloatArray) -> FloatArray:
    """(…, q) median, 95th percentile and worst over the last axis, nan ignored."""
    result = np.full((*values.shape[:-1], len(STATISTICS)), np.nan)
    for index in np.ndindex(values.shape[:-1]):
        known = values[index][np.isfinite(values[index])]
        if known.size:
            result[index] = np.percentile(known, [50.0, 95.0, 100.0])
    return result

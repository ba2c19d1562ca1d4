"""Harmonics of b and the onset, adjusted to the samples of a side.

Harmonics through the parameters of single directions [Eq. 11] are blind to what an error of a
parameter does to moments: where b is a hundred times a, an onset that comes a little early makes
the next moment several times too large. From there on, therefore, all coefficients of a side are
moved together so that moments and energies meet the samples of all directions, in the weights of
`Line.weights`. Few samples near the onset must not carry the rest away: errors beyond `_TOLERATED`
count linearly (soft L1). What is positive at every angle, or free of contact, stays so: both are
convex, so that a step is cut until it is.

# PAPER: stops at the harmonics of single directions; so does the variant "paper".
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares

from flexscale.arrays import FloatArray
from flexscale.datasets.variables import Weighting
from flexscale.macro.flat_response import FlatResponse
from flexscale.macro.harmonics import FLOOR_SHARE, Harmonics, harmonic_matrix
from flexscale.macro.polar import DirectionalLaws, PolarLaw, fit_polar
from flexscale.macro.samples import Samples
from flexscale.macro.uniaxial import UniaxialLaw

_TOLERATED = 0.1  # of the weighted errors, which are relative ones
_HOLD = 0.02  # weight of the coefficients' own change: it decides what samples do not
_SHARES = (1.0, 0.5, 0.25, 0.125)  # of a step, tried in turn
_MOST_EVALUATIONS = 60


@dataclass(frozen=True)
class SideSamples:
    """Samples of one side, one entry per sample.

    Attributes
    ----------
    direction, curvature : (n,) degree, mm-1.
    energy, moment : (n,) native, N mm-1 and N.
    energy_weight, moment_weight : (n,) of their errors.
    before : response without contact in these directions.
    """

    direction: FloatArray
    curvature: FloatArray
    energy: FloatArray
    moment: FloatArray
    energy_weight: FloatArray
    moment_weight: FloatArray
    before: UniaxialLaw


@dataclass(frozen=True)
class Limits:
    """What must hold: least b, least onset where that is κ0, and no contact in some directions.

    `free` (m,) degree and `largest` (mm-1): there 1/κ0 <= 1/largest; used where 1/κ0 is fitted.
    """

    least_b: float
    least_onset: float | None
    free: FloatArray
    largest: float

    def hold(self, b: Harmonics, onset: Harmonics) -> bool:
        """Whether they do."""
        if b.least() < self.least_b * (1.0 - 1e-6):
            return False
        if self.least_onset is not None:
            return onset.least() >= self.least_onset * (1.0 - 1e-6)
        return bool((onset(self.free) <= (1.0 + 1e-6) / self.largest).all())


def fit_refined(
    laws: DirectionalLaws,
    samples: Samples,
    weighting: Weighting,
    flat: FlatResponse | None = None,
    chosen: np.ndarray | None = None,
) -> PolarLaw | None:
    """`fit_polar`, adjusted to the samples where the response without contact is known."""
    polar = fit_polar(laws, samples, weighting, flat, chosen)
    if polar is None or flat is None:
        return polar
    every = np.ones(len(laws.directions), dtype=bool) if chosen is None else chosen
    bs, onsets = list(polar.b), list(polar.onset)
    for s, quantity in enumerate(polar.onset_quantity):
        if quantity != "none":
            bs[s], onsets[s] = refine(
                polar.b[s],
                polar.onset[s],
                quantity == "1/kappa_0",
                _collect(samples, s, every, weighting, flat),
                _limits(laws, s, every, quantity, polar.largest_curvature),
            )
    return replace(polar, b=tuple(bs), onset=tuple(onsets))


def _collect(
    samples: Samples, side: int, chosen: np.ndarray, weighting: Weighting, flat: FlatResponse
) -> SideSamples:
    columns: list[list[FloatArray]] = []
    for d in map(int, np.flatnonzero(chosen)):
        line = samples.lines(d).get(samples.sides[side])
        if line is not None:
            direction = np.full(len(line.curvature), samples.directions[d])
            weights = np.split(line.weights(weighting), 2)
            columns.append([direction, line.curvature, line.energy, line.moment, *weights])
    direction, curvature, energy, moment, energy_weight, moment_weight = (
        np.concatenate(parts) for parts in zip(*columns, strict=True)
    )
    before = UniaxialLaw(flat.stiffness(direction), np.nan, np.nan, flat.softening)
    return SideSamples(direction, curvature, energy, moment, energy_weight, moment_weight, before)


def _limits(
    laws: DirectionalLaws, side: int, chosen: np.ndarray, quantity: str, largest: float
) -> Limits:
    contact = chosen & np.isfinite(laws.kappa_0[side])
    free = chosen & laws.sampled[side] & ~contact
    inverse = quantity == "1/kappa_0"
    return Limits(
        FLOOR_SHARE * float(laws.b[side][contact].min()),
        None if inverse else FLOOR_SHARE * float(laws.kappa_0[side][contact].min()),
        laws.directions[free],
        largest,
    )


def refine(
    b: Harmonics, onset: Harmonics, inverse: bool, samples: SideSamples, limits: Limits
) -> tuple[Harmonics, Harmonics]:
    """b and onset (κ0, or 1/κ0 if `inverse`) that meet the samples, from harmonics near by."""
    problem = _Problem(b, onset, inverse, samples)
    start = problem.start
    found = least_squares(
        problem.residuals,
        start,
        problem.jacobian,
        loss="soft_l1",
        f_scale=_TOLERATED,
        max_nfev=_MOST_EVALUATIONS,
    )
    for share in _SHARES:
        trial = problem.harmonics(start + share * (found.x - start))
        if limits.hold(*trial):
            return trial
    return b, onset


class _Problem:
    """Residuals in coefficients, each in units of its mean at the start."""

    def __init__(self, b: Harmonics, onset: Harmonics, inverse: bool, samples: SideSamples) -> None:
        self.samples, self.inverse = samples, inverse
        self.orders = (b.order, onset.order)
        self.scales = (b.cosine[0], abs(onset.cosine[0]) or float(np.abs(onset.cosine).max()))
        flat = [np.concatenate([item.cosine, item.sine[1:]]) for item in (b, onset)]
        self.start = np.concatenate([x / s for x, s in zip(flat, self.scales, strict=True)])
        self.bases = [
            harmonic_matrix(samples.direction, order) * scale
            for order, scale in zip(self.orders, self.scales, strict=True)
        ]
        before = samples.before
        self.energy_off = before.energy(samples.curvature) - samples.energy
        self.moment_off = before.moment(samples.curvature) - samples.moment

    def harmonics(self, x: FloatArray) -> tuple[Harmonics, Harmonics]:
        found = []
        for part, order, scale in zip(self._split(x), self.orders, self.scales, strict=True):
            sine = np.concatenate([[0.0], part[order + 1 :]])
            found.append(Harmonics(part[: order + 1] * scale, sine * scale))
        return found[0], found[1]

    def _split(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        cut = 2 * self.orders[0] + 1
        return x[:cut], x[cut:]

    def _state(self, x: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Added stiffness, curvature beyond the onset, and dκ0/d(harmonics of the onset)."""
        b, onset = (basis @ part for basis, part in zip(self.bases, self._split(x), strict=True))
        rate = np.ones_like(onset)
        if self.inverse:
            onset = 1.0 / np.maximum(onset, 1e-9)
            rate = -(onset**2)
        beyond = np.maximum(self.samples.curvature - onset, 0.0)
        return b - self.samples.before.a, beyond, rate

    def residuals(self, x: FloatArray) -> FloatArray:
        added, beyond, _ = self._state(x)
        return np.concatenate(
            [
                (self.energy_off + 0.5 * added * beyond**2) * self.samples.energy_weight,
                (self.moment_off + added * beyond) * self.samples.moment_weight,
                _HOLD * (x - self.start),
            ]
        )

    def jacobian(self, x: FloatArray) -> FloatArray:
        added, beyond, rate = self._state(x)
        moved = -added * rate * (beyond > 0.0)  # of the moment, by the onset's harmonics
        by_b, by_onset = self.bases
        beyond, moved = beyond[:, None], moved[:, None]
        energy = np.hstack([0.5 * beyond**2 * by_b, moved * beyond * by_onset])
        moment = np.hstack([beyond * by_b, moved * by_onset])
        weights = np.concatenate([self.samples.energy_weight, self.samples.moment_weight])
        held = _HOLD * np.eye(len(x))
        return np.vstack([np.vstack([energy, moment]) * weights[:, None], held])

"""Gaps fitted to energies and moments of a sheet that is bent by any curvature tensor.

Gaps of the flat cell tell which scales meet, in which order, and roughly what holds them. What they
leave out is of second order: gaps turn as they close, joints stiffen or soften. Sought are two
softenings, and of each gap its distance g, slopes G, turns Q, and the root d of a factor of its
compliance S_ij = d_i d_j S0_ij, by least squares of log(W/W0) and |m - m0|/(2 |m0|), with outliers
counted less: a native sheet may have snapped where a law without memory cannot.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numba import njit
from scipy.optimize import least_squares

from flexscale.arrays import FloatArray
from flexscale.homogenize.flat_contact import FlatContact
from flexscale.macro.tensor_samples import TensorSamples
from flexscale.solve.unilateral import unilateral_forces

_MOST = 60  # evaluations
_OUTLIER = 0.03  # residual from which on samples count less
_MOMENTS = 0.5  # weight of moments beside energies
_RAY_SAMPLES = 20  # of each ray; energies are smooth between onsets
_OWN = 11  # numbers of a gap: g, G (3), Q (6), d
_PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
#: Steps of g [mm], G [mm2], Q [mm3] and d that change energies alike at 0.01 to 0.03 mm-1.
_STEPS = (0.05, 5.0, 500.0, 0.3)


@dataclass(frozen=True, eq=False)
class ClosingGaps:
    """Gaps with turns, and softenings of the energy before contact and of contact.

    Attributes
    ----------
    contact : distances, slopes and compliance.
    turns : (n, 3, 3) Q, mm3, second derivatives of the gaps by k.
    softening, contact_softening : s and s_c of `gap_law`, mm N-1.
    """

    contact: FlatContact
    turns: FloatArray
    softening: float = 0.0
    contact_softening: float = 0.0


def fit_gaps(contact: FlatContact, tangent: FloatArray, samples: TensorSamples) -> ClosingGaps:
    """The gaps of a flat cell, fitted to samples of the bent one.

    Parameters
    ----------
    contact : gaps of the flat cell.
    tangent : (3, 3) N mm, its stiffness.
    samples : energies and moments of curvature tensors, at least one beyond 0.
    """
    n, few = len(contact), samples.thinned(_RAY_SAMPLES)
    known = few.moment_lengths()[:, None]

    def residuals(values: FloatArray) -> tuple[FloatArray, FloatArray]:
        energy, moment, by, moment_by = _evaluate(values, contact, tangent, few)
        missed = _MOMENTS * (moment - few.moments) / known
        off = np.concatenate([np.log(energy / few.energies), missed.ravel()])
        rows = (_MOMENTS * moment_by / known[:, :, None]).reshape(-1, len(values))
        return off, np.concatenate([by / energy[:, None], rows])

    start = np.zeros(2 + _OWN * n)
    start[:2] = 0.5
    start[2 : 2 + n], start[2 + n : 2 + 4 * n] = contact.distances, contact.slopes.ravel()
    start[2 + 10 * n :] = 1.0
    steps = np.repeat([1.0, *_STEPS], [2, n, 3 * n, 6 * n, n])
    lowest = np.full(len(start), -np.inf)
    lowest[:2] = 0.0
    found = least_squares(
        lambda values: residuals(values)[0],
        start,
        lambda values: residuals(values)[1],
        bounds=(lowest, np.inf),
        x_scale=steps,
        loss="soft_l1",
        f_scale=_OUTLIER,
        max_nfev=_MOST,
    )
    return _gaps_of(found.x, contact)


def _gaps_of(values: FloatArray, start: FlatContact) -> ClosingGaps:
    n = len(start)
    roots = values[2 + 10 * n :]
    contact = replace(
        start,
        distances=values[2 : 2 + n],
        slopes=values[2 + n : 2 + 4 * n].reshape(n, 3),
        compliance=roots[:, None] * start.compliance * roots,
    )
    return ClosingGaps(contact, _turns_of(values, n), float(values[0]), float(values[1]))


def _turns_of(values: FloatArray, n: int) -> FloatArray:
    entries, turns = values[2 + 4 * n : 2 + 10 * n].reshape(n, 6), np.empty((n, 3, 3))
    for at, (i, j) in enumerate(_PAIRS):
        turns[:, i, j] = turns[:, j, i] = entries[:, at]
    return turns


def _evaluate(
    values: FloatArray, start: FlatContact, tangent: FloatArray, samples: TensorSamples
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Energies (p,), moments (p, 3) in the metric of tensors, and both by the values."""
    gaps, p = _gaps_of(values, start), len(samples.energies)
    energy, moment = np.empty(p), np.empty((p, 3))
    by, moment_by = np.zeros((p, len(values))), np.zeros((p, 3, len(values)))
    _evaluate_all(
        samples.voigt, tangent, gaps.contact.distances, gaps.contact.slopes, gaps.turns,
        gaps.contact.compliance, np.array([gaps.softening, gaps.contact_softening]),
        values[2 + 10 * len(start) :], energy, moment, by, moment_by,
    )  # fmt: skip
    moment[:, 2] *= np.sqrt(2.0)
    moment_by[:, 2] *= np.sqrt(2.0)
    return energy, moment, by, moment_by


@njit(cache=True)
def _evaluate_all(
    voigt: FloatArray,
    tangent: FloatArray,
    distances: FloatArray,
    slopes: FloatArray,
    turns: FloatArray,
    compliance: FloatArray,
    softenings: FloatArray,
    roots: FloatArray,
    energy: FloatArray,
    moment: FloatArray,
    by: FloatArray,
    moment_by: FloatArray,
) -> None:
    for p in range(len(voigt)):
        rest = tangent @ voigt[p]
        energy[p] = _soften(
            0.5 * np.dot(rest, voigt[p]), rest, softenings[0], 0, by[p], moment_by[p]
        )
        moment[p] = rest
        touch = np.zeros(3)
        value = _contact(
            voigt[p], distances, slopes, turns, compliance, roots, touch, by[p], moment_by[p]
        )
        if value > 0.0:
            energy[p] += _soften(value, touch, softenings[1], 1, by[p], moment_by[p])
            moment[p] += touch


@njit(cache=True)
def _soften(
    value: float, first: FloatArray, s: float, at: int, by: FloatArray, moment_by: FloatArray
) -> float:
    """log(1 + s W)/s with its moments, and both by the values; by s at index `at`."""
    rate = 1.0 / (1.0 + s * value)
    if at == 1:  # of contact, whose derivatives by the gaps are there
        for k in range(2, len(by)):
            for c in range(3):
                moment_by[c, k] = rate * (moment_by[c, k] - s * rate * by[k] * first[c])
            by[k] *= rate
    x = s * value
    if x > 1e-4:
        out = np.log1p(x) / s
        by[at] = (value * rate - out) / s
    else:  # the series, where the difference rounds
        out = value * (1.0 - 0.5 * x + x * x / 3.0)
        by[at] = -value * value * (0.5 - 2.0 * x / 3.0)
    for c in range(3):
        moment_by[c, at] = -value * rate * rate * first[c]
        first[c] *= rate
    return out


@njit(cache=True)
def _contact(
    k: FloatArray,
    distances: FloatArray,
    slopes: FloatArray,
    turns: FloatArray,
    compliance: FloatArray,
    roots: FloatArray,
    moment: FloatArray,
    by: FloatArray,
    moment_by: FloatArray,
) -> float:
    """W_c of `gap_law`, its moments, and both by the numbers of the gaps.

    With missing m = -h(k) and the closed gaps' p = S⁻¹ m: W = ½ p·m, and so by a number of h, -p of
    it, and by one of S, -½ p·dS p. Moments are -Σ p h', in which p changes as well.
    """
    n = len(distances)
    missing, rates = np.empty(n), np.empty((n, 3))
    for i in range(n):
        turned = turns[i] @ k
        rates[i] = slopes[i] + turned
        missing[i] = -distances[i] - np.dot(slopes[i] + 0.5 * turned, k)
    if n == 0 or missing.max() <= 0.0:
        return 0.0
    active, forces = np.empty(n, dtype=np.int64), np.empty(n)
    m = unilateral_forces(compliance, missing, active, forces)
    closed, slope = np.empty((m, m)), np.empty((m, 3))
    value = 0.0
    for a in range(m):
        i = active[a]
        slope[a] = rates[i]
        value += 0.5 * forces[a] * missing[i]
        for c in range(m):
            closed[a, c] = compliance[i, active[c]]
        for c in range(3):
            moment[c] -= forces[a] * rates[i, c]
    held = np.linalg.solve(closed, slope)  # S⁻¹ h'
    for a in range(m):
        i, p = active[a], forces[a]
        at = 2 + i
        by[at] = -p
        for c in range(3):
            moment_by[c, at] = held[a, c]
        for d in range(3):
            at = 2 + n + 3 * i + d
            by[at] = -p * k[d]
            for c in range(3):
                moment_by[c, at] = held[a, c] * k[d]
            moment_by[d, at] -= p
        for e in range(6):
            u, v = _PAIRS[e]
            at = 2 + 4 * n + 6 * i + e
            half = 0.5 * k[u] * k[v] * (1.0 if u == v else 2.0)
            by[at] = -p * half
            for c in range(3):
                moment_by[c, at] = held[a, c] * half
            moment_by[u, at] -= p * k[v]
            if u != v:
                moment_by[v, at] -= p * k[u]
        # S p of the closed gaps is what is missing: by d_i, row i and column i of S change.
        at = 2 + 10 * n + i
        root = roots[i] if roots[i] != 0.0 else 1e-12
        by[at] = -p * missing[i] / root
        for c in range(3):
            moment_by[c, at] = (held[a, c] * missing[i] + p * slope[a, c]) / root
    return value

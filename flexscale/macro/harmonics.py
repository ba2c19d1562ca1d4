"""Circular harmonics of period 180 degree that stay positive at every angle [Eq. 11].

s(θ) = Σ c_k cos 2k(θ − d_k) is linear in c_k cos 2k d_k and c_k sin 2k d_k: a weighted linear
least squares problem. Positivity is a linear inequality at each angle. It is imposed where it is
needed only: solve, find all minima of the trigonometric polynomial (roots of its derivative), add
the angles at which it falls below the floor, and solve again, until none is left. The result
holds between samples too, and nothing changes where the plain solution is positive already.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from flexscale.arrays import FloatArray
from flexscale.datasets.fit_values import harmonic_sum

#: s stays above this share of the smallest value it was fitted to.
FLOOR_SHARE = 0.1
_MOST_ROUNDS = 60
_SCAN = np.arange(0.0, 180.0, 0.5)


@dataclass(frozen=True)
class Harmonics:
    """Circular harmonics of order n in canonical, linear form.

    Attributes
    ----------
    cosine, sine : (n + 1,) coefficients of cos 2kθ and sin 2kθ; `sine[0]` is 0.
    """

    cosine: FloatArray
    sine: FloatArray

    def __call__(self, directions: float | FloatArray) -> FloatArray:
        """Values in directions (degree), of any shape."""
        return harmonic_sum(self.cosine, self.sine, directions)

    @property
    def order(self) -> int:
        """The paper's n."""
        return len(self.cosine) - 1

    @property
    def n_parameters(self) -> int:
        """2 n + 1 numbers."""
        return 2 * self.order + 1

    @property
    def amplitudes(self) -> FloatArray:
        """(n + 1,) the paper's c_k; c_0 keeps its sign."""
        return np.concatenate([self.cosine[:1], np.hypot(self.cosine[1:], self.sine[1:])])

    @property
    def phases(self) -> FloatArray:
        """(n + 1,) degree, the paper's d_k in [0, 180 / k); d_0 is 0."""
        order = np.arange(1, len(self.cosine))
        turn = np.rad2deg(np.arctan2(self.sine[1:], self.cosine[1:])) % 360.0
        return np.concatenate([[0.0], turn / (2.0 * order)])

    def minima(self) -> tuple[FloatArray, FloatArray]:
        """Angles (degree, in [0, 180)) among which the least value is, and the values there.

        All stationary angles, and a scan that stands in for them where roots nearly coincide.
        """
        order = np.arange(1, len(self.cosine))
        upper = 0.5 * order * (self.sine[1:] + 1j * self.cosine[1:])
        polynomial = np.concatenate([upper[::-1], [0.0], np.conj(upper)])
        if not np.isfinite(polynomial).all() or np.abs(polynomial).max(initial=0.0) == 0.0:
            return np.zeros(1), self(np.zeros(1))
        angles = np.rad2deg(np.angle(np.roots(polynomial))) / 2.0 % 180.0
        angles = np.concatenate([angles, _SCAN])
        return angles, self(angles)

    def least(self) -> float:
        """Least value over all angles."""
        return float(self.minima()[1].min())


def stiffness_harmonics(tangent: FloatArray) -> Harmonics:
    """a(θ) = k·C k, k = (cos²θ, sin²θ, 2 sin θ cos θ), as harmonics: exact with order 2."""
    xx, yy, xy = np.diag(tangent)
    mean, mixed = (xx + yy) / 8.0, (2.0 * tangent[0, 1] + 4.0 * xy) / 8.0
    cosine = np.array([3.0 * mean + mixed, (xx - yy) / 2.0, mean - mixed])
    sine = np.array([0.0, tangent[0, 2] + tangent[1, 2], (tangent[0, 2] - tangent[1, 2]) / 2.0])
    return Harmonics(cosine, sine)


def harmonic_matrix(directions: FloatArray, order: int) -> FloatArray:
    """(m, 2 n + 1): columns 1, cos 2θ … cos 2nθ, sin 2θ … sin 2nθ."""
    angle = 2.0 * np.deg2rad(np.asarray(directions, dtype=float))[:, None]
    k = np.arange(1, order + 1)
    return np.hstack([np.ones_like(angle), np.cos(angle * k), np.sin(angle * k)])


def fit_harmonics(
    directions: FloatArray,
    values: FloatArray,
    order: int,
    *,
    weights: FloatArray | None = None,
    floor: float | None = None,
    ceilings: tuple[FloatArray, FloatArray] | None = None,
    smoothing: float = 0.0,
) -> Harmonics:
    """Harmonics nearest to values in some directions, by weighted least squares.

    Parameters
    ----------
    directions, values : (m,) degree; any unit.
    order : n.
    weights : (m,) factors of the residuals, in units of 1 / value; all equal if not given.
    floor : least value at every angle; none if not given.
    ceilings : directions, and upper bounds there, that hold exactly.
    smoothing : weight of k times the k-th coefficients, of the values' size; needed where values
        are known in a part of the circle only.
    """
    scale = float(np.abs(values).max(initial=0.0)) or 1.0
    factors = np.full(len(values), 1.0 / scale) if weights is None else np.asarray(weights)
    matrix = harmonic_matrix(directions, order) * (factors * scale)[:, None]
    target = values * factors
    if smoothing > 0.0:
        k = np.arange(1, order + 1)
        damping = np.diag(np.concatenate([[0.0], k, k])) * smoothing
        matrix, target = np.vstack([matrix, damping]), np.append(target, np.zeros(2 * order + 1))
    low_angles: list[float] = []
    upper = (np.zeros(0), np.zeros(0)) if ceilings is None else ceilings
    for _ in range(_MOST_ROUNDS):
        below = np.asarray(low_angles)
        sides = np.vstack([harmonic_matrix(below, order), -harmonic_matrix(upper[0], order)])
        bounds = np.concatenate([np.full(len(below), floor or 0.0), -upper[1]]) / scale
        solution = constrained_least_squares(matrix, target, sides, bounds) * scale
        found = Harmonics(
            solution[: order + 1].copy(), np.concatenate([[0.0], solution[order + 1 :]])
        )
        if floor is None:
            return found
        angles, lows = found.minima()
        short = lows < floor - 1e-6 * abs(floor)
        if not short.any():
            return found
        # A few of the lowest are enough: the others rise with them, or come in the next round.
        low_angles += [float(angle) for angle in angles[short][np.argsort(lows[short])[:6]]]
    return found


def constrained_least_squares(
    matrix: FloatArray, target: FloatArray, sides: FloatArray, bounds: FloatArray
) -> FloatArray:
    """x that minimizes |matrix x − target| subject to sides x >= bounds.

    Turned into a least distance problem, which is a nonnegative least squares problem (Lawson and
    Hanson, Solving Least Squares Problems, chapter 23): exact, finite, no starting point.
    `matrix` (m, p) has full column rank; `sides` (q, p) may be empty.
    """
    free = np.linalg.lstsq(matrix, target, rcond=None)[0]
    if not len(sides) or bool(np.all(sides @ free >= bounds)):
        return np.asarray(free)
    triangle = np.linalg.qr(matrix)[1]
    # x = free + triangle⁻¹ z with least |z|.
    turned = np.linalg.solve(triangle.T, sides.T)
    short = bounds - sides @ free
    stacked = np.vstack([turned, short])
    unit = np.zeros(len(stacked))
    unit[-1] = 1.0
    dual, _ = nnls(stacked, unit)
    rest = stacked @ dual - unit
    return np.asarray(free + np.linalg.solve(triangle, -rest[:-1] / rest[-1]))

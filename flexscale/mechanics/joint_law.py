"""Law of a joint: its energy per length W(u, w, s, phi), a polynomial within the sampled range.

With x = (u/t, w/t, s/t, phi),

    W = E t^2 sum_k c_k x_1^(e_k1) x_2^(e_k2) x_3^(e_k3) x_4^(e_k4).

Beyond the bounds of a coordinate, b <= x, its powers go on as their second-order expansion about b,
in a distance that saturates, r = delta tanh((x - b)/delta):

    x^e  ->  b^e + e b^(e-1) r + e (e-1)/2 b^(e-2) r^2,

and the energy gains k [(x-b)^2/2 - delta^2 ln cosh((x-b)/delta)], whose second derivative is k
tanh^2((x-b)/delta). So W has two continuous derivatives everywhere, a coordinate far out changes
what the others do no further, and W grows with the square of the distance in every direction. That
is no law of the section: results beyond the bounds are to be flagged, see `JointLaw.inside`.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numba import njit

from flexscale.arrays import BoolArray, FloatArray, IntArray
from flexscale.errors import BadInputError
from flexscale.short_repr import ShortRepr

MOST_POWER = 9  # of one coordinate
_REACH = 0.25  # delta, in widths of a coordinate's range
_WALL = 8.0  # k, in the coordinate's stiffness at rest


class LawTable(NamedTuple):
    """A law as kernels take it; see `JointLaw`."""

    exponents: IntArray
    coefficients: FloatArray
    thickness: float
    modulus: float
    bounds: FloatArray


@njit(cache=True)
def law_at(
    law: LawTable,
    q: FloatArray,
    gradient_out: FloatArray,
    hessian_out: FloatArray,
    order: int,
) -> float:
    """Energy per length [N] of one pose q = (u, w, s) in mm and phi in radian.

    Parameters
    ----------
    q : (4,)
    gradient_out : (4,) filled with dW/dq, N/mm and N.
    hessian_out : (4, 4) filled with d2W/dq2, if order is 2.
    """
    thickness, bounds = law.thickness, law.bounds
    powers = np.empty((4, MOST_POWER + 1, 3))
    outside = False
    for i in range(4):
        scale = thickness if i < 3 else 1.0
        x, low, high = q[i] / scale, bounds[i, 0] / scale, bounds[i, 1] / scale
        if low <= x <= high:
            _fill_powers(powers[i], x, 0.0, 1.0, 0.0)
        else:
            outside = True
            edge = low if x < low else high
            reach = _REACH * (high - low)
            r = reach * np.tanh((x - edge) / reach)
            slope = 1.0 - (r / reach) ** 2
            _fill_powers(powers[i], edge, r, slope, -2.0 * slope * r / reach**2)
    energy = _sum_terms(law.exponents, law.coefficients, powers, gradient_out, hessian_out, order)
    if outside:
        energy += _add_walls(law, q, gradient_out, hessian_out)
    for i in range(4):
        scale = law.modulus * (thickness if i < 3 else thickness**2)
        gradient_out[i] *= scale
        for j in range(4):
            hessian_out[i, j] *= scale / (thickness if j < 3 else 1.0)
    return energy * law.modulus * thickness**2


@njit(cache=True)
def _fill_powers(out: FloatArray, x: float, r: float, slope: float, bend: float) -> None:
    """Powers (MOST_POWER + 1, 3) of x expanded to second order in r, and two derivatives; r = 0 and
    slope = 1 within the bounds."""
    power = 1.0  # x^(e - 2)
    for e in range(out.shape[0]):
        if e == 0:
            out[0, 0], out[0, 1], out[0, 2] = 1.0, 0.0, 0.0
        elif e == 1:
            out[1, 0], out[1, 1], out[1, 2] = x + r, slope, bend
        else:
            first, second = e * power * x, e * (e - 1) * power
            out[e, 0] = power * x * x + first * r + 0.5 * second * r * r
            out[e, 1] = (first + second * r) * slope
            out[e, 2] = (first + second * r) * bend + second * slope * slope
            power *= x


@njit(cache=True)
def _sum_terms(exponents, coefficients, powers, gradient, hessian, order):
    """Sum in x over terms; those of equal powers of w and s are summed over u and phi first."""
    gradient[:] = 0.0
    hessian[:] = 0.0
    energy = 0.0
    n = len(coefficients)
    k = 0
    while k < n:
        ew, es = exponents[k, 1], exponents[k, 2]
        f = fu = fp = fuu = fup = fpp = 0.0
        while k < n and exponents[k, 1] == ew and exponents[k, 2] == es:
            eu, ep, c = exponents[k, 0], exponents[k, 3], coefficients[k]
            u0, u1, u2 = c * powers[0, eu, 0], c * powers[0, eu, 1], c * powers[0, eu, 2]
            p0, p1, p2 = powers[3, ep, 0], powers[3, ep, 1], powers[3, ep, 2]
            f += u0 * p0
            fu += u1 * p0
            fp += u0 * p1
            if order > 1:
                fuu += u2 * p0
                fup += u1 * p1
                fpp += u0 * p2
            k += 1
        w0, w1, w2 = powers[1, ew, 0], powers[1, ew, 1], powers[1, ew, 2]
        s0, s1, s2 = powers[2, es, 0], powers[2, es, 1], powers[2, es, 2]
        ws = w0 * s0
        energy += f * ws
        gradient[0] += fu * ws
        gradient[1] += f * w1 * s0
        gradient[2] += f * w0 * s1
        gradient[3] += fp * ws
        if order < 2:
            continue
        hessian[0, 0] += fuu * ws
        hessian[0, 1] += fu * w1 * s0
        hessian[0, 2] += fu * w0 * s1
        hessian[0, 3] += fup * ws
        hessian[1, 1] += f * w2 * s0
        hessian[1, 2] += f * w1 * s1
        hessian[1, 3] += fp * w1 * s0
        hessian[2, 2] += f * w0 * s2
        hessian[2, 3] += fp * w0 * s1
        hessian[3, 3] += fpp * ws
    for i in range(4):
        for j in range(i):
            hessian[i, j] = hessian[j, i]
    return energy


@njit(cache=True)
def _add_walls(law, q, gradient, hessian):
    exponents, coefficients = law.exponents, law.coefficients
    thickness, bounds = law.thickness, law.bounds
    energy = 0.0
    for i in range(4):
        scale = thickness if i < 3 else 1.0
        x, low, high = q[i] / scale, bounds[i, 0] / scale, bounds[i, 1] / scale
        if low <= x <= high:
            continue
        stiffness = 0.0
        for k in range(len(coefficients)):
            if exponents[k, i] == 2 and exponents[k].sum() == 2:
                stiffness += 2.0 * _WALL * coefficients[k]
        distance, reach = x - (low if x < low else high), _REACH * (high - low)
        y = abs(distance) / reach
        log_cosh = y + np.log1p(np.exp(-2.0 * y)) - np.log(2.0)
        energy += stiffness * (0.5 * distance**2 - reach**2 * log_cosh)
        gradient[i] += stiffness * (distance - reach * np.tanh(distance / reach))
        hessian[i, i] += stiffness * np.tanh(y) ** 2
    return energy


@njit(cache=True)
def _laws_at(law, poses, energies, gradients, hessians):
    for k in range(len(poses)):
        energies[k] = law_at(law, poses[k], gradients[k], hessians[k], 2)


@dataclass(frozen=True, repr=False)
class JointLaw(ShortRepr):
    """Energy per length of a joint, of the relative pose q = (u, w, s, phi) of its two scales.

    Attributes
    ----------
    exponents : (n_terms, 4) powers of u/t, w/t, s/t and phi; terms of equal powers of w and s stand
        together.
    coefficients : (n_terms,) in E t^2.
    thickness : mm, of the sheet, t.
    modulus : MPa, Young's modulus of the sheet, E.
    bounds : (4, 2) lowest and highest u, w, s [mm] and phi [radian] that were sampled.
    band : slope, below, above and before [mm], which bound u by phi; see `inside`.
    errors : of the fit, each relative to the root mean square over the states held out: of the
        energy, and of the forces of u, w, s and phi.
    """

    exponents: IntArray
    coefficients: FloatArray
    thickness: float
    modulus: float
    bounds: FloatArray
    band: tuple[float, float, float, float] = (0.0, np.inf, np.inf, np.inf)
    errors: FloatArray = field(default_factory=lambda: np.zeros(5))

    def __post_init__(self) -> None:
        n = len(self.coefficients)
        if self.exponents.shape != (n, 4) or self.bounds.shape != (4, 2):
            raise BadInputError(
                f"A joint's law of {n} coefficients has exponents (n, 4) and bounds (4, 2), not "
                f"{self.exponents.shape} and {self.bounds.shape}."
            )
        if not (np.isfinite(self.coefficients).all() and np.isfinite(self.bounds).all()):
            raise BadInputError("A joint's law has coefficients or bounds that are not finite.")
        if self.exponents.max(initial=0) > MOST_POWER or self.exponents.min(initial=0) < 0:
            raise BadInputError(
                f"A joint's law has a power of {self.exponents.max()}: give powers from 0 to "
                f"{MOST_POWER}."
            )

    @property
    def digest(self) -> str:
        """Sixteen digits that stand for all that its energies and range depend on."""
        parts = (self.exponents, self.coefficients, self.bounds, np.array(self.band))
        total = hashlib.sha256(np.array([self.thickness, self.modulus]).tobytes())
        for part in parts:
            total.update(np.ascontiguousarray(part, dtype=float).tobytes())
        return total.hexdigest()[:16]

    @property
    def table(self) -> LawTable:
        """What kernels take."""
        return LawTable(
            np.ascontiguousarray(self.exponents, dtype=np.int64),
            np.ascontiguousarray(self.coefficients, dtype=float),
            float(self.thickness),
            float(self.modulus),
            np.ascontiguousarray(self.bounds, dtype=float),
        )

    def evaluate(self, q: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Energy, forces and tangent of poses.

        Parameters
        ----------
        q : (n, 4) u, w, s in mm, phi in radian.

        Returns
        -------
        W (n,) N; dW/dq (n, 4) N/mm, and N for phi; d2W/dq2 (n, 4, 4).
        """
        poses = np.ascontiguousarray(q, dtype=float).reshape(-1, 4)
        n = len(poses)
        energies, gradients, hessians = np.empty(n), np.empty((n, 4)), np.empty((n, 4, 4))
        _laws_at(self.table, poses, energies, gradients, hessians)
        return energies, gradients, hessians

    def inside(self, q: FloatArray) -> BoolArray:
        """(n,) whether poses (n, 4) lie in the range that was sampled: within the bounds, and
        near what an open or touching joint does,

            slope phi - below <= u <= max(before, slope phi + above).
        """
        poses = np.asarray(q, dtype=float).reshape(-1, 4)
        slope, below, above, before = self.band
        in_box = ((poses >= self.bounds[:, 0]) & (poses <= self.bounds[:, 1])).all(axis=1)
        opening, turn = poses[:, 0], slope * poses[:, 3]
        return in_box & (opening >= turn - below) & (opening <= np.maximum(before, turn + above))

    @property
    def stiffness(self) -> FloatArray:
        """(4, 4) second derivatives at rest."""
        return self.evaluate(np.zeros((1, 4)))[2][0]

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
    """A law as kernels take it; see `JointLaw`.

    runs : (n_runs, 6) terms of equal powers of u, w and s whose powers of phi follow one another:
        these three powers, that of phi of the first term, the first term, and one past the last;
        runs of equal powers of w and s stand together. most : (4,) largest powers.
    """

    runs: IntArray
    coefficients: FloatArray
    most: IntArray
    at_rest: FloatArray
    thickness: float
    modulus: float
    bounds: FloatArray


@njit(cache=True, error_model="numpy")
def law_at(
    law: LawTable,
    q: FloatArray,
    powers: FloatArray,
    gradient_out: FloatArray,
    hessian_out: FloatArray,
    order: int,
) -> float:
    """Energy per length [N] of one pose q = (u, w, s) in mm and phi in radian.

    Parameters
    ----------
    q : (4,)
    powers : (4, 3, MOST_POWER + 1) to work in.
    gradient_out : (4,) filled with dW/dq, N/mm and N.
    hessian_out : (4, 4) filled with d2W/dq2, if order is 2.
    """
    thickness, bounds = law.thickness, law.bounds
    outside = False
    for i in range(4):
        scale = thickness if i < 3 else 1.0
        x, low, high = q[i] / scale, bounds[i, 0] / scale, bounds[i, 1] / scale
        if low <= x <= high:
            _fill_powers(powers[i], x, law.most[i])
        else:
            outside = True
            _fill_powers(powers[i], low if x < low else high, law.most[i])
            _go_beyond(powers[i], x, low, high, law.most[i])
    energy = _sum_terms(law, powers, gradient_out, hessian_out, order)
    if outside:
        energy += _add_walls(law, q, gradient_out, hessian_out)
    for i in range(4):
        scale = law.modulus * (thickness if i < 3 else thickness**2)
        gradient_out[i] *= scale
        if order > 1:
            for j in range(4):
                hessian_out[i, j] *= scale / (thickness if j < 3 else 1.0)
    return energy * law.modulus * thickness**2


@njit(cache=True, error_model="numpy")
def _fill_powers(out: FloatArray, x: float, most: int) -> None:
    """Powers of x up to one, and both derivatives; out : (3, MOST_POWER + 1)."""
    out[0, 0], out[1, 0], out[2, 0] = 1.0, 0.0, 0.0
    for e in range(1, most + 1):
        out[0, e] = x * out[0, e - 1]
        out[1, e] = e * out[0, e - 1]
        out[2, e] = e * out[1, e - 1]


@njit(cache=True, error_model="numpy")
def _go_beyond(out: FloatArray, x: float, low: float, high: float, most: int) -> None:
    """Expand powers at the bound that x is beyond to second order, in a distance that saturates."""
    edge, reach = low if x < low else high, _REACH * (high - low)
    r = reach * np.tanh((x - edge) / reach)
    slope = 1.0 - (r / reach) ** 2
    bend = -2.0 * slope * r / reach**2
    for e in range(1, most + 1):
        first, second = out[1, e], out[2, e]
        out[0, e] += first * r + 0.5 * second * r * r
        out[1, e] = (first + second * r) * slope
        out[2, e] = (first + second * r) * bend + second * slope * slope


@njit(cache=True, error_model="numpy")
def _sum_terms(law, powers, gradient, hessian, order):
    """Sum in x over runs; those of equal powers of w and s are summed over u and phi first."""
    runs, coefficients = law.runs, law.coefficients
    of_u, of_w, of_s, of_phi = powers[0], powers[1], powers[2], powers[3]
    gradient[:] = 0.0
    hessian[:] = 0.0
    energy = 0.0
    n, k = len(runs), 0
    while k < n:
        ew, es = runs[k, 1], runs[k, 2]
        f = fu = fp = fuu = fup = fpp = 0.0
        while k < n and runs[k, 1] == ew and runs[k, 2] == es:
            eu, first, begin = runs[k, 0], runs[k, 3], runs[k, 4]
            r0 = r1 = r2 = 0.0
            for i in range(runs[k, 5] - begin):
                c = coefficients[begin + i]
                r0 += c * of_phi[0, first + i]
                r1 += c * of_phi[1, first + i]
                r2 += c * of_phi[2, first + i]
            u0, u1, u2 = of_u[0, eu], of_u[1, eu], of_u[2, eu]
            f += u0 * r0
            fu += u1 * r0
            fp += u0 * r1
            fuu += u2 * r0
            fup += u1 * r1
            fpp += u0 * r2
            k += 1
        w0, w1, w2 = of_w[0, ew], of_w[1, ew], of_w[2, ew]
        s0, s1, s2 = of_s[0, es], of_s[1, es], of_s[2, es]
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


@njit(cache=True, error_model="numpy")
def _add_walls(law, q, gradient, hessian):
    thickness, bounds = law.thickness, law.bounds
    energy = 0.0
    for i in range(4):
        scale = thickness if i < 3 else 1.0
        x, low, high = q[i] / scale, bounds[i, 0] / scale, bounds[i, 1] / scale
        if low <= x <= high:
            continue
        stiffness = _WALL * law.at_rest[i]
        distance, reach = x - (low if x < low else high), _REACH * (high - low)
        y = abs(distance) / reach
        log_cosh = y + np.log1p(np.exp(-2.0 * y)) - np.log(2.0)
        energy += stiffness * (0.5 * distance**2 - reach**2 * log_cosh)
        gradient[i] += stiffness * (distance - reach * np.tanh(distance / reach))
        hessian[i, i] += stiffness * np.tanh(y) ** 2
    return energy


@njit(cache=True, error_model="numpy")
def _laws_at(law, poses, energies, gradients, hessians):
    powers = np.empty((4, 3, MOST_POWER + 1))
    for k in range(len(poses)):
        energies[k] = law_at(law, poses[k], powers, gradients[k], hessians[k], 2)


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
        exponents = np.asarray(self.exponents, dtype=np.int64)
        order = np.lexsort(exponents[:, [3, 0, 1, 2]].T)  # by s, w, u, then phi
        exponents = exponents[order]
        follows = (np.diff(exponents, axis=0) == (0, 0, 0, 1)).all(axis=1)
        begins = np.concatenate([[0], np.flatnonzero(~follows) + 1])
        ends = np.append(begins[1:], len(exponents))
        coefficients = np.asarray(self.coefficients, dtype=float)[order]
        squares = [(exponents == 2 * row).all(axis=1) for row in np.eye(4, dtype=np.int64)]
        return LawTable(
            np.column_stack([exponents[begins], begins, ends]),
            coefficients,
            exponents.max(axis=0, initial=0),
            np.array([2.0 * coefficients[of].sum() for of in squares]),
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

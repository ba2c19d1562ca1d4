"""Bending law of a scaled sheet: what the format python-function writes below its numbers.

Needs NumPy alone. Nothing is written in place and nothing depends on values, so that all of it
also takes JAX arrays, traced and differentiated ones included (with jax_enable_x64, or digits are
lost).
"""

from __future__ import annotations

from typing import Any

import numpy as np

#: Numbers of the law, see `LawNumbers` and its docstring; a file that is exported has them here.
LAW: dict[str, Any] = {}

# --- what follows is the same in every exported file -------------------------------------------

#: Of second derivatives, in the order in which they are kept.
_ENTRIES = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))


def energy(k_xx: Any, k_yy: Any, k_xy: Any) -> Any:
    """Bending energy per area [N/mm], (...) of curvatures (...) [1/mm]; closing > 0."""
    return _bend(k_xx, k_yy, k_xy)[1].value


def gradient(k_xx: Any, k_yy: Any, k_xy: Any) -> Any:
    """(..., 3) N: dW/dk_xx, dW/dk_yy, dW/dk_xy; the last one is twice the twisting moment."""
    return energy_gradient_hessian(k_xx, k_yy, k_xy)[1]


def hessian(k_xx: Any, k_yy: Any, k_xy: Any) -> Any:
    """(..., 3, 3) N mm, second derivatives by k_xx, k_yy, k_xy."""
    return energy_gradient_hessian(k_xx, k_yy, k_xy)[2]


def energy_gradient_hessian(k_xx: Any, k_yy: Any, k_xy: Any) -> tuple[Any, Any, Any]:
    """All three at once, (...), (..., 3) and (..., 3, 3)."""
    xp, jet = _bend(k_xx, k_yy, k_xy)
    zero = 0.0 * jet.value
    first = xp.stack([zero + item for item in jet.first], axis=-1)
    second = {at: zero + item for at, item in zip(_ENTRIES, jet.second, strict=True)}
    rows = [xp.stack([second[min(i, j), max(i, j)] for j in range(3)], axis=-1) for i in range(3)]
    return jet.value, first, xp.stack(rows, axis=-2)


def within_data(k_xx: Any, k_yy: Any, k_xy: Any) -> Any:
    """Whether both principal curvatures are within the data that the law was fitted to."""
    xp = _namespace(k_xx, k_yy, k_xy)
    low, high = LAW["principal_bounds"]
    slack = 1e-9 * max(high, -low)
    mean = 0.5 * (xp.asarray(k_xx) + xp.asarray(k_yy))
    radius = xp.hypot(0.5 * (xp.asarray(k_xx) - xp.asarray(k_yy)), xp.asarray(k_xy))
    return (mean - radius >= low - slack) & (mean + radius <= high + slack)


class _Jet:
    """A value with its first (3) and second (6) derivatives by (k_xx, k_yy, k_xy)."""

    __array_ufunc__ = None  # an array times a jet is a jet, not an array of jets

    def __init__(self, value: Any, first: Any, second: Any = (0.0,) * 6) -> None:
        self.value, self.first, self.second = value, tuple(first), tuple(second)

    def entries(self) -> tuple[Any, ...]:
        return (self.value, *self.first, *self.second)

    def __add__(self, other: Any) -> _Jet:
        if not isinstance(other, _Jet):
            return _Jet(self.value + other, self.first, self.second)
        return _from(x + y for x, y in zip(self.entries(), other.entries(), strict=True))

    __radd__ = __add__

    def __mul__(self, other: Any) -> _Jet:
        if not isinstance(other, _Jet):
            return _from(other * x for x in self.entries())
        a, b, x, y = self.value, other.value, self.first, other.first
        first = [b * x[i] + a * y[i] for i in range(3)]
        second = [
            b * self.second[n] + a * other.second[n] + x[i] * y[j] + x[j] * y[i]
            for n, (i, j) in enumerate(_ENTRIES)
        ]
        return _Jet(a * b, first, second)

    __rmul__ = __mul__

    def __sub__(self, other: Any) -> _Jet:
        return self + -1.0 * other

    def through(self, value: Any, rate: Any, curve: Any) -> _Jet:
        """A function of this, by its value and its two derivatives."""
        x = self.first
        second = [rate * self.second[n] + curve * x[i] * x[j] for n, (i, j) in enumerate(_ENTRIES)]
        return _Jet(value, [rate * item for item in x], second)


def _from(entries: Any) -> _Jet:
    value, *rest = entries
    return _Jet(value, rest[:3], rest[3:])


def _where(xp: Any, condition: Any, yes: _Jet, no: _Jet) -> _Jet:
    pairs = zip(yes.entries(), no.entries(), strict=True)
    return _from(xp.where(condition, x, y) for x, y in pairs)


def _inverse(jet: _Jet) -> _Jet:
    one = 1.0 / jet.value
    return jet.through(one, -one * one, 2.0 * one * one * one)


def _namespace(*arrays: Any) -> Any:
    """Of the array library that the arguments are of."""
    found = [x.__array_namespace__() for x in arrays if hasattr(x, "__array_namespace__")]
    return next((xp for xp in found if xp is not np), np)


def _bend(k_xx: Any, k_yy: Any, k_xy: Any) -> tuple[Any, _Jet]:
    """The energy: of C, of double curvature, and of both principal directions."""
    xp = _namespace(k_xx, k_yy, k_xy)
    zero = 0.0 * (xp.asarray(k_xx) + xp.asarray(k_yy) + xp.asarray(k_xy))
    xx = _Jet(k_xx + zero, (1.0, 0.0, 0.0))
    yy = _Jet(k_yy + zero, (0.0, 1.0, 0.0))
    xy = _Jet(k_xy + zero, (0.0, 0.0, 1.0))
    c, k = LAW["tangent"], (xx, yy, 2.0 * xy)
    bent = _Jet(zero, (0.0,) * 3)
    for stiffness, (i, j) in zip(c, _ENTRIES, strict=True):
        bent = bent + (0.5 if i == j else 1.0) * stiffness * k[i] * k[j]
    soft = LAW["softening"]
    if soft > 0.0:
        rate = 1.0 / (1.0 + soft * bent.value)
        bent = bent.through(xp.log1p(soft * bent.value) / soft, rate, -soft * rate * rate)
    det = xx * yy - xy * xy
    total = bent + 0.5 * LAW["biaxial"] * det * det
    s, d = 0.5 * (xx + yy), 0.5 * (xx - yy)
    t = d * d + xy * xy
    n, g = s * s + t, s * s - t
    flat = n.value <= 0.0
    n = _where(xp, flat, _Jet(1.0 + zero, (0.0,) * 3), n)
    square = t + LAW["eta2"] * (g * g * _inverse(n)) + LAW["delta2"]
    none = square.value <= 0.0
    square = _where(xp, none, _Jet(1.0 + zero, (0.0,) * 3), square)
    root = xp.sqrt(square.value)
    radius = square.through(root, 0.5 / root, -0.25 / (root * square.value))
    over = _inverse(radius)
    for sign in (1.0, -1.0):
        added = _direction(xp, s + sign * radius, sign * d * over, sign * xy * over)
        total = total + xp.where(none, 0.0, 1.0) * added
    return xp, total


def _direction(xp: Any, kappa: _Jet, p: _Jet, q: _Jet) -> _Jet:
    """own/2 a κ² + (b − a)/2 (|κ| − κ0)₊² of a principal curvature in the direction (p, q)."""
    closes = kappa.value >= 0.0
    a = _harmonics(xp, closes, (LAW["a"], LAW["a"]), p, q)
    b = _harmonics(xp, closes, LAW["b"], p, q)
    onset = _harmonics(xp, closes, LAW["onset"], p, q)
    kind = xp.where(closes, *LAW["onset_kind"])
    # Harmonics of 1/κ0 that are 0 or less, or 1e9 mm at most, say that there is no contact.
    touches = (kind == 0) | ((kind == 1) & (onset.value > 1e-9))
    safe = _where(xp, onset.value > 1e-9, onset, _Jet(1.0 + 0.0 * onset.value, (0.0,) * 3))
    onset = _where(xp, kind == 0, onset, _inverse(safe))
    beyond = xp.where(closes, 1.0, -1.0) * kappa - onset
    reached = xp.where(touches & (beyond.value > 0.0), 1.0, 0.0)
    depth = reached * beyond.value
    excess = beyond.through(depth * depth, 2.0 * depth, 2.0 * reached)
    return 0.5 * LAW["own"] * (a * kappa * kappa) + 0.5 * ((b - a) * excess)


def _harmonics(xp: Any, closes: Any, sides: Any, p: _Jet, q: _Jet) -> _Jet:
    """Σ c_k cos 2kθ + s_k sin 2kθ as Re Σ (c_k − i s_k)(p + i q)^k, by Horner's rule."""
    coefficient = [xp.where(closes, *pair) for pair in zip(*sides, strict=True)]
    real, imaginary = coefficient[3] + 0.0 * p, -coefficient[7] + 0.0 * q
    for k in (2, 1, 0):
        real, imaginary = (
            real * p - imaginary * q + coefficient[k],
            real * q + imaginary * p - coefficient[4 + k],
        )
    return real

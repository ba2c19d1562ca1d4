"""A reader of HYLC's spline materials, after the authors' simulator; it shares nothing with ours.

`parse` of hylc_conf.cpp and `psi` of SplineMaterial.cpp, HermiteSpline1D.hpp, HermiteSpline2D.hpp.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np


def cubic(t: list[float], p: list[float], m: list[float], x: float) -> float:
    """Value at x of a Hermite spline; a straight line on both outsides."""
    if x < t[0]:
        return p[0] + m[0] * (x - t[0])
    if x >= t[-1]:
        return p[-1] + m[-1] * (x - t[-1])
    i = int(np.searchsorted(t, x, side="right")) - 1
    h = t[i + 1] - t[i]
    u = (x - t[i]) / h
    return (
        p[i] * (1 + 2 * u) * (1 - u) ** 2
        + p[i + 1] * u**2 * (3 - 2 * u)
        + h * m[i] * u * (1 - u) ** 2
        - h * m[i + 1] * u**2 * (1 - u)
    )


def bicubic(spline: dict, x: float, y: float) -> float:
    """Value at (x, y): splines along u in every row of v, then one along v through them."""
    tu, tv = spline["tu"], spline["tv"]
    shape = (len(tv), len(tu))
    p, mu, mv, muv = (np.reshape(spline[name], shape) for name in ("p", "mu", "mv", "muv"))
    values = [cubic(tu, p[i], mu[i], x) for i in range(len(tv))]
    slopes = [cubic(tu, mv[i], muv[i], x) for i in range(len(tv))]
    return cubic(tv, values, slopes, y)


class Material:
    """A material: `psi` in J/m2."""

    def __init__(self, path: Path) -> None:
        content = json.loads(path.read_text())
        assert isinstance(content["density"], float)
        self.scale = content["strain scale"]
        assert len(self.scale) == 5
        coefficients = content["coeffs"]
        self.constant, self.one, self.two = (coefficients[name] for name in ("const", "1D", "2D"))
        for spline in self.one:
            assert isinstance(spline["k"], int)
            assert len(spline["t"]) == len(spline["p"]) == len(spline["m"]) > 1
            assert (np.diff(spline["t"]) > 0.0).all()
        for spline in self.two:
            assert 0 <= spline["k0"] < spline["k1"]
            assert spline["k0"] < 3
            size = len(spline["tu"]) * len(spline["tv"])
            assert all(len(spline[name]) == size for name in ("p", "mu", "mv", "muv"))

    def psi(self, strain: np.ndarray) -> float:
        """Energy density at (s_x, s_a, s_y, b_xx, b_xy, b_yy), curvatures in 1/m."""
        s = [strain[i] / self.scale[i] for i in range(3)]
        values, vectors = np.linalg.eigh([[strain[3], strain[4]], [strain[4], strain[5]]])
        small, large = values
        cc = vectors[0, 1] ** 2  # of the first, the larger curvature
        total = self.constant
        for spline in self.one:
            k = spline["k"]
            if k < 3:
                total += cubic(spline["t"], spline["p"], spline["m"], s[k])
                continue
            at_large, at_small = (
                cubic(spline["t"], spline["p"], spline["m"], value / self.scale[k])
                for value in (large, small)
            )
            share = cc if k == 3 else 1.0 - cc
            total += share * at_large + (1.0 - share) * at_small
        for spline in self.two:
            assert spline["k1"] < 3, "splines of strain and curvature are not among ours"
            total += bicubic(spline, s[spline["k0"]], s[spline["k1"]])
        return total

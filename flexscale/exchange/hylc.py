"""Format hylc: the spline material of homogenized yarn-level cloth (Sperl, Narain, Wojtan 2020).

Read by `SplineMaterial` of the authors' simulator ARCSim-HYLC, in SI units. The state is (s_x, s_a,
s_y, b_xx, b_xy, b_yy): stretches minus 1 along x and y, the cosine of the angle between the two,
and the second fundamental form, > 0 where the sheet is concave on the side of its normal. With
principal curvatures λ1, λ2 and c² = cos² of the angle between x and the first of them, a material
is a sum of cubic Hermite splines of one or two variables over their scales,

    W = const + f0(s_x) + f1(s_a) + f2(s_y) + f01(s_x, s_a) + f02(s_x, s_y) + f12(s_a, s_y)
        + c² f3(λ1) + (1 − c²) f3(λ2) + c² f4(λ2) + (1 − c²) f4(λ1) + …

That form holds the in-plane stiffness, in the simulator's own strains, and our law of bending along
x and along y. Between the two it interpolates by c², and curvatures do not act on one another: how
far that is from the law is measured and written into the file.
"""

from __future__ import annotations

import json
import logging
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.errors import BadInputError
from flexscale.exchange.bending import (
    bend_all_ways,
    bending_law,
    data_sentence,
    evaluate_bending,
    principal_bounds,
)
from flexscale.exchange.subject import Subject
from flexscale.mechanics.sheet_law import SheetLaw

log = logging.getLogger(__name__)

#: From N/mm to J/m2, from 1/mm to 1/m, from N/mm to N/m.
_ENERGY = _CURVATURE = _STIFFNESS = 1e3
#: Splines of strain, which are exact, end here; the simulator goes on in straight lines.
_LARGEST_STRAIN = 0.5
#: Error of the splines of bending over the largest energy, and the shortest interval of knots over
#: the range.
_TOLERANCE, _SHORTEST = 1e-6, 1.0 / 4096.0
_DIRECTIONS = 36

Spline = dict[str, Any]


def write_hylc(subject: Subject, path: Path) -> None:
    """Write the material as JSON, with what it is and what it loses under the key flexscale."""
    model = subject.require_model("A HYLC material")
    if model.in_plane is None:
        raise BadInputError(
            f"A HYLC material needs the in-plane stiffness, which {subject.source} does not know: "
            "fit it again with fs.fit(sweep, tangent=fs.tangent_stiffness(pattern))."
        )
    low, high = principal_bounds(model)
    scale = max(high, -low) * _CURVATURE
    law = bending_law(model)
    along = [_bending_spline(law, angle, low, high, scale) for angle in (0.0, 0.5 * np.pi)]
    bending = [{"k": 3 + i, **spline} for i, spline in enumerate(along)]
    departure = _departure(law, low, high)
    log.warning(
        "HYLC's form takes energies between x and y from those along them: of %s, single "
        "curvatures in other directions are off by %.0f %% (median) and %.0f %% (most); its "
        "density is not known, and 1 kg m-2 in the file.",
        subject.source,
        100.0 * departure["median"],
        100.0 * departure["largest"],
    )
    content = {
        "density": 1.0,
        "strain scale": [1.0, 1.0, 1.0, scale, scale],
        "strain shift": [1, 0, 1, 0, 0],
        "coeffs": {
            "const": 0.0,
            "1D": [*_stretch_splines(model.in_plane * _STIFFNESS), *bending],
            "2D": _coupled_splines(model.in_plane * _STIFFNESS),
        },
        "flexscale": {
            "source": subject.title(),
            "units": "SI: W in J/m2, curvature in 1/m, density in kg/m2",
            "axes": "x and y are the pattern's, the normal points to the side of the scales",
            "density": "not known: 1 stands in, as in the simulator without a material",
            "data": data_sentence(model),
            "departure from the law": departure,
        },
    }
    path.write_text(json.dumps(content, indent=1, allow_nan=False) + "\n", encoding="utf-8")


def _stretch_splines(a: FloatArray) -> list[Spline]:
    """½ A_ii s² for s_x, s_a and s_y, of A (3, 3) for (xx, yy, xy): cubics hold it exactly."""
    t = np.array([-_LARGEST_STRAIN, 0.0, _LARGEST_STRAIN])
    return [
        {
            "k": k,
            "t": t.tolist(),
            "p": (0.5 * a[i, i] * t**2).tolist(),
            "m": (a[i, i] * t).tolist(),
        }
        for k, i in enumerate((0, 2, 1))
    ]


def _coupled_splines(a: FloatArray) -> list[Spline]:
    """A_ij s_i s_j of two different strains: bilinear, and exact at any strain.

    The first variable runs fastest.
    """
    t = np.array([-_LARGEST_STRAIN, _LARGEST_STRAIN])
    v, u = np.meshgrid(t, t, indexing="ij")
    order = (0, 2, 1)
    splines = []
    for k0, k1 in ((0, 1), (0, 2), (1, 2)):
        c = a[order[k0], order[k1]]
        values = {"p": c * u * v, "mu": c * v, "mv": c * u, "muv": np.full((2, 2), c)}
        grid = {name: item.ravel().tolist() for name, item in values.items()}
        splines.append({"k0": k0, "k1": k1, "tu": t.tolist(), "tv": t.tolist(), **grid})
    return splines


def _bending_spline(law: SheetLaw, angle: float, low: float, high: float, scale: float) -> Spline:
    """Spline of the law of single curvatures in a direction [radian], by curvature over scale."""

    def along(curvatures: FloatArray) -> tuple[FloatArray, FloatArray]:
        tensors = bend_all_ways(curvatures, np.full(len(curvatures), angle))
        energy, gradient = evaluate_bending(law, tensors)
        slope = gradient @ bend_all_ways(np.ones(1), np.array([angle]))[0]
        return energy, slope

    # The flat sheet is a knot, and a side without data has one interval, to go on with.
    start = np.unique([low or -0.5 * high, 0.0, high or -0.5 * low])
    knots = _refined(along, start)
    energy, slope = along(knots)
    return {
        "t": (knots * _CURVATURE / scale).tolist(),
        "p": (energy * _ENERGY).tolist(),
        "m": (slope * _ENERGY * scale / _CURVATURE).tolist(),
    }


def _refined(
    along: Callable[[FloatArray], tuple[FloatArray, FloatArray]], knots: FloatArray
) -> FloatArray:
    """Knots halved until cubics between them are as near as `_TOLERANCE`, also at kinks."""
    largest = float(np.abs(along(knots)[0]).max())
    shortest = _SHORTEST * float(np.ptp(knots))
    while True:
        energy, slope = along(knots)
        step = np.diff(knots)
        far = np.zeros(len(step), dtype=bool)
        for t in (0.25, 0.5, 0.75):
            found = hermite(t, step, (energy[:-1], energy[1:]), (slope[:-1], slope[1:]))
            far |= np.abs(found - along(knots[:-1] + t * step)[0]) > _TOLERANCE * largest
        far &= step > shortest
        if not far.any():
            return knots
        knots = np.sort(np.concatenate([knots, (knots[:-1] + 0.5 * step)[far]]))


def hermite(
    t: float,
    step: FloatArray,
    values: tuple[FloatArray, FloatArray],
    slopes: tuple[FloatArray, FloatArray],
) -> FloatArray:
    """Cubics at the share t of intervals of lengths `step`, by values and slopes at both ends."""
    (p0, p1), (m0, m1) = values, slopes
    return (
        (2 * t**3 - 3 * t**2 + 1) * p0
        + (t**3 - 2 * t**2 + t) * step * m0
        + (3 * t**2 - 2 * t**3) * p1
        + (t**3 - t**2) * step * m1
    )


def _departure(law: SheetLaw, low: float, high: float) -> dict[str, Any]:
    """How far the form above is from the law, for single curvatures in other directions."""
    angles = np.arange(_DIRECTIONS) * np.pi / _DIRECTIONS
    curvatures = [k for end in (low, high) if end for k in (0.25 * end, 0.5 * end, end)]
    k, angle = (item.ravel() for item in np.meshgrid(curvatures, angles, indexing="ij"))
    x, y, real = (
        evaluate_bending(law, bend_all_ways(k, direction))[0]
        for direction in (np.zeros_like(angle), np.full_like(angle, 0.5 * np.pi), angle)
    )
    form = np.cos(angle) ** 2 * x + np.sin(angle) ** 2 * y
    off = np.abs(form / real - 1.0)
    return {
        "of": "energy of single curvatures in all directions, relative; 0 along x and y",
        "median": float(np.median(off)),
        "largest": float(off.max()),
        "two curvatures": "energies of the two principal curvatures are added",
    }

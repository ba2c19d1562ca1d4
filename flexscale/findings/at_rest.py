"""Findings on small curvatures: what symmetry makes of the stiffness, and double curvature.

They are read off tangents, which were solved without making use of symmetry.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.findings.measures import spread
from flexscale.findings.pattern_data import PatternData
from flexscale.findings.verdict import Evidence, Finding

SAME = 0.01  # stiffnesses closer than this count as equal: the order of the mesh error
STRONG = 5.0  # times the softest cylinder


def three_fold_is_isotropic(patterns: Sequence[PatternData]) -> Finding:
    """Patterns whose directions repeat after 60 degree have one stiffness at rest."""
    evidence = []
    for item in patterns:
        if item.symmetry.period == 60.0:
            value = spread(item.tangent["stiffness"].values)
            numbers = f"stiffness {_range(item)} N mm, spread {100 * value:.1g} %"
            evidence.append(Evidence(item.name, value <= SAME, numbers))
    return Finding(
        "three-fold isotropic",
        "Three-fold rotational symmetry implies an isotropic response for small curvatures "
        "(Figs. 7a, 8h).",
        f"three- and six-fold patterns: stiffness at rest varies by at most {100 * SAME:g} %",
        tuple(evidence),
    )


def four_fold_is_tetragonal(patterns: Sequence[PatternData]) -> Finding:
    """Four-fold patterns are as stiff across as along, and not isotropic."""
    evidence = []
    for item in patterns:
        if item.symmetry.period == 90.0:
            directions = np.arange(0.0, 180.0, 1.0)
            here = stiffness(item, directions)
            odd = float(np.max(np.abs(here - stiffness(item, directions + 90.0))) / here.max())
            wide = spread(here)
            numbers = f"along and across differ by {100 * odd:.1g} %, spread {100 * wide:.0f} %"
            evidence.append(Evidence(item.name, odd <= SAME < wide, numbers))
    return Finding(
        "four-fold tetragonal",
        "Four-fold rotational symmetry implies tetragonal behavior, equally stiff in two "
        "orthogonal directions (Fig. 7b).",
        f"four-fold patterns: stiffness at rest repeats after 90° within {100 * SAME:g} %, and "
        "varies by more than that in between",
        tuple(evidence),
    )


def reflections_are_orthotropic(patterns: Sequence[PatternData]) -> Finding:
    """Patterns with reflections only are symmetric about the mirror, and not isotropic."""
    evidence = []
    for item in patterns:
        if item.symmetry.period == 180.0 and item.symmetry.mirrors:
            axis = item.symmetry.mirrors[0]
            turns = np.arange(1.0, 90.0, 1.0)
            left, right = stiffness(item, axis + turns), stiffness(item, axis - turns)
            odd = float(np.max(np.abs(left - right)) / max(left.max(), right.max()))
            wide = spread(stiffness(item, np.arange(0.0, 180.0, 1.0)))
            numbers = f"mirror at {axis:g}°, sides differ by {100 * odd:.1g} %, {_range(item)} N mm"
            evidence.append(Evidence(item.name, odd <= SAME < wide, numbers))
    return Finding(
        "reflection orthotropic",
        "Patterns with one- or two-axis reflection symmetry show orthotropic behavior for small "
        "curvatures (Figs. 7c, 7d, 8e, 8f, 8g).",
        f"patterns with reflections and no higher rotation: stiffness at rest is mirrored within "
        f"{100 * SAME:g} %, and not isotropic",
        tuple(evidence),
    )


def double_curvature_is_resisted(patterns: Sequence[PatternData]) -> Finding:
    """Bending to both ways at once against the softest cylinder."""
    evidence = []
    for item in patterns:
        cheapest, kind = double_curvature(item.tangent["matrix"].values)
        softest = float(stiffness(item, np.arange(0.0, 180.0, 0.5)).min())
        ratio = cheapest / softest
        coupling = float(item.tangent["matrix"].values[0, 1])
        numbers = (
            f"{kind} {cheapest:.3g} N mm = {ratio:.3g} x softest cylinder, C_xxyy {coupling:.3g}"
        )
        evidence.append(Evidence(item.name, ratio >= STRONG, numbers))
    return Finding(
        "double curvature",
        "Scaled sheets strongly resist double curvature, which a penalty on det(κ)² enforces "
        "(Sec. 3.3, Eq. 13).",
        f"at rest: the cheapest dome or saddle costs at least {STRONG:g} times the softest "
        "cylinder of the same curvature (two crossed cylinders of that kind would cost 2)",
        tuple(evidence),
        why="At rest the paper's penalty resists nothing either: it is of fourth order in the "
        "curvature. So is the stretching that a dome or a saddle asks of a whole sheet, and the "
        "stiffness of a cell does not hold it.",
    )


def double_curvature(matrix: FloatArray) -> tuple[float, str]:
    """Least k C k (N mm) of curvatures (1, ±1) along any two orthogonal axes, and which it is.

    Parameters
    ----------
    matrix : (3, 3) N mm, energy density 1/2 k C k with k = (kxx, kyy, 2 kxy).
    """
    dome = np.array([1.0, 1.0, 0.0])
    turn = np.deg2rad(np.arange(0.0, 180.0, 0.5))
    saddles = np.stack([np.cos(turn), -np.cos(turn), 2.0 * np.sin(turn)])
    saddle = float(np.einsum("in,ij,jn->n", saddles, matrix, saddles).min())
    flat = float(dome @ matrix @ dome)
    return (flat, "dome") if flat < saddle else (saddle, "saddle")


def stiffness(item: PatternData, directions: FloatArray) -> FloatArray:
    """N mm in any directions (degree), from the tangent matrix."""
    matrix = item.tangent["matrix"].transpose("component", "other_component").values
    cosine, sine = np.cos(np.deg2rad(directions)), np.sin(np.deg2rad(directions))
    bending = np.stack([cosine**2, sine**2, 2.0 * cosine * sine])
    return np.asarray(np.einsum("in,ij,jn->n", bending, matrix, bending))


def _range(item: PatternData) -> str:
    values = stiffness(item, np.arange(0.0, 180.0, 0.5))
    low, high = f"{values.min():.4g}", f"{values.max():.4g}"
    return low if low == high else f"{low} to {high}"

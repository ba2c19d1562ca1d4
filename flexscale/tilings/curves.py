"""Curves on edges: reading, symmetry, and what the other edges of a class make of one curve.

A curve lives in its edge's frame: the edge runs from (0, 0) to (1, 0), the tile lies to the left,
y > 0. It belongs to the first edge of its class, counterclockwise. The other edges of the class
take its image under x -> 1 - x, y -> -y or both, as the symbol asks; so must the edge itself, if
its class is symmetric: S edges under both at once, U edges under the first, I edges under the
second, that is, these are straight.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.errors import TilingError, UnitRangeError, shown, suggest
from flexscale.tilings.families import Family
from flexscale.units import require_array

CURVE_POINTS = 33
#: Of the edge's length: ends and symmetric points must agree this well.
CURVE_TOLERANCE = 1e-6

MOST_POINTS = 100_000
FARTHEST = 100.0  # of the edge's length

_SYMMETRY = {
    "S": (np.array([-1.0, -1.0]), "a half turn about the middle of the edge"),
    "U": (np.array([-1.0, 1.0]), "a reflection in the edge's perpendicular bisector"),
}


def read_curves(
    family: Family, edges: Mapping[str, Any] | None
) -> tuple[dict[str, FloatArray], dict[str, FloatArray]]:
    """Curves as points, and completed to whole edges.

    Parameters
    ----------
    edges : class letter -> points (n, 2), or a function of t in [0, 1] that returns (x, y).

    Returns
    -------
    Letter -> points as given (functions: sampled), and letter -> points from (0, 0) to (1, 0).

    Raises
    ------
    TilingError : no such class, a straight class, wrong ends, or not symmetric as its kind asks.
    """
    given = {}
    if edges is not None and not isinstance(edges, Mapping):
        raise TilingError(f"The edges of a tiling are a dict of curves, not {shown(edges)}.")
    for letter, curve in (edges or {}).items():
        _require_curved_class(family, letter)
        given[letter] = _read_points(family, letter, curve)
    whole = {letter: _complete(family, letter, points) for letter, points in given.items()}
    return given, whole


def image_of_curve(curve: FloatArray, mirror_x: bool, mirror_y: bool) -> FloatArray:
    """The curve (n, 2) of another edge of the class, again from (0, 0) to (1, 0)."""
    x, y = curve.T
    image = np.stack([1.0 - x if mirror_x else x, -y if mirror_y else y], axis=1)
    return image[::-1] if mirror_x else image


def _require_curved_class(family: Family, letter: str) -> None:
    kinds = family.curve_kinds()
    if not isinstance(letter, str) or letter not in kinds:
        listed = ", ".join(f"{letter} ({kind})" for letter, kind in kinds.items())
        raise TilingError(
            f"Tiling family {family.name} has no edge class {shown(letter)}: a curve belongs to "
            f"the first edge of a class, and the classes are {listed}. {suggest(letter, kinds)}"
        )
    if kinds[letter] == "I":
        raise TilingError(
            f"Edge class {letter!r} of tiling family {family.name} lies on mirrors of the tiling "
            "and must stay straight: leave its curve out."
        )


def _read_points(family: Family, letter: str, curve: Any) -> FloatArray:
    where = f"The curve of edge class {letter!r} of tiling family {family.name}"
    if callable(curve):
        curve = _sample(curve)
    try:
        points = require_array(curve, "the curve", "1")
    except UnitRangeError:
        points = np.empty(0)
        _require_finite_points(curve, where)
    if points.ndim != 2 or points.shape[1:] != (2,) or not 2 <= len(points) <= MOST_POINTS:
        raise TilingError(
            f"{where} must be 2 to {MOST_POINTS} points (x, y), all finite, from (0, 0) to (1, 0), "
            f"not {shown(curve)}."
        )
    if np.abs(points).max() > FARTHEST:
        raise TilingError(f"{where} goes farther than {FARTHEST:g} lengths of the edge from it.")
    if np.abs(points[0]).max() > CURVE_TOLERANCE:
        raise TilingError(f"{where} must start at (0, 0), not at {_text(points[0])}.")
    repeated = np.linalg.norm(np.diff(points, axis=0), axis=1) < CURVE_TOLERANCE
    if repeated.any():
        number = int(np.argmax(repeated))
        raise TilingError(
            f"{where} has the point {_text(points[number])} twice, numbers {number} and "
            f"{number + 1}: give it once."
        )
    return points


def _require_finite_points(curve: Any, where: str) -> None:
    """Refuse the first point that is not finite, by its number; what are no points passes."""
    try:
        points = np.asarray(curve if len(curve) <= MOST_POINTS else ())
    except (TypeError, ValueError, OverflowError, RecursionError):
        return
    floats = points.dtype.kind == "f" and points.ndim == 2 and points.shape[1] == 2
    if floats and not np.isfinite(points).all():
        number = int(np.argmin(np.isfinite(points).all(axis=1)))
        raise TilingError(
            f"{where} has the point {_text(points[number])}, number {number}: give two finite "
            "numbers."
        )


def _sample(curve: Callable[[float], Any]) -> list[Any]:
    return [curve(float(t)) for t in np.linspace(0.0, 1.0, CURVE_POINTS)]


def _complete(family: Family, letter: str, points: FloatArray) -> FloatArray:
    """A whole curve, ends exact, from a whole one or, on symmetric edges, from its first half."""
    kind = family.curve_kinds()[letter]
    where = f"The curve of edge class {letter!r} ({kind}) of tiling family {family.name}"
    end = points[-1]
    whole = np.abs(end - (1.0, 0.0)).max() <= CURVE_TOLERANCE
    at_middle = abs(end[0] - 0.5) <= CURVE_TOLERANCE
    points = points.copy()
    points[0] = 0.0
    if whole:
        points[-1] = (1.0, 0.0)
        return points if kind == "J" else _symmetrized(points, kind, where)
    if kind == "J":
        raise TilingError(f"{where} must end at (1, 0), not at {_text(end)}.")
    if kind == "S" and not (at_middle and abs(end[1]) <= CURVE_TOLERANCE):
        raise TilingError(
            f"{where} must end at (1, 0), or at the middle (0.5, 0) if it is the first half, "
            f"not at {_text(end)}."
        )
    if kind == "U" and not at_middle:
        raise TilingError(
            f"{where} must end at (1, 0), or on the line x = 0.5 if it is the first half, "
            f"not at {_text(end)}."
        )
    points[-1] = (0.5, 0.0) if kind == "S" else (0.5, end[1])
    return np.concatenate([points, _partner(points, kind)[1:]])


def _partner(points: FloatArray, kind: str) -> FloatArray:
    """Image of the points under the symmetry of their edge, in the order of the edge."""
    signs, _ = _SYMMETRY[kind]
    return ((points - (0.5, 0.0)) * signs + (0.5, 0.0))[::-1]


def _symmetrized(points: FloatArray, kind: str, where: str) -> FloatArray:
    partner = _partner(points, kind)
    apart = np.abs(points - partner).max(axis=1)
    worst = int(np.argmax(apart))
    if apart[worst] > CURVE_TOLERANCE:
        raise TilingError(
            f"{where} must go into itself, point by point, under {_SYMMETRY[kind][1]}: its point "
            f"{_text(points[worst])} is {apart[worst]:.3g} from where it should be. Give only the "
            "first half, up to x = 0.5."
        )
    return 0.5 * (points + partner)


def _text(point: FloatArray) -> str:
    return f"({point[0]:.6g}, {point[1]:.6g})"

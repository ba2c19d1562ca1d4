"""An outline as few convex polygons: triangles, joined where the result is convex.

S. Hertel and K. Mehlhorn, "Fast triangulation of simple polygons" (1983): at most four times as
many parts as there must be.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flexscale.arrays import FloatArray
from flexscale.mesh.prism_surface import triangles_of

_STRAIGHT = 1e-6  # sine of the turn to the right that still counts as straight
_EMPTY = 1e-9  # of the outline's area: parts smaller than this are left out


def convex_parts(outline: FloatArray) -> list[NDArray[np.int64]]:
    """Corners (k_i,) of convex counterclockwise parts that fill an outline (m, 2), mm."""
    if _is_convex(outline, list(range(len(outline)))):
        return [np.arange(len(outline))]
    parts = [list(map(int, triangle)) for triangle in triangles_of(outline)]
    joined = True
    while joined:
        joined = _join_one(outline, parts)
    total = _area(outline, list(range(len(outline))))
    return [np.array(part) for part in parts if _area(outline, part) > _EMPTY * total]


def _join_one(outline: FloatArray, parts: list[list[int]]) -> bool:
    """Replace two parts with a common edge by their union if that is convex."""
    owner = {
        (part[k - 1], part[k]): number
        for number, part in enumerate(parts)
        for k in range(len(part))
    }
    for (a, b), one in owner.items():
        other = owner.get((b, a))
        if other is None or other == one:
            continue
        # One part from b on around to a, then the other from a on around to b.
        first, second = _from(parts[one], b), _from(parts[other], a)
        union = first + second[1:-1]
        if _is_convex(outline, union):
            for number in sorted((one, other), reverse=True):
                del parts[number]
            parts.append(union)
            return True
    return False


def _from(part: list[int], start: int) -> list[int]:
    at = part.index(start)
    return part[at:] + part[:at]


def _is_convex(outline: FloatArray, part: list[int]) -> bool:
    forward = np.roll(outline[part], -1, axis=0) - outline[part]
    forward /= np.linalg.norm(forward, axis=1, keepdims=True)
    after = np.roll(forward, -1, axis=0)
    turns = forward[:, 0] * after[:, 1] - forward[:, 1] * after[:, 0]
    return bool((turns > -_STRAIGHT).all())


def _area(outline: FloatArray, part: list[int]) -> float:
    x, y = outline[part].T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))

"""Isometries between tile polygons, found from their corners."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from flexscale.arrays import BoolArray, FloatArray
from flexscale.tilings.isometry import Isometry


def polygon_isometries(
    source: FloatArray,
    source_marks: BoolArray,
    target: FloatArray,
    target_marks: BoolArray,
    tolerance: float,
) -> Iterator[Isometry]:
    """All isometries that carry one polygon's corners, marks included, onto another's.

    Parameters
    ----------
    source, target : (n, 2) and (m, 2) counterclockwise corners, mm.
    source_marks, target_marks : (n,) and (m,) flags that an isometry must carry along.
    tolerance : largest distance between a corner's image and its partner, mm.

    Yields
    ------
    Orientation-preserving ones first; the identity leads when source and target are the same.
    """
    n = len(source)
    if n != len(target):
        return
    center, target_center = source.mean(axis=0), target.mean(axis=0)
    arms = source - center
    # The corner that the first one is carried to lies as far from the center.
    radii = np.linalg.norm(target - target_center, axis=1)
    may_be_first = np.abs(radii - np.linalg.norm(arms[0])) <= 4.0 * tolerance
    for reverses in (False, True):
        order = np.arange(n)[::-1] if reverses else np.arange(n)
        for shift in np.flatnonzero(may_be_first[order]).tolist():
            partner = np.roll(order, -shift)
            if not np.array_equal(source_marks, target_marks[partner]):
                continue
            linear = _fit_orthogonal(arms, target[partner] - target_center, reverses)
            if np.abs(arms @ linear.T + target_center - target[partner]).max() <= tolerance:
                yield Isometry(linear, target_center - linear @ center)


def congruence_measures(polygons: Sequence[FloatArray]) -> FloatArray:
    """Measures (n, 4) of polygons that no isometry changes, nor the corner that comes first.

    Numbers of corners, and in mm the mean, the root mean square and the largest of the corners'
    distances from their center: they change by less than the corners are moved.
    """
    return np.array([_measures(polygon) for polygon in polygons])


def _measures(polygon: FloatArray) -> tuple[float, float, float, float]:
    arms = polygon - polygon.mean(axis=0)
    radii = np.hypot(arms[:, 0], arms[:, 1])
    mean_square = float(radii @ radii) / len(radii)
    return float(len(radii)), float(radii.mean()), float(np.sqrt(mean_square)), float(radii.max())


def _fit_orthogonal(arms: FloatArray, images: FloatArray, reverses: bool) -> FloatArray:
    """Rotation (or reflection) that carries `arms` closest to `images`, in closed form."""
    sign = -1.0 if reverses else 1.0
    cosine = float(np.sum(arms[:, 0] * images[:, 0] + sign * arms[:, 1] * images[:, 1]))
    sine = float(np.sum(arms[:, 0] * images[:, 1] - sign * arms[:, 1] * images[:, 0]))
    norm = np.hypot(cosine, sine)
    if norm == 0.0:
        return np.eye(2)
    cosine, sine = cosine / norm, sine / norm
    return np.array([[cosine, -sign * sine], [sine, sign * cosine]])

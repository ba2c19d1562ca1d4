"""Scales on a sheet: which ones lie on it at rest, and the rigid motion that follows it best."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from flexscale.arrays import FloatArray
from flexscale.fabricate.layout import Layout, lay_out, moved, no_whole_scale
from flexscale.fabricate.shapes import Rectangle
from flexscale.mechanics.hct import QUADRATURE_POINTS, QUADRATURE_WEIGHTS
from flexscale.mesh.prism_surface import triangles_of
from flexscale.patterns import Pattern
from flexscale.sheets.bent_sheet import BentSheet
from flexscale.short_repr import ShortRepr

_STRAIGHT = 1e-4  # mm: corners closer than this to a straight line are none; 3 steps of the grid


@dataclass(frozen=True, eq=False, repr=False)
class LaidScale(ShortRepr):
    """A scale, or a piece of one, on the sheet at rest.

    Attributes
    ----------
    outline : (m, 2) counterclockwise, mm, where the sheet's rest rectangle begins at the origin.
    tile : which tile of the pattern's cell it stands on.
    whole : whether the sheet's border leaves it whole.
    """

    outline: FloatArray
    tile: int
    whole: bool


def lay_scales(
    pattern: Pattern, sheet: BentSheet, center: tuple[float, float] = (0.0, 0.0)
) -> list[LaidScale]:
    """The pattern's scales over the rest rectangle of a sheet, cut at its border.

    Pieces below 5 % of a tile are left out, as in printed sheets.

    Parameters
    ----------
    center : (2,) mm, point of the pattern that lies in the middle of the sheet.

    Raises
    ------
    FabricationError : no scale lies wholly on the sheet, or there are too many.
    """
    low, high = sheet.mesh.points.min(axis=0), sheet.mesh.points.max(axis=0)
    shape = Rectangle(float(high[0] - low[0]), float(high[1] - low[1]), pin=None)
    region, layout = shape.scaled_region(), Layout(sheet.direction, center)
    middle, least = 0.5 * (low + high), layout.least_area(pattern)
    found: list[LaidScale] = []
    for copies in lay_out(pattern, layout, region):
        wholes = [moved(copies.home, shift) for shift in copies.inside]
        pieces = [part for part in copies.pieces(region) if part.area >= least]
        for areas, whole in ((wholes, True), (pieces, False)):
            found += [LaidScale(_corners(area) + middle, copies.tile, whole) for area in areas]
    if not any(scale.whole for scale in found):
        raise no_whole_scale(pattern, layout, region, shape.name)
    return found


def _corners(area: shapely.Polygon) -> FloatArray:
    """(m, 2) counterclockwise corners without those on straight lines."""
    plain = shapely.orient_polygons(shapely.simplify(area, _STRAIGHT))
    return np.array(plain.exterior.coords)[:-1]


@dataclass(frozen=True, eq=False, repr=False)
class Placement(ShortRepr):
    """Rigid motions x = R X + t of scales from the sheet at rest (z = 0) to where they are.

    Attributes
    ----------
    rotations : (n, 3, 3).
    translations : (n, 3) mm.
    """

    rotations: FloatArray
    translations: FloatArray


def fit_placement(outlines: list[FloatArray], sheet: BentSheet) -> tuple[Placement, FloatArray]:
    """The motion of every scale that brings its base closest to the deformed sheet under it.

    Closest in the mean square over the base's area [paper: over mesh vertices, which weigh what is
    meshed finely]: in each triangle of the base the points of a rule of degree 4 ride on the sheet.

    Returns
    -------
    Placement, and root mean square distances (n,) of the bases from the sheet, mm.
    """
    places, weights = zip(*map(_area_points, outlines), strict=True)
    ends = np.cumsum([len(points) for points in places])
    ridden = np.split(sheet.at(np.concatenate(places)), ends[:-1])
    fits = [fit_rigid(*three) for three in zip(places, ridden, weights, strict=True)]
    rotations, translations, residuals = map(np.array, zip(*fits, strict=True))
    return Placement(rotations, translations), residuals


def fit_rigid(
    points: FloatArray, targets: FloatArray, weights: FloatArray
) -> tuple[FloatArray, FloatArray, float]:
    """Best proper rotation and translation of plane points (Procrustes, W. Kabsch 1976).

    Parameters
    ----------
    points : (n, 2) mm, in the plane z = 0; not all on one line.
    targets : (n, 3) mm, where they should go.
    weights : (n,) of the squared distances.

    Returns
    -------
    R (3, 3), t (3,) mm, and the root of the weighted mean of |R X + t - x|^2, mm.
    """
    share = weights / weights.sum()
    rest = np.column_stack([points, np.zeros(len(points))])
    rest_center, center = share @ rest, share @ targets
    u, _, vt = np.linalg.svd((targets - center).T @ ((rest - rest_center) * share[:, None]))
    # Reflections fit plane points as well as rotations do: the third direction decides.
    rotation = u @ np.diag([1.0, 1.0, np.linalg.det(u) * np.linalg.det(vt)]) @ vt
    shift = center - rotation @ rest_center
    squared = np.sum((rest @ rotation.T + shift - targets) ** 2, axis=1)
    return rotation, shift, float(np.sqrt(share @ squared))


def _area_points(outline: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Points (n, 2) and weights (n,) mm2 that integrate over an outline's area."""
    corners = outline[triangles_of(outline)]
    areas = 0.5 * np.linalg.det(corners[:, 1:] - corners[:, :1])
    points = np.einsum("qk,nkc->nqc", QUADRATURE_POINTS, corners).reshape(-1, 2)
    return points, np.outer(areas, QUADRATURE_WEIGHTS).ravel()

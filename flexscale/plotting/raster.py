"""Shaded pictures of triangles with a depth buffer.

matplotlib's own 3-D axes sort whole triangles by their mean depth, which draws the wrong one in
front where scales touch, cross or stand close together: just the places one wants to look at.
Here every pixel shows the nearest surface, in parallel projection, so lengths can be measured.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexscale.arrays import FloatArray

_LIGHT = np.array([-0.42, 0.62, 0.66])
_AMBIENT = 0.5
_CREASE_COSINE = 0.85  # surfaces of one body meeting at a sharper angle get an ink line
_INK = 0.45  # brightness of ink lines relative to the color under them
_SUPERSAMPLING = 2
_SMALL = 16  # triangles up to so many pixels wide and high are drawn together
_CHUNK = 5_000  # so many at a time


@dataclass(frozen=True)
class View:
    """Parallel projection seen from `azimuth` and `elevation` (degree) above the x-y plane."""

    azimuth: float
    elevation: float

    @property
    def axes(self) -> FloatArray:
        """(3, 3) rows: unit vectors pointing right, up, and toward the viewer."""
        turn, lift = np.deg2rad([self.azimuth, self.elevation])
        return np.array(
            [
                [-np.sin(turn), np.cos(turn), 0.0],
                [-np.sin(lift) * np.cos(turn), -np.sin(lift) * np.sin(turn), np.cos(lift)],
                [np.cos(lift) * np.cos(turn), np.cos(lift) * np.sin(turn), np.sin(lift)],
            ]
        )

    def project(self, points: FloatArray) -> FloatArray:
        """(…, 3) mm world to (…, 3) mm: right, up, depth toward the viewer."""
        return np.asarray(points @ self.axes.T)


@dataclass(frozen=True)
class Surfaces:
    """Triangles to be drawn, in view coordinates.

    corners : (n, 3, 3) mm, right, up, depth; colors : (n, 3) in 0..1; body : (n,) int, triangles
    of one body share a number; solid : (n,) bool, closed outward surfaces whose back is never
    seen.
    """

    corners: FloatArray
    colors: FloatArray
    body: np.ndarray
    solid: np.ndarray


def render(
    surfaces: Surfaces,
    window: tuple[float, float, float, float],
    pixels_per_mm: float,
    *,
    shaded: bool = True,
) -> FloatArray:
    """Picture of the surfaces inside a window of the view plane.

    Parameters
    ----------
    surfaces : in view coordinates.
    window : left, right, bottom, top in mm.
    pixels_per_mm : resolution of the result.
    shaded : with light and ink lines; else in the plain colors.

    Returns
    -------
    (rows, columns, 4) RGBA in 0..1, first row on top; transparent where nothing is.
    """
    left, right, bottom, top = window
    n_columns = max(int(np.ceil((right - left) * pixels_per_mm)), 1)
    n_rows = max(int(np.ceil((top - bottom) * pixels_per_mm)), 1)
    fine = _SUPERSAMPLING
    scale = np.array([n_columns / (right - left), n_rows / (top - bottom)]) * fine
    pixels = (surfaces.corners[:, :, :2] - np.array([left, bottom])) * scale
    normals = _unit_normals(surfaces.corners)
    # Backs of closed solids are hidden anyway; dropping them halves the work.
    drawn = np.flatnonzero(~surfaces.solid | (normals[:, 2] > 0.0))
    depth = surfaces.corners[:, :, 2] - np.where(surfaces.solid, 1e-3, 0.0)[:, None]
    nearest = _nearest_triangle(pixels, depth, drawn, (n_rows * fine, n_columns * fine))
    image = _shade(nearest, normals, surfaces) if shaded else _plain(nearest, surfaces)
    image = image.reshape(n_rows, fine, n_columns, fine, 4)
    alpha = image[..., 3:]
    covered = alpha.mean(axis=(1, 3))
    color = (image[..., :3] * alpha).mean(axis=(1, 3)) / np.maximum(covered, 1e-12)
    return np.concatenate([color, covered], axis=-1)[::-1]


def _nearest_triangle(
    pixels: FloatArray, depth: FloatArray, drawn: np.ndarray, shape: tuple[int, int]
) -> np.ndarray:
    """(rows, columns) index of the triangle seen at each pixel center, -1 for none."""
    buffer = np.full(shape, -np.inf)
    nearest = np.full(shape, -1, dtype=np.int64)
    limits = np.array([shape[1], shape[0]])
    first = np.clip(np.ceil(pixels.min(axis=1) - 0.5).astype(int), 0, limits)
    last = np.clip(np.floor(pixels.max(axis=1) - 0.5).astype(int) + 1, 0, limits)
    (ax, ay), (bx, by), (cx, cy) = pixels[:, 0].T, pixels[:, 1].T, pixels[:, 2].T
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    drawn = drawn[(area[drawn] != 0.0) & np.all(first[drawn] < last[drawn], axis=1)]
    small = np.all(last[drawn] - first[drawn] <= _SMALL, axis=1)
    for t in drawn[~small]:
        (x0, y0), (x1, y1) = first[t], last[t]
        x = np.arange(x0, x1) + 0.5
        y = np.arange(y0, y1)[:, None] + 0.5
        # Barycentric weights of b and c at the pixel centers.
        weight_b = ((x - ax[t]) * (cy[t] - ay[t]) - (y - ay[t]) * (cx[t] - ax[t])) / area[t]
        weight_c = ((bx[t] - ax[t]) * (y - ay[t]) - (by[t] - ay[t]) * (x - ax[t])) / area[t]
        a, b, c = depth[t]
        here = a + weight_b * (b - a) + weight_c * (c - a)
        window = buffer[y0:y1, x0:x1]
        seen = (weight_b >= 0.0) & (weight_c >= 0.0) & (weight_b + weight_c <= 1.0)
        seen &= here > window
        window[seen] = here[seen]
        nearest[y0:y1, x0:x1][seen] = t
    for start in range(0, int(small.sum()), _CHUNK):
        some = drawn[small][start : start + _CHUNK]
        _draw_small(pixels, depth, some, first, last, buffer, nearest)
    return nearest


def _draw_small(
    pixels: FloatArray,
    depth: FloatArray,
    chosen: np.ndarray,
    first: np.ndarray,
    last: np.ndarray,
    buffer: FloatArray,
    nearest: np.ndarray,
) -> None:
    """Triangles of a few pixels each, all at once; one by one, the loop would take the time."""
    steps = np.arange(_SMALL)
    columns = (first[chosen, 0, None, None] + steps[None, None, :]).repeat(_SMALL, axis=1)
    rows = (first[chosen, 1, None, None] + steps[None, :, None]).repeat(_SMALL, axis=2)
    inside = (columns < last[chosen, 0, None, None]) & (rows < last[chosen, 1, None, None])
    place, at_row, at_column = np.nonzero(inside)
    x, y = columns[place, at_row, at_column], rows[place, at_row, at_column]
    triangle = chosen[place]
    a, b, c = pixels[triangle].transpose(1, 2, 0)
    point = np.stack([x, y]) + 0.5
    area = _cross(b - a, c - a)
    weight_b, weight_c = _cross(point - a, c - a) / area, _cross(b - a, point - a) / area
    at = depth[triangle].T
    here = at[0] + weight_b * (at[1] - at[0]) + weight_c * (at[2] - at[0])
    seen = (weight_b >= 0.0) & (weight_c >= 0.0) & (weight_b + weight_c <= 1.0)
    seen &= here > buffer[y, x]
    x, y, here, triangle = x[seen], y[seen], here[seen], triangle[seen]
    np.maximum.at(buffer, (y, x), here)
    wins = np.flatnonzero(here == buffer[y, x])[::-1]  # of equally near ones the first is drawn
    nearest[y[wins], x[wins]] = triangle[wins]


def _cross(first: FloatArray, second: FloatArray) -> FloatArray:
    return np.asarray(first[0] * second[1] - first[1] * second[0])


def _plain(nearest: np.ndarray, surfaces: Surfaces) -> FloatArray:
    """(rows, columns, 4) RGBA of the triangles seen, in their own colors."""
    color = np.vstack([surfaces.colors, np.ones(3)])[nearest]
    return np.concatenate([color, (nearest >= 0).astype(float)[..., None]], axis=-1)


def _shade(nearest: np.ndarray, normals: FloatArray, surfaces: Surfaces) -> FloatArray:
    """(rows, columns, 4) RGBA of the triangles seen, with ink lines at outlines and creases."""
    # A sheet is lit from whichever side it is seen.
    facing = np.where(normals[:, 2:] < 0.0, -normals, normals)
    light = _LIGHT / np.linalg.norm(_LIGHT)
    brightness = _AMBIENT + (1.0 - _AMBIENT) * np.clip(facing @ light, 0.0, 1.0)
    color = np.vstack([surfaces.colors * brightness[:, None], np.ones(3)])[nearest]
    body = np.append(surfaces.body, np.iinfo(np.int64).min)[nearest]
    normal = np.vstack([facing, np.zeros(3)])[nearest]
    crease = np.append(surfaces.solid, False)[nearest]
    ink = np.zeros(nearest.shape, dtype=bool)
    for one, other in (
        ((slice(None), slice(1, None)), (slice(None), slice(None, -1))),
        ((slice(1, None), slice(None)), (slice(None, -1), slice(None))),
    ):
        outline = body[one] != body[other]
        bend = np.einsum("ijk,ijk->ij", normal[one], normal[other]) < _CREASE_COSINE
        ink[one] |= outline | (bend & crease[one])
    color[ink & (nearest >= 0)] *= _INK
    return np.concatenate([color, (nearest >= 0).astype(float)[..., None]], axis=-1)


def _unit_normals(corners: FloatArray) -> FloatArray:
    """(n, 3) unit normals; zero for a triangle without area."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.asarray(normals / np.where(length > 0.0, length, 1.0))

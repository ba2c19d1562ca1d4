"""Discs of rigid scales on joints with a clamp of whole scales or a round one, under the probe."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

import flexscale as fs
from flexscale.arrays import BoolArray, FloatArray
from flexscale.finite.driven_sheet import DrivenSheet, follow_loads
from flexscale.finite.native_disc import NativeDisc, symmetry_center
from flexscale.finite.sheet_scales import find_sheet_scales
from flexscale.homogenize.native_model import NativeModel
from flexscale.patterns.cell import polygon_area
from flexscale.patterns.laid import LaidPattern, disc, lay_pattern
from flexscale.patterns.outlines import inset_corners

SIDE = 2.0  # mm, of the polygons that stand for circles
STEP = 15.0  # degree
INDENTATIONS = (1.0, 15.0)  # mm
LEAST = 1.0  # mm2, of a piece of a scale beyond a round clamp


@dataclass(frozen=True)
class Layout:
    """A disc.

    Attributes
    ----------
    pattern, radius : radius in mm.
    point : what of the pattern lies in the middle: "center 1" to "center 3", the three centers of
        three-fold turns in a cell; "corner" or "middle" of a hexagon; "nowhere", no center at all.
    clamp : "scales" or "round".
    hub : mm.
    """

    pattern: str
    point: str
    clamp: str
    hub: float
    radius: float = 100.0

    @property
    def name(self) -> str:
        """For tables and the log."""
        return f"{self.pattern}|{self.point}|{self.clamp}|{self.hub:g}|{self.radius:g}"

    @property
    def order(self) -> int:
        """Of turns about the middle."""
        return {"nowhere": 1, "middle": 6}.get(self.point, 3)

    @property
    def angles(self) -> FloatArray:
        """(n,) degree, of one turn of them."""
        step = 2.0 * STEP if self.order == 1 else STEP
        return np.arange(0.0, 360.0 / self.order, step)


LAYOUTS = (
    Layout("threefold", "center 1", "scales", 10.0),
    Layout("threefold", "center 1", "round", 17.0),
    Layout("hexagon", "corner", "scales", 10.0),
    Layout("hexagon", "corner", "round", 17.0),
    Layout("hexagon", "corner", "round", 13.0),
    Layout("hexagon", "corner", "round", 17.0, 95.0),
    Layout("hexagon", "middle", "scales", 10.0),
    Layout("threefold", "center 2", "scales", 10.0),
    Layout("threefold", "center 3", "scales", 10.0),
    Layout("threefold", "center 1", "scales", 5.0),
    Layout("threefold", "center 1", "scales", 20.0),
    Layout("threefold", "center 1", "scales", 30.0),
    Layout("threefold", "center 1", "scales", 10.0, 95.0),
    Layout("threefold", "nowhere", "scales", 10.0),
)


def middle_of(pattern: fs.Pattern, point: str) -> FloatArray:
    """(2,) mm, the point of a pattern that lies in the middle of a disc."""
    center, _ = symmetry_center(pattern)
    diagonal = pattern.lattice.sum(axis=0)
    if point == "middle":
        return center
    if point == "corner":
        tile = pattern.tiles[0]
        return np.asarray(tile[0])
    if point == "nowhere":
        return center + 0.17 * pattern.lattice[0] + 0.09 * pattern.lattice[1]
    # Centers of three-fold turns are a third of the cell's long diagonal apart.
    return center + (int(point[-1]) - 1) / 3.0 * diagonal


def clamp_scales(layout: Layout, pattern: fs.Pattern) -> tuple[LaidPattern, BoolArray]:
    """The pattern on the disc, and its scales that the hub touches."""
    middle = middle_of(pattern, layout.point)
    laid = lay_pattern(pattern, disc(layout.radius, SIDE), 0.0, middle)
    center = shapely.Point(0.0, 0.0)
    held = [shapely.Polygon(outline).distance(center) < layout.hub for outline in laid.outlines]
    return laid, np.array(held)


def clamp_round(layout: Layout, pattern: fs.Pattern) -> tuple[LaidPattern, BoolArray]:
    """The pattern cut along a circle, inside of which is one tile, that is held."""
    laid, _ = clamp_scales(layout, pattern)
    ring = shapely.Polygon(disc(layout.hub, SIDE))
    tiles: list[FloatArray] = []
    outlines: list[FloatArray] = []
    corners = [np.asarray(ring.exterior.coords)[:-1]]
    for tile, outline in zip(laid.tiles, laid.outlines, strict=True):
        shape = shapely.Polygon(tile)
        if not shape.intersects(ring):
            tiles.append(tile)
            outlines.append(outline)
            continue
        for part in shapely.get_parts(shape.difference(ring)):
            piece = np.asarray(shapely.orient_polygons(part).exterior.coords)[:-1]
            scale = inset_corners(piece, 0.5 * pattern.gap)
            if scale is None or polygon_area(scale) < LEAST:
                continue
            tiles.append(piece)
            outlines.append(scale)
            corners.append(
                piece[np.abs(shapely.distance(ring.exterior, shapely.points(piece))) < 1e-9]
            )
    inner = _around(np.concatenate(corners))
    scale = inset_corners(inner, 0.5 * pattern.gap)
    assert scale is not None
    tiles.append(inner)
    outlines.append(scale)
    held = np.zeros(len(tiles), dtype=bool)
    held[-1] = True
    whole = np.ones(len(tiles), dtype=bool)
    cut = LaidPattern(pattern, laid.border, 0.0, tuple(tiles), tuple(outlines), whole, laid.bare)
    return cut, held


def _around(points: FloatArray) -> FloatArray:
    """(n, 2) points about the origin by angle, each of them once."""
    turns = np.arctan2(points[:, 1], points[:, 0])
    points = points[np.argsort(turns)]
    apart = np.linalg.norm(points - np.roll(points, 1, axis=0), axis=1) > 1e-6
    return points[apart]


CLAMPS: dict[str, Callable[[Layout, fs.Pattern], tuple[LaidPattern, BoolArray]]] = {
    "scales": clamp_scales,
    "round": clamp_round,
}


class LaidDisc(NativeDisc):
    """A disc with a clamp of any scales."""

    def __init__(self, laid: LaidPattern, held: BoolArray, radius: float) -> None:
        native = NativeModel()
        groups = [(np.flatnonzero(held), np.zeros(2))]
        sheet = find_sheet_scales(laid, groups, native.contact.enabled)
        free = np.ones(6 * sheet.scales.n_scales + 3, dtype=bool)
        free[:6] = False
        free[-3:] = False
        self.radius = radius
        DrivenSheet.__init__(self, sheet, native, free)
        self._outlines = np.array([shapely.Polygon(outline) for outline in laid.outlines])
        self._probed = None


def free_lengths(
    laid: LaidPattern, held: BoolArray, angles: FloatArray, radius: float
) -> tuple[list[float], list[float]]:
    """mm, along the ray to each angle [degree] from the clamp's last point, and from the nearest
    point of the clamp."""
    shapes = [shapely.Polygon(laid.outlines[k]) for k in np.flatnonzero(held)]
    clamp = shapely.MultiPolygon(shapes)
    along, nearest = [], []
    for turn in np.radians(angles):
        way = np.array([np.cos(turn), np.sin(turn)])
        inside = shapely.LineString([np.zeros(2), radius * way]).intersection(clamp)
        along.append(radius - float((shapely.get_coordinates(inside) @ way).max()))
        nearest.append(float(clamp.distance(shapely.Point(radius * way))))
    return along, nearest


def measure(layout: Layout) -> dict[str, Any]:
    """Forces and free lengths around a disc."""
    start = time.process_time()
    pattern = fs.named_pattern(layout.pattern)
    laid, held = CLAMPS[layout.clamp](layout, pattern)
    angles = layout.angles
    device = LaidDisc(laid, held, layout.radius)
    forces, pairs = [], []
    for angle in angles.tolist():
        device.probe(angle, 1.0)
        samples = list(follow_loads(device, INDENTATIONS, device.native.solver))
        forces.append([sample.get("force", np.nan) for sample in samples])
        pairs.append(max(sample.get("contact_pairs", 0) for sample in samples))
    along, nearest = free_lengths(laid, held, angles, layout.radius)
    again = free_lengths(laid, held, angles + 360.0 / layout.order, layout.radius)
    assert np.allclose([along, nearest], again), "the middle is no center of such turns"
    return {
        "name": layout.name,
        "held": int(held.sum()),
        "scales": len(laid.tiles),
        "angles": angles.tolist(),
        "forces": forces,
        "pairs": pairs,
        "along": along,
        "nearest": nearest,
        "seconds": time.process_time() - start,
    }

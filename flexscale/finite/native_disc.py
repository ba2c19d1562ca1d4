"""A disc of scales on joints, clamped at its hub and pushed at its rim (Figs. 6, 9).

The disc lies in the world; a center of the pattern's symmetry lies in its middle. Scales that the
hub touches are held. The probe has no friction: it holds the height of the point of the rim that it
pushes, on the scale there or the nearest to it, and nothing else.
"""

from __future__ import annotations

import numpy as np
import shapely

from flexscale.arrays import BoolArray, FloatArray
from flexscale.errors import BadInputError, PatternError
from flexscale.finite.driven_sheet import DrivenSheet
from flexscale.finite.sheet_scales import find_sheet_scales, require_moderate_scales
from flexscale.homogenize.native_model import NativeModel
from flexscale.patterns.laid import LaidPattern, disc, lay_pattern
from flexscale.patterns.pattern import Pattern
from flexscale.units import require_positive

_SIDE = 2.0  # mm, of the polygon that stands for the disc's rim


def symmetry_center(pattern: Pattern) -> tuple[FloatArray, int]:
    """(2,) mm, a center of rotations of the highest order that a pattern has, and that order; of a
    pattern without any, the mean of its first scale's corners, and 1."""
    turns = [
        operation
        for operation in pattern.symmetry().operations
        if operation.kind == "rotation" and operation.angle % 360.0 > 0.0
    ]
    if not turns:
        return np.asarray(pattern.outlines()[0].mean(axis=0)), 1
    least = min(turns, key=lambda turn: min(turn.angle % 360.0, -turn.angle % 360.0))
    order = round(360.0 / min(least.angle % 360.0, -least.angle % 360.0))
    center = np.asarray(np.linalg.solve(np.eye(2) - least.linear, least.translation))
    return center, order


def lay_disc(pattern: Pattern, radius: float, hub: float) -> tuple[LaidPattern, BoolArray, int]:
    """A pattern on a disc, which of its scales the hub holds, and the order of its turns.

    Raises
    ------
    UnitRangeError : a size that is not positive.
    BadInputError : more scales than memory holds, or a hub that leaves nothing of the disc.
    PatternError : the hub holds every scale or none.
    """
    radius = require_positive(radius, "disc radius", "mm")
    hub = require_positive(hub, "hub radius", "mm")
    require_moderate_scales(pattern, np.pi * radius**2)
    if hub >= radius:
        raise BadInputError(
            f"A hub of {hub:g} mm leaves nothing of a disc of {radius:g} mm to push: make it "
            "smaller."
        )
    center, order = symmetry_center(pattern)
    laid = lay_pattern(pattern, disc(radius, _SIDE), 0.0, center)
    middle = shapely.Point(0.0, 0.0)
    held = np.array([shapely.Polygon(o).distance(middle) < hub for o in laid.outlines])
    if not held.any() or held.all():
        raise PatternError(
            f"A hub of {hub:g} mm holds {'every' if held.all() else 'no'} scale of a disc of "
            f"{radius:g} mm: change the hub."
        )
    return laid, held, order


class NativeDisc(DrivenSheet):
    """A disc clamped at its hub; the load is the indentation of a point of its rim.

    Parameters
    ----------
    pattern : the scale pattern.
    radius, hub : mm.
    native : contact and solver; of the model `joints`.

    Attributes
    ----------
    rotation_order : 1, 2, 3, 4 or 6, of the pattern about the disc's middle.

    Raises
    ------
    PatternError : the disc has no scale at its hub or none beyond it, or joints cannot be computed.
    BadInputError : a hub that leaves nothing of the disc.
    UnitRangeError : a size that is not positive.
    """

    def __init__(
        self, pattern: Pattern, radius: float, hub: float, native: NativeModel | None = None
    ) -> None:
        native = native or NativeModel()
        laid, held, self.rotation_order = lay_disc(pattern, radius, hub)
        sheet = find_sheet_scales(
            laid, [(np.flatnonzero(held), np.zeros(2))], native.contact.enabled
        )
        free = np.ones(6 * sheet.scales.n_scales + 3, dtype=bool)
        free[:6] = False
        free[-3:] = False
        self.radius, self.hub = radius, hub
        super().__init__(sheet, native, free)
        self._outlines = np.array([shapely.Polygon(o) for o in laid.outlines])
        self._probed: tuple[int, FloatArray] | None = None

    def probe(self, angle: float, sign: float) -> None:
        """Place the probe at an angle [degree] of the rim; +1 pushes it towards the scales' side.

        The scale that is pushed has its anchor there, so that the probe holds one unknown.
        """
        if self._probed is not None:
            self._anchor(*self._probed)
        turn = np.radians(angle)
        place = self.radius * np.array([np.cos(turn), np.sin(turn)])
        distances = shapely.distance(self._outlines, shapely.Point(place))
        distances[self.sheet.bodies == 0] = np.inf
        body = int(self.sheet.bodies[int(distances.argmin())])
        self._probed = (body, self.sheet.scales.anchors[body].copy())
        self._anchor(body, place)
        self.drive(6 * body + 2, sign)

    def _anchor(self, body: int, place: FloatArray) -> None:
        """Move the anchor of a scale, and all that is measured from there."""
        scales, table = self.sheet.scales, self.sheet.scales.rows.table
        shift = place - scales.anchors[body]
        scales.anchors[body] = place
        for side, factor in ((0, -1.0), (1, 1.0)):
            pairs = scales.pairs[:, side] == body
            scales.ways[pairs] += factor * shift
            self.stations.arms[pairs, side, :2] -= shift
            rows = pairs[scales.rows.pair] & (table.second == (side == 1))
            table.rest[rows, :2] -= shift
        self.embedding.forget()
        if self.contact is not None:
            self.contact.memory.places[:] = np.nan

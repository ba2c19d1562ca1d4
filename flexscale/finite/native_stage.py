"""A strip of scales on joints between two hinges that come closer (Figs. 10, 11).

The strip lies in the world. Scales that touch an end are one body with its anchor on the hinge, the
line x = 0 or x = length at the middle surface, about which it turns. Both hinges keep their height,
the near one its place; the machine moves the far one by the shortening. The sides are free.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from flexscale.arrays import FloatArray
from flexscale.embedding.bends import Bend
from flexscale.finite.driven_sheet import Driven, DrivenSheet
from flexscale.finite.native_sheet import strips_of
from flexscale.finite.sheet_scales import find_sheet_scales
from flexscale.homogenize.native_model import NativeModel
from flexscale.patterns.laid import lay_pattern, rectangle
from flexscale.patterns.pattern import Pattern

_NEAR, _FAR = 0, 1  # bodies
_TURN = 4  # of a body's unknowns: c about the hinge
_ARCS = 8  # times that the first shortening is quartered until scales are clear of one another


class NativeStage(DrivenSheet):
    """A strip between two hinges; the load is the shortening.

    Parameters
    ----------
    pattern : the scale pattern.
    length, width : mm.
    direction : degree, of the strip's length in the pattern's coordinates.
    offset : (2,) mm, point of the pattern that lies in the middle of the strip.
    native : contact and solver; of the model `joints`.

    Raises
    ------
    PatternError : the strip cannot be cut from the pattern, or joints cannot be computed.
    """

    rooted = True

    def __init__(
        self,
        pattern: Pattern,
        length: float,
        width: float,
        direction: float = 0.0,
        offset: Sequence[float] = (0.0, 0.0),
        native: NativeModel | None = None,
    ) -> None:
        native = native or NativeModel()
        laid = lay_pattern(pattern, rectangle(length, width), direction, offset)
        strips = strips_of(laid, length, width)
        sheet = find_sheet_scales(laid, strips, native.contact.enabled)
        self.length, self.width = length, width
        free = np.ones(6 * sheet.scales.n_scales + 3, dtype=bool)
        free[:12] = False
        free[[_TURN, 6 + _TURN, 6 * _FAR]] = True
        free[-3:] = False
        super().__init__(sheet, native, free)
        self.drive(6 * _FAR, -1.0)

    def arc(self, shortening: float, sign: float) -> FloatArray:
        """z of the strip on an arc whose ends are as far apart as the hinges.

        sign : +1 for closing, -1 for opening.
        """
        scales, length = self.sheet.scales, self.length
        ratio = 1.0 - shortening / length
        turn = brentq(lambda angle: np.sinc(0.5 * angle / np.pi) - ratio, 0.0, 2.0 * np.pi)
        bend = Bend(sign * turn / length, 0.0)
        poses = self.embedding.place_images(
            self.embedding.rest, bend, np.arange(scales.n_scales), scales.anchors
        )
        to_chord = Rotation.from_euler("y", sign * 0.5 * turn).as_matrix()
        z = self.embedding.rest.copy()
        own = z[: 6 * scales.n_scales].reshape(-1, 6)
        own[:, :3] = poses[:, 0] @ to_chord.T
        own[:, :2] -= scales.anchors
        # The line through both hinges runs through the middle of the width.
        turns = Rotation.from_matrix(to_chord @ poses[:, 1:]).as_quat()
        own[:, 3:] = turns[:, :3] / turns[:, 3:]
        own[:2, :3] = 0.0
        own[:2, [3, 5]] = 0.0
        return self.moved(z, shortening)

    def clear_arc(self, shortening: float, sign: float) -> FloatArray:
        """The arc at a shortening, or at the first of its quarters at which no scales meet."""
        for _ in range(_ARCS):
            z = self.arc(shortening, sign)
            if self.contact is None:
                break
            flat = self.embedding.place(self.embedding.rest, Bend(0.0, 0.0))
            state = Driven(self).evaluate(z)
            clear = not self.contact.active_pairs(state.world.y)
            if clear and self.contact.free_share(flat.y, state.world.y) >= 1.0:
                break
            shortening *= 0.25
        return z

    def deflection(self, z: FloatArray) -> float:
        """Height [mm] of the middle of the strip over the line between the hinges."""
        scales, middle = self.sheet.scales, 0.5 * np.array([self.length, self.width])
        outlines = np.array([outline.mean(axis=0) for outline in self.sheet.laid.outlines])
        nearest = int(np.argmin(((outlines - middle) ** 2).sum(axis=1)))
        body = int(self.sheet.bodies[nearest])
        pose = self.embedding.place_images(
            z, Bend(0.0, 0.0), np.array([body]), scales.anchors[[body]]
        )[0]
        arm = [*(middle - scales.anchors[body]), 0.0]
        return float(pose[0, 2] + pose[3] @ arm)

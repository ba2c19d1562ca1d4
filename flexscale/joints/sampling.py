"""Which poses of a joint are sampled: what a bent sheet's joints meet, in thicknesses.

Scales of height h touch with their tops where the opening at the sheet's middle surface is u = (h +
t/2) phi - g. Before, u stays small; after, it follows phi. The slide s is not sampled. It moves the
section's points along the joint alone, so that

    F = [f 0; grad s 1],   det F = det f,   |F|^2 = |f|^2 + |grad s|^2 + 1:

the Neo-Hookean energy is that of the plane problem plus mu/2 |grad s|^2, and W is exactly the
plane W(u, w, phi) plus half of a constant stiffness times s^2. (n -> -n takes w to -w and s to -s,
m -> -m takes s to -s: W is even in w and in s, each alone.)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexscale.arrays import FloatArray

LARGEST_TURN = 0.35  # radian
SLIDES = 10.0  # thicknesses of slide up to which the law, exact in it, is called inside its range
_OPENINGS_AND_SHIFTS = ((0.0, 0.0), (0.0, 0.6), (0.5, 0.3), (0.5, 1.0), (1.0, 0.0), (1.0, 1.0))
_STEPS = np.linspace(0.0, 1.0, 8)[1:]


@dataclass(frozen=True)
class PoseRange:
    """Range of poses, in thicknesses and radian.

    Attributes
    ----------
    gap : between the facing walls.
    height : of the scales.
    """

    gap: float
    height: float

    @property
    def slope(self) -> float:
        """Opening of the tops by the turn, du/dphi where they touch."""
        return self.height + 0.5

    @property
    def before(self) -> float:
        """Largest opening before contact."""
        return 0.75 * self.gap

    @property
    def below(self) -> float:
        """How far u may lie under slope * phi: the gap, and 1/5 of it for what contact gives."""
        return 1.2 * self.gap

    @property
    def above(self) -> float:
        """How far u may lie above slope * phi."""
        return -0.25 * self.gap

    @property
    def bounds(self) -> FloatArray:
        """(4, 2) of (u, w, s, phi)."""
        shift = max(self.gap, 1.0) ** 0.5
        touching = self.slope * LARGEST_TURN - self.gap
        largest = max(self.before, touching + 0.4 * self.gap)
        return np.array(
            [
                [-0.375 * min(self.gap, 1.0), largest],
                [-shift, shift],
                [-SLIDES, SLIDES],
                [-LARGEST_TURN, LARGEST_TURN],
            ]
        )

    def openings(self, turn: float) -> tuple[float, float]:
        """Least and largest opening at a turn."""
        (low, high), turned = self.bounds[0], self.slope * turn
        return max(low, turned - self.below), min(high, max(self.before, turned + self.above))

    def pose(self, turn: float, opening: float, shift: float) -> FloatArray:
        """Pose (4,) at shares from 0 to 1 of the range of turns, openings there, and shifts."""
        phi = LARGEST_TURN * (2.0 * turn - 1.0)
        low, high = self.openings(phi)
        return np.array([low + opening * (high - low), shift * self.bounds[1, 1], 0.0, phi])


def fitted_ends(poses: PoseRange) -> FloatArray:
    """(n, 4) ends of ways from rest, over all of the range."""
    shares = [
        (turn, opening, shift)
        for turn in (0.0, 0.25, 0.5, 0.64, 0.82, 1.0)
        for opening, shift in _OPENINGS_AND_SHIFTS
    ]
    return np.array([poses.pose(*share) for share in shares])


def line_ends(poses: PoseRange) -> FloatArray:
    """(5, 4) ends of the lines that a figure shows: opened and closed gap, shift, opening and
    touching."""
    (low, _), shift, turn = poses.bounds[0], poses.bounds[1, 1], LARGEST_TURN
    touching = max(poses.slope * turn - poses.gap, 0.0)
    return np.array(
        [
            [poses.before, 0.0, 0.0, 0.0],
            [low, 0.0, 0.0, 0.0],
            [0.0, shift, 0.0, 0.0],
            [0.0, 0.0, 0.0, -turn],
            [touching, 0.0, 0.0, turn],
        ]
    )


def held_out_ends(poses: PoseRange, n: int = 8) -> FloatArray:
    """(n + 5, 4) ends of other ways: those of `line_ends`, and n by the additive recurrence of the
    plastic number in three dimensions."""
    steps = 1.0 / 1.22074408460575947536 ** np.arange(1, 4)
    spread = [poses.pose(*((0.5 + k * steps) % 1.0)) for k in range(1, n + 1)]
    return np.concatenate([line_ends(poses), spread])


def guarding_ends(poses: PoseRange) -> FloatArray:
    """(n, 4) ends of ways to corners of the bounds that no joint meets: a law that is fitted to
    them too, if loosely, does not mislead a solver that tries them."""
    (low, high), shift, turn = poses.bounds[0], poses.bounds[1, 1], LARGEST_TURN
    return np.array(
        [
            [0.8 * high, 0.0, 0.0, -turn],
            [high, 0.7 * shift, 0.0, -0.6 * turn],
            [high, 0.0, 0.0, 0.1 * turn],
            [low, 0.5 * shift, 0.0, 0.7 * turn],
        ]
    )


def way(end: FloatArray) -> FloatArray:
    """(n, 4) poses from near rest to an end, nearer to one another at first."""
    return np.outer(_STEPS * (0.3 + 0.7 * _STEPS), end)

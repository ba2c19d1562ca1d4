"""Grips: rows of a sheet that move as one rigid body, by few unknowns q.

Positions X of the gripped part go to o + d(q) + R(theta(q)) (X - o), its derivatives and normals
turn with R, a rotation about a fixed axis a. With A v = a x v,

    dx/dq_i = d_i + theta_i A R r,   d2x/dq_i dq_j = d_ij + theta_i theta_j A A R r

where r = X - o and theta is linear in q; derivatives of the sheet lack the terms in d.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from flexscale.arrays import FloatArray, IntArray


@dataclass(frozen=True)
class Pose:
    """Displacement d (3,) and angle; their rates (k, 3) and (k,) in q, and d's curve (k, k, 3)."""

    shift: FloatArray
    angle: float
    shift_rate: FloatArray
    angle_rate: FloatArray
    shift_curve: FloatArray


class Motion(Protocol):
    """How a grip may move."""

    @property
    def axis(self) -> FloatArray:
        """(3,) unit vector about which the grip turns."""

    @property
    def n_unknowns(self) -> int:
        """Length of q."""

    def pose(self, q: FloatArray) -> Pose:
        """Where the grip is."""


@dataclass(frozen=True)
class Turning:
    """Moves freely and turns about an axis of fixed direction: q = (d, theta [rad]).

    A moment about that axis, conjugate to theta, turns with nothing: it has a potential.
    """

    axis: FloatArray
    n_unknowns: int = 4

    def pose(self, q: FloatArray) -> Pose:
        """d and theta as they are."""
        rate = np.zeros((4, 3))
        rate[:3] = np.eye(3)
        return Pose(q[:3], float(q[3]), rate, np.eye(4)[3], np.zeros((4, 4, 3)))


@dataclass(frozen=True)
class Sliding:
    """Slides along an arc: q = (s,), the length of arc [mm].

    A strip that turns with the arc is drawn in by the moment it transmits, as lattice images of a
    periodic cell are; one that keeps its turn feels the force along the arc alone.

    Attributes
    ----------
    tangent, normal : (3,) unit vectors of the arc at s = 0; it curves toward the normal.
    curvature : mm-1.
    turns : whether it turns with the arc.
    """

    tangent: FloatArray
    normal: FloatArray
    curvature: float
    turns: bool = False
    n_unknowns: int = 1

    @property
    def axis(self) -> FloatArray:
        """About which it turns with the arc."""
        return np.cross(self.tangent, self.normal)

    def pose(self, q: FloatArray) -> Pose:
        """d = sin(kappa s)/kappa t + (1 - cos(kappa s))/kappa n; the angle is kappa s, or 0."""
        k, s = self.curvature, float(q[0])
        c, d, half = np.cos(k * s), np.sin(k * s), np.sinc(0.5 * k * s / np.pi)
        shift = s * np.sinc(k * s / np.pi) * self.tangent + 0.5 * k * s**2 * half**2 * self.normal
        rate = c * self.tangent + d * self.normal
        curve = k * (c * self.normal - d * self.tangent)
        turn = k if self.turns else 0.0
        return Pose(shift, turn * s, rate[None], np.full(1, turn), curve[None, None])


@dataclass(frozen=True)
class Grip:
    """A rigid part of a sheet.

    Attributes
    ----------
    rows : (m,) rows of y that it carries.
    is_position : (m,) whether a row is a position; else it only turns.
    reference : (m, 3) these rows at q = 0.
    origin : (3,) o.
    motion : how it moves.
    """

    rows: IntArray
    is_position: FloatArray
    reference: FloatArray
    origin: FloatArray
    motion: Motion

    def _turned(self, angle: float) -> FloatArray:
        arms = self.reference - self.is_position[:, None] * self.origin
        a, c, s = self.motion.axis, np.cos(angle), np.sin(angle)
        return c * arms + s * np.cross(a, arms) + (1.0 - c) * np.outer(arms @ a, a)

    def place(self, q: FloatArray) -> FloatArray:
        """(m, 3) rows."""
        pose = self.motion.pose(q)
        return self._turned(pose.angle) + self.is_position[:, None] * (self.origin + pose.shift)

    def jacobian(self, q: FloatArray) -> FloatArray:
        """(m, k, 3) derivatives of the rows in q."""
        pose = self.motion.pose(q)
        turn = np.cross(self.motion.axis, self._turned(pose.angle))
        moved = self.is_position[:, None, None] * pose.shift_rate
        return moved + pose.angle_rate[:, None] * turn[:, None]

    def second_order(self, q: FloatArray, forces: FloatArray) -> FloatArray:
        """(k, k) forces (m, 3) on the rows times their second derivatives."""
        pose = self.motion.pose(q)
        turn = np.cross(self.motion.axis, self._turned(pose.angle))
        curve = np.cross(self.motion.axis, turn)
        squares = np.outer(pose.angle_rate, pose.angle_rate)
        shifted = pose.shift_curve @ (self.is_position @ forces)
        return shifted + squares * np.sum(forces * curve)

"""Surfaces that sheets rest on, are held on or start from: maps (u, v) -> x with gradients."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from flexscale.arrays import FloatArray

#: Parameters (n, 2) -> positions (n, 3) and gradients (n, 3, 2), columns x_u and x_v.
Surface = Callable[[FloatArray], tuple[FloatArray, FloatArray]]


def plane(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The sheet as it is drawn."""
    positions = np.column_stack([points, np.zeros(len(points))])
    return positions, np.broadcast_to(np.eye(3)[:, :2], (len(points), 3, 2)).copy()


def polar_plane(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The plane in polar coordinates (r [mm], angle [rad])."""
    r, angle = points.T
    c, s, zero = np.cos(angle), np.sin(angle), np.zeros(len(points))
    gradients = np.stack([np.stack([c, s, zero], 1), np.stack([-r * s, r * c, zero], 1)], axis=2)
    return np.stack([r * c, r * s, zero], axis=1), gradients


def sphere(radius: float) -> Surface:
    """A sphere in (longitude, latitude) [rad], radius in mm; its normal points outward."""

    def place(points: FloatArray) -> tuple[FloatArray, FloatArray]:
        longitude, latitude = points.T
        c, s, p, q = np.cos(longitude), np.sin(longitude), np.cos(latitude), np.sin(latitude)
        positions = radius * np.stack([c * p, s * p, q], axis=1)
        east = radius * np.stack([-s * p, c * p, np.zeros_like(c)], axis=1)
        north = radius * np.stack([-c * q, -s * q, p], axis=1)
        return positions, np.stack([east, north], axis=2)

    return place


def cylinder(curvature: float) -> Surface:
    """The sheet rolled along u to a curvature [mm-1], held at the origin; positive closes.

    x = (sin(kappa u)/kappa, v, (1 - cos(kappa u))/kappa) [Eq. 2], the identity at kappa = 0.
    """

    def place(points: FloatArray) -> tuple[FloatArray, FloatArray]:
        u, v = points.T
        angle, zero = curvature * u, np.zeros(len(points))
        # np.sinc(x) = sin(pi x)/(pi x): both quotients are regular at kappa = 0.
        along = u * np.sinc(angle / np.pi)
        up = 0.5 * curvature * u**2 * np.sinc(0.5 * angle / np.pi) ** 2
        tangent = np.stack([np.cos(angle), zero, np.sin(angle)], axis=1)
        across = np.broadcast_to([0.0, 1.0, 0.0], tangent.shape)
        return np.stack([along, v, up], axis=1), np.stack([tangent, across], axis=2)

    return place


def hinged_arc(length: float, chord: float, sign: float) -> Surface:
    """A strip along u in [0, length] as a circular arc from (0, v, 0) to (chord, v, 0), chord below
    the length, mm; sign +1 closes, -1 opens."""
    half = brentq(lambda angle: np.sinc(angle / np.pi) - chord / length, 1e-9, np.pi)
    bent = cylinder(sign * 2.0 * float(half) / length)
    end = bent(np.array([[0.5 * length, 0.0]]))[0][0]
    shift = np.array([0.5 * chord, 0.0, -end[2]])

    def place(points: FloatArray) -> tuple[FloatArray, FloatArray]:
        positions, gradients = bent(points - [0.5 * length, 0.0])
        return positions + shift, gradients

    return place

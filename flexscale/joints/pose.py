"""How the pose q = (u, w, s, phi) of a joint places its two scales.

Places have the components (n, m, z). With X0 = (0, 0, -1/2) in the sheet's middle surface, in
thicknesses, and R(a) the turn by a about m that tips tops towards +n,

    scale A:  X0 + R(+phi/2) (X - X0) - (u, s, w)/2
    scale B:  X0 + R(-phi/2) (X - X0) + (u, s, w)/2

so that the tops approach one another for phi > 0: the joint closes.
"""

from __future__ import annotations

import numpy as np

from flexscale.arrays import FloatArray

MIDDLE = -0.5  # z of the sheet's middle surface, in thicknesses
SHIFT_COMPONENTS = (0, 2, 1)  # of (n, m, z), that u, w and s move


def place(rest: FloatArray, side: float, pose: FloatArray) -> FloatArray:
    """Places (n, 3) of points of one scale at rest (n, 2); side -1 for A, +1 for B."""
    return _turned(rest, -0.5 * side * pose[3]) + 0.5 * side * pose[[0, 2, 1]]


def place_rates(rest: FloatArray, side: float, pose: FloatArray) -> FloatArray:
    """Derivatives (n, 3, 4) of the places by the pose."""
    rates = np.zeros((len(rest), 3, 4))
    for k, component in enumerate(SHIFT_COMPONENTS):
        rates[:, component, k] = 0.5 * side
    rates[:, :, 3] = -0.5 * side * _turned(rest, -0.5 * side * pose[3] + 0.5 * np.pi, 0.0)
    return rates


def place_bends(rest: FloatArray, side: float, pose: FloatArray) -> FloatArray:
    """Second derivatives (n, 3) of the places by phi; those by u, w and s vanish."""
    return -0.25 * _turned(rest, -0.5 * side * pose[3], 0.0)


def _turned(rest: FloatArray, angle: float, middle: float = MIDDLE) -> FloatArray:
    """X0 + R(angle) (X - X0), with `middle` in the place of the first X0."""
    across, up = rest[:, 0], rest[:, 1] - MIDDLE
    out = np.zeros((len(rest), 3))
    out[:, 0] = np.cos(angle) * across + np.sin(angle) * up
    out[:, 2] = np.cos(angle) * up - np.sin(angle) * across + middle
    return out

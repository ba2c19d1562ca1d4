"""The barrier of Incremental Potential Contact (Li et al. 2020), as a force over a distance."""

from __future__ import annotations

import numpy as np

from flexscale.arrays import FloatArray

SWEEPS = 4  # of collision detection along one way
# Steps of one pair of primitives in a sweep. Each step is as long as the pair is apart, so that
# walls 1e-6 mm apart that slide 0.5 mm along one another would take 600,000; a sweep that ends
# early tells a shorter way that is free.
MOST_SWEEP_STEPS = 10_000


def barrier_stiffness(force: float, activation_distance: float) -> float:
    """Stiffness at which one pair at half the activation distance pushes with `force` [N].

    With b(d) = -(d^2 - d_hat^2)^2 ln(d^2/d_hat^2), db/dd at d_hat/2 is -4.33 d_hat^3.
    """
    s = 0.25
    slope = -2.0 * (s - 1.0) * np.log(s) - (s - 1.0) ** 2 / s
    return force / (-slope * activation_distance**3)


def soft_barrier(
    distance: FloatArray, activation_distance: float, soft: float, stiffness: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Energy [N mm], its slope [N] and curvature [N/mm] of gaps below d_hat, which may be negative.

    Below the distance `soft`, mm, it is the parabola that touches the barrier there.
    """
    d_hat = activation_distance
    held = np.maximum(distance, soft)
    s = (held / d_hat) ** 2
    ln = np.log(s)
    energy = -((s - 1.0) ** 2) * ln
    by_s = -2.0 * (s - 1.0) * ln - (s - 1.0) ** 2 / s
    twice = -2.0 * ln - 4.0 * (s - 1.0) / s + ((s - 1.0) / s) ** 2
    scale = stiffness * d_hat**4
    slope = scale * by_s * 2.0 * held / d_hat**2
    bend = scale * (2.0 * by_s / d_hat**2 + twice * (2.0 * held / d_hat**2) ** 2)
    beyond = distance - held
    total = scale * energy + slope * beyond + 0.5 * bend * beyond**2
    return total, slope + bend * beyond, bend


class Barrier:
    """A barrier that starts at a distance d_hat.

    Attributes
    ----------
    activation_distance : d_hat, mm.
    stiffness : N mm-3 (times mm^4 of the squared-distance barrier); it may be changed between
        solves.
    """

    def __init__(self, activation_distance: float, stiffness: float) -> None:
        self.activation_distance = activation_distance
        self.stiffness = stiffness

    def push(self, distance: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Force [N] of pairs at distances 0 < d <= d_hat, and how it grows as they close [N/mm]."""
        d_hat = self.activation_distance
        s = (distance / d_hat) ** 2
        slope = 2.0 * (s - 1.0) * np.log(s) + (s - 1.0) ** 2 / s
        growth = 2.0 * np.log(s) + 4.0 * (s - 1.0) / s - ((s - 1.0) / s) ** 2
        scale = 2.0 * self.stiffness * d_hat**2
        return scale * distance * slope, -scale * (slope + 2.0 * s * growth)

    def distance_at(self, force: FloatArray) -> FloatArray:
        """Distances [mm] at which pairs push with forces >= 0 [N]; to a thousandth of d_hat."""
        distances = self.activation_distance * np.linspace(1.0, 1e-3, 1000)
        found: FloatArray = np.interp(force, self.push(distances)[0], distances)
        return found

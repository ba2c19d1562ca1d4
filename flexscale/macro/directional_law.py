"""The two-regime law of one principal direction, with its derivatives [Eqs. 10, 11].

A parameter of the law is P(u) = Re Σ (c_k − i s_k) u^k with u = e^{2iθ}, which is Eq. 11; a table
holds c_0 … c_3, then s_0 … s_3. P is harmonic in u, also inside the unit circle, where `principal`
lets u end up: least values lie on the circle, so that what is positive at every angle is positive
there as well.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from flexscale.arrays import FloatArray

#: What the harmonics of the onset are of: as ONSET_QUANTITIES, but with numbers.
ONSET, INVERSE_ONSET, NO_ONSET = 0.0, 1.0, 2.0


@njit(cache=True)
def harmonic_jet(table: FloatArray, at: int, p: float, q: float, jet: FloatArray) -> None:
    """Fill jet (6,) with P and its derivatives by p, q, pp, pq, qq at u = p + i q."""
    u = complex(p, q)
    value = first = second = complex(0.0, 0.0)
    for k in range(3, -1, -1):
        second = second * u + 2.0 * first
        first = first * u + value
        value = value * u + complex(table[at + k], -table[at + 4 + k])
    jet[0], jet[1], jet[2] = value.real, first.real, -first.imag
    jet[3], jet[4], jet[5] = second.real, -second.imag, -second.real


@njit(cache=True)
def onset_jet(table: FloatArray, at: int, p: float, q: float, jet: FloatArray) -> bool:
    """Fill jet (6,) with κ0 [mm-1] and its derivatives; False where there is no contact.

    `at` : where `table` says what the harmonics are of; these follow.
    """
    kind = table[at]
    if kind == NO_ONSET:
        return False
    harmonic_jet(table, at + 1, p, q, jet)
    if kind == INVERSE_ONSET:
        if jet[0] <= 1e-9:  # contact beyond 1e9 mm-1 is none
            return False
        onset = 1.0 / jet[0]
        for k in range(3, 6):
            i, j = (1, 1) if k == 3 else ((1, 2) if k == 4 else (2, 2))
            jet[k] = onset**2 * (2.0 * onset * jet[i] * jet[j] - jet[k])
        jet[0], jet[1], jet[2] = onset, -(onset**2) * jet[1], -(onset**2) * jet[2]
    return True


@njit(cache=True)
def directional_energy(
    table: FloatArray, own: float, places: tuple[int, int, int], y: FloatArray, jet: FloatArray
) -> float:
    """own/2 a κ² + (b − a)/2 (|κ| − κ0)₊² [N mm-1] with its derivatives by y = (κ, Re u, Im u).

    At |κ| = κ0 the second derivative jumps; there it is the one before contact.

    Parameters
    ----------
    table : coefficients.
    own : 1, or 0 where the energy before contact is counted elsewhere.
    places : in the table, of a, and of b and onset of the side to which κ bends.
    y : (3,) curvature in mm-1; direction.
    jet : (4, 3) filled: gradient, then Hessian.
    """
    kappa, value = y[0], 0.0
    jet[:] = 0.0
    onset, a, c = np.empty(6), np.empty(6), np.empty(6)
    touches = onset_jet(table, places[2], y[1], y[2], onset) and abs(kappa) > onset[0]
    if own == 0.0 and not touches:
        return value
    harmonic_jet(table, places[0], y[1], y[2], a)
    if own != 0.0:
        value = 0.5 * own * a[0] * kappa**2
        jet[0, 0] = own * a[0] * kappa
        jet[1, 0] = own * a[0]
        for i in range(1, 3):
            jet[0, i] = 0.5 * own * a[i] * kappa**2
            jet[1, i] = jet[1 + i, 0] = own * a[i] * kappa
            for j in range(1, 3):
                jet[1 + i, j] = 0.5 * own * a[1 + i + j] * kappa**2
    if not touches:
        return value
    beyond = abs(kappa) - onset[0]
    harmonic_jet(table, places[1], y[1], y[2], c)
    c -= a
    rate = (1.0 if kappa > 0.0 else -1.0, -onset[1], -onset[2])
    c_rate = (0.0, c[1], c[2])
    for i in range(3):
        jet[0, i] += c[0] * beyond * rate[i] + 0.5 * c_rate[i] * beyond**2
        for j in range(3):
            added = c[0] * rate[i] * rate[j] + beyond * (c_rate[i] * rate[j] + c_rate[j] * rate[i])
            if i > 0 and j > 0:
                k = 1 + i + j
                added += 0.5 * c[k] * beyond**2 - c[0] * beyond * onset[k]
            jet[1 + i, j] += added
    return value + 0.5 * c[0] * beyond**2

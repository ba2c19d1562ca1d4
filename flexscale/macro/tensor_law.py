"""Energy per rest area of the macro sheet at a point, with derivatives: what a shell needs.

The state of a point is e = a − I and b [mm-1], first and second fundamental form in rest
coordinates as (11, 12, 22); b > 0 closes. With strain E = (e11/2, e22/2, e12), curvature k = (b11,
b22, 2 b12), principal curvatures κ_j and directions u_j of `principal`

    W = ½ E·A E + g(½ k·C k) + Σ_j [own/2 a κ_j² + (b − a)/2 (|κ_j| − κ0)₊²] + ½ w det(b)²,

g(x) = log(1 + s x)/s with the softening s of `flat_response`; a, b and κ0 at u_j and on the side to
which κ_j bends [Eqs. 12, 13; St. Venant-Kirchhoff in plane].
Two energies by name, told apart by numbers alone:

- "paper" (Eq. 12): C = 0, own = 1, η = 0. Where κ1 = κ2 ≠ 0 it depends on the direction from which
  that is approached: derivatives grow as 1/ρ. It couples the principal curvatures by w alone.
- "tangent": C of the flat cell, own = 0; contact adds its excess to it. δ = 0: that is active away
  from the flat state only.

Strain and curvature do not couple before they are large: in the flat cells of named patterns the
coupling makes up 2.3 % of C at most, and C is that at zero in-plane force.

A table of `law_table` holds all numbers. The energy is twice differentiable but for |κ_j| = κ0,
where the Hessian jumps; there it is the one before contact.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from flexscale.arrays import FloatArray
from flexscale.macro.directional_law import directional_energy
from flexscale.macro.principal import TO_INVARIANTS, principal_jet, principal_state, smooth_radius

#: Where a table holds A and C (11, 12, 13, 22, 23, 33), w, own share, η², δ², s, least κ0 at any
#: angle, harmonics of a, and of each side those of b, what the onset's harmonics are of, and these.
IN_PLANE, TANGENT, BIAXIAL, OWN, ETA2, DELTA2, SOFTENING, LEAST_ONSET = 0, 6, 12, 13, 14, 15, 16, 17
A, CLOSING, OPENING, N_TABLE = 18, 26, 43, 60
_B, _ONSET = 0, 8


@njit(cache=True)
def energy(e: FloatArray, b: FloatArray, parameters: FloatArray) -> float:
    """Energy per rest area [N mm-1]; e, b (3,), parameters a table (60,)."""
    strain, curvature = (0.5 * e[0], 0.5 * e[2], e[1]), (b[0], b[2], 2.0 * b[1])
    det = b[0] * b[2] - b[1] * b[1]
    value = quadratic(parameters, IN_PLANE, strain)
    bent, softening = quadratic(parameters, TANGENT, curvature), parameters[SOFTENING]
    value += np.log1p(softening * bent) / softening if softening > 0.0 else bent
    value += 0.5 * parameters[BIAXIAL] * det * det
    if not _has_directions(b, parameters):
        return value
    radius_jet, y, jet = np.empty((4, 3)), np.empty(3), np.empty((4, 3))
    radius = smooth_radius(b, parameters[ETA2], parameters[DELTA2], radius_jet)
    if radius > 0.0:
        for sign in (1.0, -1.0):
            principal_state(b, sign, radius, y)
            value += directional_energy(parameters, parameters[OWN], _places(y[0]), y, jet)
    return value


@njit(cache=True)
def law(
    e: FloatArray, b: FloatArray, parameters: FloatArray, grad: FloatArray, hess: FloatArray
) -> None:
    """Fill gradient (6,) and Hessian (6, 6) in (a11, a12, a22, b11, b12, b22).

    The derivative by a12 or b12 is that with both off-diagonals moving together. `hess` of shape
    (0, 0) is skipped.
    """
    grad[:] = 0.0
    hess[:] = 0.0
    strain, curvature = (0.5 * e[0], 0.5 * e[2], e[1]), (b[0], b[2], 2.0 * b[1])
    add_quadratic(parameters, IN_PLANE, strain, (0.5, 0.5, 1.0), 0, grad, hess)
    add_quadratic(parameters, TANGENT, curvature, (1.0, 1.0, 2.0), 3, grad, hess)
    _soften(parameters[SOFTENING], quadratic(parameters, TANGENT, curvature), grad, hess)
    _add_biaxial(parameters[BIAXIAL], b, grad, hess)
    if not _has_directions(b, parameters):
        return
    radius_jet, y, y_jet, jet = np.empty((4, 3)), np.empty(3), np.empty((3, 4, 3)), np.empty((4, 3))
    radius = smooth_radius(b, parameters[ETA2], parameters[DELTA2], radius_jet)
    if radius > 0.0:
        for sign in (1.0, -1.0):
            principal_state(b, sign, radius, y)
            directional_energy(parameters, parameters[OWN], _places(y[0]), y, jet)
            if np.any(jet != 0.0):
                principal_jet(b, sign, radius, radius_jet, y_jet)
                _add_direction(jet, y_jet, grad, hess)


@njit(cache=True)
def _has_directions(b: FloatArray, parameters: FloatArray) -> bool:
    """Whether the sum over principal directions counts: not where no curvature reaches any κ0.

    R² of `principal` is r² + η² N at most; δ is 0 where the sum is of contact alone.
    """
    if parameters[OWN] != 0.0:
        return True
    s, d = 0.5 * (b[0] + b[2]), 0.5 * (b[0] - b[2])
    r2 = d * d + b[1] * b[1]
    return abs(s) + np.sqrt(r2 + parameters[ETA2] * (s * s + r2)) > parameters[LEAST_ONSET]


@njit(cache=True)
def _places(kappa: float) -> tuple[int, int, int]:
    side = CLOSING if kappa >= 0.0 else OPENING
    return A, side + _B, side + _ONSET


@njit(cache=True)
def entry_index(i: int, j: int) -> int:
    """Place of entry (i, j) of a symmetric matrix among its six."""
    low, high = min(i, j), max(i, j)
    return low * (5 - low) // 2 + high


@njit(cache=True)
def entry_of(table: FloatArray, at: int, i: int, j: int) -> float:
    """Entry (i, j) of a symmetric (3, 3) matrix that a table holds from `at` on."""
    return table[at + entry_index(i, j)]


@njit(cache=True)
def quadratic(table: FloatArray, at: int, x: tuple[float, float, float]) -> float:
    """½ x·M x."""
    value = 0.0
    for i in range(3):
        for j in range(3):
            value += 0.5 * table[at + entry_index(i, j)] * x[i] * x[j]
    return value


@njit(cache=True)
def add_quadratic(
    table: FloatArray,
    at: int,
    x: tuple[float, float, float],
    scale: tuple[float, float, float],
    first: int,
    grad: FloatArray,
    hess: FloatArray,
) -> None:
    """Derivatives by the form (11, 12, 22) that makes x = (11, 22, 12) times `scale`."""
    order = (0, 2, 1)
    for i in range(3):
        for j in range(3):
            stiffness = table[at + entry_index(i, j)] * scale[i]
            grad[first + order[i]] += stiffness * x[j]
            if hess.shape[0] > 0:
                hess[first + order[i], first + order[j]] += stiffness * scale[j]


@njit(cache=True)
def _soften(softening: float, bent: float, grad: FloatArray, hess: FloatArray) -> None:
    """From the derivatives of ½ k·C k by b, alone there so far, to those of g of it."""
    rate = 1.0 / (1.0 + softening * bent)
    if hess.shape[0] > 0:
        for i in range(3, 6):
            for j in range(3, 6):
                hess[i, j] = rate * (hess[i, j] - softening * rate * grad[i] * grad[j])
    for i in range(3, 6):
        grad[i] *= rate


@njit(cache=True)
def _add_biaxial(weight: float, b: FloatArray, grad: FloatArray, hess: FloatArray) -> None:
    det = b[0] * b[2] - b[1] * b[1]
    rate = (b[2], -2.0 * b[1], b[0])
    for i in range(3):
        grad[3 + i] += weight * det * rate[i]
        if hess.shape[0] > 0:
            for j in range(3):
                hess[3 + i, 3 + j] += weight * rate[i] * rate[j]
            hess[3 + i, 5 - i] += weight * det * (-2.0 if i == 1 else 1.0)


@njit(cache=True)
def _add_direction(jet: FloatArray, y_jet: FloatArray, grad: FloatArray, hess: FloatArray) -> None:
    """Chain rule from y of one principal direction through (s, d, o) to b."""
    t = TO_INVARIANTS
    first, second = np.zeros(3), np.zeros((3, 3))
    for y in range(3):
        for i in range(3):
            first[i] += jet[0, y] * y_jet[y, 0, i]
            for j in range(3):
                second[i, j] += jet[0, y] * y_jet[y, 1 + i, j]
                for z in range(3):
                    second[i, j] += jet[1 + y, z] * y_jet[y, 0, i] * y_jet[z, 0, j]
    for i in range(3):
        for m in range(3):
            grad[3 + i] += t[m, i] * first[m]
            if hess.shape[0] > 0:
                for j in range(3):
                    for n in range(3):
                        hess[3 + i, 3 + j] += t[m, i] * second[m, n] * t[n, j]

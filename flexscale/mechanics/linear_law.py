"""Linear sheet law: St. Venant-Kirchhoff membrane and quadratic bending, orthotropic or isotropic.

    psi = 1/2 E^T A E + 1/2 K^T D K,   E = (e11, e22, 2 e12)/2,   K = (b11, b22, 2 b12),

E the Green strain with the shear angle last, so its last entry is the variable e12 = a12 itself;
A [N/mm] and D [N mm] symmetric (3, 3).
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import ArrayLike

from flexscale.arrays import FloatArray
from flexscale.errors import UnitRangeError
from flexscale.mechanics.sheet_law import SheetLaw
from flexscale.units import require_positive, require_range


@njit(cache=True)
def linear_energy(e, b, parameters):
    """Energy per rest area [N/mm]; parameters: A, then D, row by row (18,)."""
    strain = (0.5 * e[0], 0.5 * e[2], e[1])
    bend = (b[0], b[2], 2.0 * b[1])
    total = 0.0
    for i in range(3):
        for j in range(3):
            total += strain[i] * parameters[3 * i + j] * strain[j]
            total += bend[i] * parameters[9 + 3 * i + j] * bend[j]
    return 0.5 * total


@njit(cache=True)
def linear_law(e, b, parameters, grad, hess):
    """Derivatives of `linear_energy`, see `sheet_law`."""
    strain = (0.5 * e[0], 0.5 * e[2], e[1])
    bend = (b[0], b[2], 2.0 * b[1])
    place = (0, 2, 1)  # of the entries of E and K among (11, 12, 22)
    strain_rate, bend_rate = (0.5, 0.5, 1.0), (1.0, 1.0, 2.0)
    for i in range(3):
        force, couple = 0.0, 0.0
        for j in range(3):
            force += parameters[3 * i + j] * strain[j]
            couple += parameters[9 + 3 * i + j] * bend[j]
        grad[place[i]] = strain_rate[i] * force
        grad[3 + place[i]] = bend_rate[i] * couple
    if hess.shape[0] == 0:
        return
    hess[:] = 0.0
    for i in range(3):
        for j in range(3):
            p, q = place[i], place[j]
            hess[p, q] = strain_rate[i] * strain_rate[j] * parameters[3 * i + j]
            hess[3 + p, 3 + q] = bend_rate[i] * bend_rate[j] * parameters[9 + 3 * i + j]


def linear_sheet(membrane: ArrayLike, bending: ArrayLike) -> SheetLaw:
    """A linear law from its matrices.

    Parameters
    ----------
    membrane : (3, 3) A, N/mm, in Voigt order (11, 22, 12).
    bending : (3, 3) D, N mm.

    Raises
    ------
    UnitRangeError : a matrix is not symmetric and positive definite.
    """
    matrices = [_checked(membrane, "membrane", "N/mm"), _checked(bending, "bending", "N mm")]
    parameters = np.concatenate([m.ravel() for m in matrices])
    return SheetLaw(linear_energy, linear_law, parameters, float(matrices[0].max()))


def orthotropic_matrix(c11: float, c22: float, c12: float, c66: float) -> FloatArray:
    """(3, 3) stiffness with the axes as axes of symmetry, Voigt order (11, 22, 12)."""
    return np.array([[c11, c12, 0.0], [c12, c22, 0.0], [0.0, 0.0, c66]])


def isotropic_sheet(young_modulus: float, poisson_ratio: float, thickness: float) -> SheetLaw:
    """A linear plate of a homogeneous material: A = t Q, D = t^3/12 Q; MPa, 1, mm."""
    e = require_positive(young_modulus, "Young's modulus", "MPa")
    nu = require_range(poisson_ratio, "Poisson's ratio", "1", -0.99, 0.5)
    t = require_positive(thickness, "thickness", "mm")
    stretch = e / (1.0 - nu**2)
    plane = orthotropic_matrix(stretch, stretch, nu * stretch, 0.5 * e / (1.0 + nu))
    return linear_sheet(t * plane, t**3 / 12.0 * plane)


def _checked(matrix: ArrayLike, name: str, unit: str) -> FloatArray:
    values = np.array(matrix, dtype=float)
    proper = values.shape == (3, 3) and np.isfinite(values).all() and np.allclose(values, values.T)
    if not proper or np.linalg.eigvalsh(values)[0] <= 0.0:
        raise UnitRangeError(
            f"The {name} stiffness must be a symmetric positive definite 3 x 3 matrix in {unit}, "
            f"order (11, 22, 12), not {np.array2string(values, precision=4)}: check its constants."
        )
    return values

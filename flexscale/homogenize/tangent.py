"""Stiffness of the flat cell, in bending and in its plane: six linear solves at kappa = 0.

Both are second derivatives of the cell's energy density at rest with everything else free. The
flat cell has no forces, so that its Hessian in z is H = J^T K J, with K = d2E/dy2 and the in-plane
strain S of the lattice among the unknowns z.

Bending: with R the rates of the world vectors for unit curvatures, f = J^T K R,
C = (R^T K R - f^T H^-1 f) / A; S is free, so that the sheet bends without in-plane force.

In plane, at curvature 0: with S given and all other unknowns free, the energy is quadratic in S
with the Schur complement of H. Its inverse is the S block of H^-1, a compliance, which unit loads
on S give. To first order in S the Green strain of F = I + S is S, so this is the stiffness of a
St. Venant-Kirchhoff law as well.

H^-1 is meant under the mean-offset constraint throughout.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from flexscale import checks
from flexscale.arrays import FloatArray
from flexscale.checks import checked
from flexscale.homogenize.build import build_problem
from flexscale.homogenize.native_model import NativeModel, native_model
from flexscale.homogenize.problem import Problem
from flexscale.patterns import Pattern
from flexscale.short_repr import ShortRepr
from flexscale.units import require_array

_SAMPLES = 1800
#: Stiffnesses that differ by a smaller share are said to be the same: meshes tell no finer.
SAME = 1e-3


@dataclass(frozen=True, repr=False)
class TangentStiffness(ShortRepr):
    """Stiffness of a pattern at rest.

    Attributes
    ----------
    matrix : (3, 3) N mm, C in energy density 1/2 k^T C k for k = (kappa_xx, kappa_yy, 2 kappa_xy)
        in mm-1, free of in-plane forces.
    in_plane : (3, 3) N mm-1, energy density 1/2 E^T A E for Green strain E = (E_xx, E_yy, 2 E_xy),
        held flat.
    coupling : (3, 3) N, B in energy density E^T B k, of strain and curvature together; None where
        only the others are known. Strain is that of the surface to which curvatures refer.
    """

    matrix: FloatArray
    in_plane: FloatArray
    coupling: FloatArray | None = None

    @property
    def held(self) -> FloatArray | None:
        """(3, 3) N mm, bending stiffness at E = 0: D = C + B^T A^-1 B."""
        if self.coupling is None:
            return None
        found: FloatArray = self.matrix + self.coupling.T @ np.linalg.solve(
            self.in_plane, self.coupling
        )
        return found

    def stiffness(self, direction: ArrayLike) -> float | FloatArray:
        """a = C : (n n n n) for bending in `direction` [degrees], N mm; of the same shape."""
        angle = np.radians(require_array(direction, "direction", "degree"))
        c, s = np.cos(angle), np.sin(angle)
        k = np.stack([c * c, s * s, 2.0 * c * s], axis=-1)
        a = np.einsum("...i,ij,...j->...", k, self.matrix, k)
        return float(a) if a.ndim == 0 else a

    @property
    def softest(self) -> float:
        """Direction of least stiffness, degrees in [0, 180); any one where all are the same."""
        return self._extreme(1.0)

    @property
    def stiffest(self) -> float:
        """Direction of greatest stiffness, degrees in [0, 180); any one where all are the same."""
        return self._extreme(-1.0)

    def _extreme(self, sign: float) -> float:
        directions = np.arange(_SAMPLES) * (180.0 / _SAMPLES)
        values = sign * np.asarray(self.stiffness(directions))
        best = int(np.argmin(values))
        before, here, after = values[best - 1], values[best], values[(best + 1) % _SAMPLES]
        bend = before - 2.0 * here + after
        shift = 0.5 * (before - after) / bend if bend > 1e-9 * abs(here) else 0.0
        return float((directions[best] + shift * 180.0 / _SAMPLES) % 180.0)

    def __str__(self) -> str:
        soft, stiff = self.softest, self.stiffest
        least, most = float(self.stiffness(soft)), float(self.stiffness(stiff))
        if most - least <= SAME * most:
            return f"tangent stiffness: {0.5 * (least + most):.4g} N mm, the same in all directions"
        return (
            f"tangent stiffness: softest {least:.4g} N mm at {soft:.1f} degree, "
            f"stiffest {most:.4g} N mm at {stiff:.1f} degree"
        )


def solve_tangent(problem: Problem) -> TangentStiffness:
    """Tangent of a cell problem: bending and in-plane stiffness of its cell at rest."""
    bends = problem.flat_bends()
    relaxed = [[load @ answer for answer in bends.relaxed] for load in bends.loads]
    matrix = bends.fixed + np.array(relaxed)
    in_plane = _in_plane(problem)
    # Free of in-plane forces E = -A^-1 B k: the strain that relaxes unit curvatures.
    strain = np.diag([1.0, 1.0, 2.0]) @ np.array([answer[-3:] for answer in bends.relaxed]).T
    return TangentStiffness(0.5 * (matrix + matrix.T) / problem.area, in_plane, -in_plane @ strain)


def _in_plane(problem: Problem) -> FloatArray:
    """In-plane stiffness (3, 3), N mm-1; the system is factorized at rest."""
    compliance = np.empty((3, 3))
    for i in range(3):
        load = np.zeros(len(problem.active))
        load[-3 + i] = 1.0  # S is the end of z, and active
        compliance[:, i] = problem.system.solve(load)[0][-3:]
    # S_xy counts once: 2 E_xy = 1 is half the tensor e1 e2 + e2 e1.
    scale = np.diag([1.0, 1.0, 0.5])
    stiffness = scale @ np.linalg.inv(0.5 * (compliance + compliance.T)) @ scale
    return stiffness / problem.area


@checked(
    pattern=checks.PATTERN,
    model=native_model,
)
def tangent_stiffness(
    pattern: Pattern,
    model: NativeModel | str = "joints",
) -> TangentStiffness:
    """Bending and in-plane stiffness of a pattern at rest, in seconds.

    Parameters
    ----------
    pattern : the scale pattern.
    model : the native model, or the name of one with its default options; contact plays no part.

    Examples
    --------
    >>> import flexscale as fs
    >>> tangent = fs.tangent_stiffness(fs.Pattern(fs.Tiling("IH76")))
    >>> bool(tangent.stiffness(45.0) > tangent.stiffness(0.0))
    True
    """
    native = native_model(model)
    return solve_tangent(build_problem(pattern, native.without_contact))

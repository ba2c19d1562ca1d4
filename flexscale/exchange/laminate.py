"""The sheet at rest as a laminate: A, B and D as classical lamination theory has them.

Forces per width N [N/mm] and moments per width M [N], of strain E = (E_xx, E_yy, 2 E_xy) and
curvature κ = (κ_xx, κ_yy, κ_xy), κ_xy twice the tensor's entry:

    N = A E + B κ,     M = Bᵀ E + D κ.

The z axis points to the side of the scales, and strain at the height z is E + z κ: κ > 0 stretches
the scales' side. This package counts curvature k the other way, closing k > 0 (concave towards the
scales), so that κ = −k. A and D do not change their sign with it, B does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexscale.arrays import FloatArray

ORDER = ("xx", "yy", "xy")
#: What every file of a laminate says, in its own kind of comment.
CONVENTIONS = (
    "N = A E + B kappa, M = transpose(B) E + D kappa; forces N in N/mm, moments M in N "
    "(N mm per mm of width)",
    "order xx, yy, xy; engineering shear 2 E_xy and engineering twist kappa_xy = twice the "
    "tensor's entry",
    "x and y are the pattern's axes, z points to the side of the scales; strain at z is "
    "E + z kappa, so that kappa > 0 opens the scales and kappa < 0 closes them",
    "E is the strain of the middle surface of the soft sheet under the scales",
    "transverse shear stiffness: not computed (the sheet is a thin one, without transverse shear)",
)


@dataclass(frozen=True)
class Laminate:
    """Stiffness of the flat sheet.

    Attributes
    ----------
    a : (3, 3) N/mm, A.
    d_free : (3, 3) N mm, bending stiffness at N = 0, D − Bᵀ A⁻¹ B.
    b : (3, 3) N, B in the sign of the module's docstring; None where it is not known.
    """

    a: FloatArray
    d_free: FloatArray
    b: FloatArray | None = None

    @property
    def d(self) -> FloatArray:
        """(3, 3) N mm, D at E = 0; where B is not known that at N = 0."""
        if self.b is None:
            return self.d_free
        held: FloatArray = self.d_free + self.b.T @ np.linalg.solve(self.a, self.b)
        return 0.5 * (held + held.T)

    @property
    def d_meaning(self) -> str:
        """What D is, for people."""
        if self.b is None:
            return (
                "B is not known and left out; D is the bending stiffness at N = 0, "
                "D - transpose(B) inverse(A) B"
            )
        return "D is the bending stiffness at E = 0"

    @property
    def matrix(self) -> FloatArray:
        """(6, 6) of (E, κ); B is 0 where it is not known."""
        b = np.zeros((3, 3)) if self.b is None else self.b
        return np.block([[self.a, b], [b.T, self.d]])

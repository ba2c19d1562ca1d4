"""Sheet laws: energy per rest area as a function of strain and curvature, and how elements call it.

A law is two pure kernels, compiled with `njit(cache=True)`:

    energy(e, b, parameters) -> float                  N/mm
    law(e, b, parameters, grad, hess) -> None          fills grad (6,) and hess (6, 6)

with e = a - I and b [mm-1] as (11, 12, 22) in rest coordinates, parameters a flat array of floats,
and derivatives in s = (a11, a12, a22, b11, b12, b22), off-diagonals one variable each. A hess of
shape (0, 0) is skipped.

Elements first collect the states of all their points, then one loop calls the law on all of them,
then they go on with its derivatives. That loop takes the law as a function pointer: it alone
depends on the law's type, and it is compiled once for all laws and kept on disk. A law that is
compiled into a kernel, as an argument or in a closure, is never found on disk by the next process,
which compiles anew and leaves another file behind: 0.2 to 0.4 s a law for such a loop alone,
seconds for an element. Per point the three cost the same within noise, 0.06 to 0.1 µs.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numba import float64, int64, njit, types, void

from flexscale.arrays import FloatArray

_VECTOR = types.Array(float64, 1, "C")
_MATRIX = types.Array(float64, 2, "C")
_MATRICES = types.Array(float64, 3, "C")
_ENERGY = types.FunctionType(float64(_VECTOR, _VECTOR, _VECTOR))
_LAW = types.FunctionType(void(_VECTOR, _VECTOR, _VECTOR, _VECTOR, _MATRIX))


@dataclass(frozen=True, eq=False)
class SheetLaw:
    """A law with its parameters.

    Attributes
    ----------
    energy, law : kernels, see above.
    parameters : (n,) what the kernels take.
    stiffness : N/mm, of the order of the membrane's; energies are rounded on its scale.
    """

    energy: Any
    law: Any
    parameters: FloatArray = field(repr=False)
    stiffness: float

    def __post_init__(self) -> None:
        # Kernels are compiled for one kind of array.
        object.__setattr__(self, "parameters", np.ascontiguousarray(self.parameters, dtype=float))

    def energies(self, states: FloatArray) -> FloatArray:
        """(n,) energy per rest area [N/mm] at states (n, 6) = (e, b)."""
        out = np.empty(len(states))
        _energies(self.energy, states, self.parameters, out)
        return out

    def gradients(self, states: FloatArray) -> FloatArray:
        """(n, 6) derivatives of the energy at states (n, 6)."""
        gradients = np.empty((len(states), 6))
        _laws(self.law, states, self.parameters, gradients, np.empty((len(states), 0, 0)), 0)
        return gradients

    def derivatives(self, states: FloatArray) -> tuple[FloatArray, FloatArray]:
        """First (n, 6) and second (n, 6, 6) derivatives of the energy at states (n, 6)."""
        gradients, hessians = np.empty((len(states), 6)), np.empty((len(states), 6, 6))
        _laws(self.law, states, self.parameters, gradients, hessians, 6)
        return gradients, hessians


@njit(void(_ENERGY, _MATRIX, _VECTOR, _VECTOR), cache=True)
def _energies(energy, states, parameters, out):
    e, b = np.empty(3), np.empty(3)
    for n in range(len(states)):
        for i in range(3):
            e[i], b[i] = states[n, i], states[n, 3 + i]
        out[n] = energy(e, b, parameters)


@njit(void(_LAW, _MATRIX, _VECTOR, _MATRIX, _MATRICES, int64), cache=True)
def _laws(law, states, parameters, gradients, hessians, size):
    e, b, grad, hess = np.empty(3), np.empty(3), np.empty(6), np.empty((size, size))
    for n in range(len(states)):
        for i in range(3):
            e[i], b[i] = states[n, i], states[n, 3 + i]
        law(e, b, parameters, grad, hess)
        for i in range(6):
            gradients[n, i] = grad[i]
            for j in range(size):
                hessians[n, i, j] = hess[i, j]

"""Sparse symmetric factorization behind one small interface.

The upper triangle of the matrix comes as CSR values on a fixed pattern: the pattern is analyzed
once, then factorized as often as its values change. Two backends: PARDISO (x86-64) and scipy's
SuperLU, which works everywhere. `FLEXSCALE_LINEAR_SOLVER` = pardiso or superlu overrides the
choice. Cells of few unknowns take their matrices as full ones (`DenseFactorization`).
"""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg

from flexscale.arrays import FloatArray, IntArray
from flexscale.errors import FlexScaleError, MissingSystemPartError, UnknownNameError, suggest

ENVIRONMENT_VARIABLE = "FLEXSCALE_LINEAR_SOLVER"


class Factorization(Protocol):
    """L D L^T of a symmetric matrix."""

    name: str

    def factorize(self, values: FloatArray) -> int:
        """Factorize; returns the number of negative eigenvalues (-1: singular to rounding)."""

    def solve(self, right_hand_sides: FloatArray, refine: bool = True) -> FloatArray:
        """Solve for (n, k) right-hand sides with the last factorization; `refine` once."""


class PardisoFactorization:
    """Intel MKL's PARDISO, Bunch-Kaufman L D L^T, one thread, reproducible.

    Attributes
    ----------
    order : (n,) the order of elimination, given or found by nested dissection.
    """

    name = "pardiso"

    def __init__(self, indptr: IntArray, indices: IntArray, order: IntArray | None = None) -> None:
        # Same recipe, same bits: must be set before MKL is loaded.
        os.environ.setdefault("MKL_CBWR", "AVX2")
        try:
            import pypardiso
        except ImportError as error:
            raise MissingSystemPartError(
                f"The linear solver PARDISO is not available here ({error}); "
                f"set {ENVIRONMENT_VARIABLE}=superlu to use the fallback."
            ) from error
        n = len(indptr) - 1
        self._solver: Any = pypardiso.PyPardisoSolver(mtype=-2)
        # Found by walking the whole environment, 80 ms each time: once is enough.
        os.environ.setdefault("PYPARDISO_MKL_RT", self._solver.libmkl._name)
        self._solver.libmkl.MKL_Set_Num_Threads(1)
        settings = {1: 1, 2: 2, 8: 1, 10: 10, 11: 0, 13: 0, 21: 1, 24: 0, 25: 0, 34: 1, 35: 1}
        for number, value in settings.items():
            self._solver.set_iparm(number, value)
        self._values = np.zeros(len(indices))
        self._n = n
        self._indptr = np.ascontiguousarray(indptr, dtype=np.int32)
        self._indices = np.ascontiguousarray(indices, dtype=np.int32)
        self._nothing = np.zeros((n, 1), order="F")
        self.order = np.zeros(n, dtype=np.int32)
        if order is not None:
            self.order[:] = order
        self._solver.set_iparm(5, 2 if order is None else 1)
        self._call(11, self._nothing)

    def _call(self, phase: int, right_hand_sides: FloatArray) -> FloatArray:
        # The wrapper's own call copies the pattern each time, longer than a solution takes.
        solver, number = self._solver, ctypes.c_int32
        solution, error = np.zeros_like(right_hand_sides), number(0)
        solver._mkl_pardiso(
            _address(solver.pt, solver._pt_type[0]),
            *(ctypes.byref(number(k)) for k in (1, 1, solver.mtype, phase, self._n)),
            _address(self._values, ctypes.c_double),
            _address(self._indptr, number),
            _address(self._indices, number),
            _address(self.order, number),
            ctypes.byref(number(right_hand_sides.shape[1])),
            _address(solver.iparm, number),
            ctypes.byref(number(0)),
            _address(right_hand_sides, ctypes.c_double),
            _address(solution, ctypes.c_double),
            ctypes.byref(error),
        )
        if error.value != 0:
            raise FlexScaleError(f"PARDISO stopped with its error {error.value} in phase {phase}.")
        return solution

    def factorize(self, values: FloatArray) -> int:
        """Numerical factorization on the analyzed pattern."""
        self._values[:] = values
        self._call(22, self._nothing)
        return int(self._solver.get_iparm(23))

    def solve(self, right_hand_sides: FloatArray, refine: bool = True) -> FloatArray:
        """Back-substitution with or without one step of iterative refinement."""
        self._solver.set_iparm(8, int(refine))
        return self._call(33, np.asfortranarray(right_hand_sides, dtype=float))

    def __del__(self, is_finalizing: Callable[[], bool] = sys.is_finalizing) -> None:
        # At interpreter exit the memory goes with the process, the wrapper no longer works, and
        # the names of this module may be gone.
        if hasattr(self, "_solver") and not is_finalizing():
            self._solver.free_memory(everything=True)


class SuperLuFactorization:
    """scipy's SuperLU in symmetric mode, in its own order; the signs of its pivots give the
    inertia.
    """

    name = "superlu"

    def __init__(self, indptr: IntArray, indices: IntArray, order: IntArray | None = None) -> None:
        n = len(indptr) - 1
        upper = sp.csr_array((np.arange(1.0, len(indices) + 1.0), indices, indptr), shape=(n, n))
        full = sp.csc_array(upper + sp.triu(upper, 1).T)
        full.sort_indices()
        self._source = full.data.astype(np.int64) - 1
        self._matrix = full
        self._lu: Any = None

    def factorize(self, values: FloatArray) -> int:
        """Numerical factorization with diagonal pivots, so that L U = L D L^T."""
        self._matrix.data[:] = values[self._source]
        try:
            self._lu = scipy.sparse.linalg.splu(
                self._matrix,
                permc_spec="MMD_AT_PLUS_A",
                diag_pivot_thresh=0.0,
                options={"SymmetricMode": True},
            )
        except RuntimeError:  # exactly singular
            return -1
        if not np.array_equal(self._lu.perm_r, self._lu.perm_c):
            return -1
        return int(np.count_nonzero(self._lu.U.diagonal() < 0.0))

    def solve(self, right_hand_sides: FloatArray, refine: bool = True) -> FloatArray:
        """Back-substitution with or without one step of iterative refinement."""
        x = self._lu.solve(np.asarray(right_hand_sides))
        if not refine:
            return np.asarray(x)
        return x + self._lu.solve(right_hand_sides - self._matrix @ x)


class DenseFactorization:
    """Eigenvalues and eigenvectors of a full matrix: faster than sparse ones up to `SMALL`.

    It refuses a matrix as singular at the rounding of its largest eigenvalue.
    """

    SMALL = 60  # unknowns

    name = "dense"

    def __init__(self, indptr: IntArray, indices: IntArray) -> None:
        n = len(indptr) - 1
        self._rows, self._columns = np.repeat(np.arange(n), np.diff(indptr)), np.asarray(indices)
        self._matrix = np.zeros((n, n))

    def factorize(self, values: FloatArray) -> int:
        """Eigenvalues of the matrix."""
        self._matrix[self._columns, self._rows] = values  # the lower triangle is what eigh reads
        self._values, self._modes = np.linalg.eigh(self._matrix)
        sizes = np.abs(self._values)
        if sizes.min() <= _SINGULAR * sizes.max():
            return -1
        return int(np.count_nonzero(self._values < 0.0))

    def solve(self, right_hand_sides: FloatArray, refine: bool = True) -> FloatArray:
        """Solution from the eigenvectors; to refine it would change nothing."""
        parts = self._modes.T @ right_hand_sides
        return np.asarray(self._modes @ (parts / self._values[:, None]))


_SINGULAR = 1e-15  # of the largest eigenvalue


def _address(array: np.ndarray, kind: Any) -> Any:
    return array.ctypes.data_as(ctypes.POINTER(kind))


#: What a user may ask for.
LINEAR_SOLVERS = ("auto", "pardiso", "superlu")
_BACKENDS: dict[str, type[PardisoFactorization] | type[SuperLuFactorization]] = {
    "pardiso": PardisoFactorization,
    "superlu": SuperLuFactorization,
}


def available_linear_solver(name: str = "auto") -> str:
    """Resolve "auto": the environment variable if set, else PARDISO if it can be loaded, else
    SuperLU.

    Raises
    ------
    UnknownNameError : no backend of that name.
    """
    if name == "auto":
        name = os.environ.get(ENVIRONMENT_VARIABLE, "auto")
    if name == "auto":
        try:
            import pypardiso  # noqa: F401
        except ImportError:
            return "superlu"
        return "pardiso"
    if name not in _BACKENDS:
        raise UnknownNameError(
            f"There is no linear solver '{name}'. {suggest(name, [*_BACKENDS, 'auto'])}"
        )
    return name


def build_factorization(
    indptr: IntArray, indices: IntArray, name: str = "auto", order: IntArray | None = None
) -> Factorization:
    """Analyze a pattern (CSR of the upper triangle, diagonal included) with the named backend.

    `order` (n,) is the unknown to eliminate at each place; by default the backend seeks one of
    little fill.
    """
    return _BACKENDS[available_linear_solver(name)](indptr, indices, order)


def nested_dissection(indptr: IntArray, indices: IntArray) -> IntArray | None:
    """Order (n,) of elimination by nested dissection (METIS) of a pattern as of
    `build_factorization`; None without PARDISO, which has it."""
    if available_linear_solver() != "pardiso":
        return None
    return PardisoFactorization(indptr, indices).order.astype(np.int64)

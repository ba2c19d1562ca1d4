"""Jets: numbers that carry their first and second derivatives by a few variables, exactly.

A jet of n variables is a row of 1 + n + n n numbers: value, gradient, Hessian row by row, of which
the lower triangle is left out (`add_hessian` fills it). Sums and products follow the rules of
differentiation, so that whatever is computed of jets has its exact derivatives. Kernels here write
into a row of a table that the caller provides; with order 1 the Hessian is left alone, with order 0
the gradient too.
"""

from __future__ import annotations

from numba import njit

from flexscale.arrays import FloatArray


@njit(cache=True, error_model="numpy")
def jet_length(n: int, order: int) -> int:
    """Length of a jet of n variables that carries derivatives up to an order."""
    return 1 + (n if order > 0 else 0) + (n * n if order > 1 else 0)


@njit(cache=True, error_model="numpy")
def constant(out: FloatArray, value: float) -> None:
    """A number without derivatives."""
    out[:] = 0.0
    out[0] = value


@njit(cache=True, error_model="numpy")
def add_scaled(out: FloatArray, factor: float, a: FloatArray) -> None:
    """out += factor a."""
    for k in range(len(out)):
        out[k] += factor * a[k]


@njit(cache=True, error_model="numpy")
def add_product(
    out: FloatArray, factor: float, a: FloatArray, b: FloatArray, n: int, order: int
) -> None:
    """out += factor a b."""
    fa, fb = factor * a[0], factor * b[0]
    out[0] += fa * b[0]
    if order == 0:
        return
    for i in range(1, n + 1):
        out[i] += fa * b[i] + fb * a[i]
    if order == 1:
        return
    for i in range(n):
        ga, gb = factor * a[1 + i], factor * b[1 + i]
        row = 1 + n + i * n
        if ga == 0.0 and gb == 0.0:
            for j in range(i, n):
                out[row + j] += fa * b[row + j] + fb * a[row + j]
        else:
            for j in range(i, n):
                out[row + j] += fa * b[row + j] + fb * a[row + j] + ga * b[1 + j] + gb * a[1 + j]


@njit(cache=True, error_model="numpy")
def compose(
    out: FloatArray, a: FloatArray, value: float, slope: float, bend: float, n: int, order: int
) -> None:
    """out = f(a), with value, slope and second derivative of f at a; `out` may be `a`."""
    if order > 1:
        for i in range(n):
            gi = bend * a[1 + i]
            row = 1 + n + i * n
            for j in range(i, n):
                out[row + j] = slope * a[row + j] + gi * a[1 + j]
    if order > 0:
        for i in range(1, n + 1):
            out[i] = slope * a[i]
    out[0] = value


@njit(cache=True, error_model="numpy")
def add_hessian(out: FloatArray, factor: float, a: FloatArray, n: int) -> None:
    """out (n, n) += factor times the Hessian of a jet, both triangles."""
    for i in range(n):
        for j in range(i, n):
            value = factor * a[1 + n + i * n + j]
            out[i, j] += value
            if i != j:
                out[j, i] += value


@njit(cache=True, error_model="numpy")
def cross(a: FloatArray, b: FloatArray, out: FloatArray, n: int, order: int) -> None:
    """out (3, jet) = a x b."""
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        constant(out[i], 0.0)
        add_product(out[i], 1.0, a[j], b[k], n, order)
        add_product(out[i], -1.0, a[k], b[j], n, order)

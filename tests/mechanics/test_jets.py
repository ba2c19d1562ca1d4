"""Jets against differences: sums, products, functions of functions."""

from __future__ import annotations

import numpy as np

from flexscale.mechanics.jets import (
    add_hessian,
    add_product,
    add_scaled,
    compose,
    constant,
    jet_length,
)
from tests.derivatives import directional_difference, relative_error

N = 3


def hessian_of(jet: np.ndarray, n: int) -> np.ndarray:
    """(n, n) of a jet."""
    out = np.zeros((n, n))
    add_hessian(out, 1.0, jet, n)
    return out


def jet_of(x: np.ndarray) -> np.ndarray:
    """exp(x y - 2 z) + 3 x z as a jet."""
    rows = np.empty((5, jet_length(N, 2)))
    for k in range(N):
        constant(rows[k], x[k])
        rows[k, 1 + k] = 1.0
    constant(rows[3], 0.0)
    add_product(rows[3], 1.0, rows[0], rows[1], N, 2)
    add_scaled(rows[3], -2.0, rows[2])
    value = float(np.exp(rows[3, 0]))
    compose(rows[4], rows[3], value, value, value, N, 2)
    add_product(rows[4], 3.0, rows[0], rows[2], N, 2)
    return rows[4]


def test_values_and_derivatives_are_those_of_the_function() -> None:
    generator = np.random.default_rng(3)
    x, way = generator.normal(size=N), generator.normal(size=N)
    jet = jet_of(x)
    assert jet[0] == np.exp(x[0] * x[1] - 2.0 * x[2]) + 3.0 * x[0] * x[2]
    slope = directional_difference(lambda s: jet_of(x + s * way)[0], 1e-3)
    assert relative_error(jet[1 : 1 + N] @ way, slope) < 1e-9
    bend = directional_difference(lambda s: jet_of(x + s * way)[1 : 1 + N], 1e-3)
    assert relative_error(hessian_of(jet, N) @ way, bend) < 1e-9

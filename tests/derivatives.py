"""Fourth-order central differences, for tests of gradients and Hessians."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp


def directional_difference(function: Callable[[float], np.ndarray | float], step: float):
    """Derivative at 0 of a function of one number."""
    near = np.asarray(function(step)) - np.asarray(function(-step))
    far = np.asarray(function(2.0 * step)) - np.asarray(function(-2.0 * step))
    return (8.0 * near - far) / (12.0 * step)


def relative_error(found: np.ndarray | float, expected: np.ndarray | float) -> float:
    """|found - expected| / |expected| in the Euclidean norm."""
    expected = np.asarray(expected)
    return float(np.linalg.norm(np.asarray(found) - expected) / np.linalg.norm(expected))


def full_hessian(energy, y: np.ndarray) -> np.ndarray:
    """Dense (3 n, 3 n) Hessian of an energy from its element blocks."""
    from flexscale.mechanics.energy import block_pairs

    i, j = block_pairs(energy.vectors.shape[1])
    dense = np.zeros((len(y), 3, len(y), 3))
    for vectors, blocks in zip(energy.vectors, energy.hessian_blocks(y), strict=True):
        for a, b, block in zip(vectors[i], vectors[j], blocks, strict=True):
            dense[a, :, b, :] += block
            if a != b:
                dense[b, :, a, :] += block.T
    return dense.reshape(3 * len(y), 3 * len(y))


def multiply_upper(pull_back, values: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Symmetric product from the upper triangle on a `PullBack`'s pattern."""
    n = pull_back.n_active
    upper = sp.csr_array((values, pull_back.indices, pull_back.indptr), shape=(n, n))
    return upper @ vector + sp.triu(upper, 1).T @ vector

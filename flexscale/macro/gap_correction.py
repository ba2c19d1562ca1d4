"""The smooth correction of `corrected_gap_law`, fitted to what fitted gaps leave."""

from __future__ import annotations

import numpy as np
import scipy.linalg
import scipy.sparse as sp

from flexscale.arrays import FloatArray
from flexscale.macro.corrected_gap_law import spline_rows
from flexscale.macro.tensor_samples import TensorSamples

N_CELLS = 12  # of the grid in each direction; scales meet along rays that are some 0.01 mm-1 apart
SMOOTHNESS = 0.3  # weight of third differences; less follows samples closer and is less convex
_RIDGE = 1e-3  # weight of coefficients, which none but corners of the grid feel
_MOMENTS = 0.5  # weight of moments beside energies


def fit_correction(
    samples: TensorSamples, energies: FloatArray, moments: FloatArray, reach: float
) -> FloatArray:
    """(n, n, n) coefficients of c, by least squares of log(W/W0) and of relative moments.

    Since moments are exp(c) (m + W dc), their errors are linear in c to first order.

    Parameters
    ----------
    samples : W0 and m0, within the reach.
    energies, moments : (p,) N mm-1, (p, 3) N, of the law to be corrected at the samples.
    reach : R, mm-1.
    """
    n, p = N_CELLS + 3, len(samples)
    columns, values = np.empty((p, 64), dtype=np.int64), np.empty((4, p, 64))
    spline_rows(samples.places, n, reach, columns, values)
    weights = _MOMENTS * samples.energies / samples.moment_lengths()
    values[1:] *= weights[:, None]
    rates = samples.moments / samples.energies[:, None] - moments / energies[:, None]
    wanted = np.concatenate([np.log(samples.energies / energies), *(weights[:, None] * rates).T])
    rows = np.arange(0, 64 * 4 * p + 1, 64)
    matrix = sp.csr_array((values.ravel(), np.tile(columns.ravel(), 4), rows), shape=(4 * p, n**3))
    normal = (matrix.T @ matrix + SMOOTHNESS**2 * _roughness(n)).toarray()
    normal[np.diag_indices(n**3)] += _RIDGE**2
    found = scipy.linalg.solve(normal, matrix.T @ wanted, assume_a="pos", overwrite_a=True)
    return np.asarray(found).reshape(n, n, n)


def _roughness(n: int) -> sp.csr_array:
    """(n³, n³) sum of squares of third differences along each direction of the grid."""
    rough = sp.csr_array(np.diff(np.eye(n), 3, axis=0))
    square, one = rough.T @ rough, sp.eye_array(n)
    along = ((square, one, one), (one, square, one), (one, one, square))
    return sp.csr_array(sum(sp.kron(sp.kron(a, b), c) for a, b, c in along))

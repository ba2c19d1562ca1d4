"""Small strictly convex quadratic programs with sparse inequalities, by an interior-point method.

    minimize 1/2 x.H x   subject to   A x + eps * lambda >= b,   lambda >= 0,

with lambda the multipliers: inequalities that contradict one another are softened by eps rather
than refused. S. Mehrotra's predictor and corrector, "On the implementation of a primal-dual
interior point method" (1992).
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from flexscale.arrays import FloatArray

_MOST_ITERATIONS = 60
_SHORT_OF_ZERO = 0.995
_TOLERANCE = 1e-9  # residuals and complementarity, over the scale of b


def solve_qp(
    hessian: sp.csc_array, rows: sp.csr_array, bounds: FloatArray, eps: float
) -> FloatArray:
    """Minimizer x (n,).

    Parameters
    ----------
    hessian : (n, n) H, positive definite.
    rows, bounds : (m, n) A and (m,) b.
    eps : softness.
    """
    m, n = rows.shape
    x = np.zeros(n)
    if m == 0 or (bounds <= 0.0).all():
        return x
    scale = float(np.abs(bounds).max())
    multipliers, slack = np.full(m, scale), np.maximum(rows @ x - bounds, scale)
    transposed = rows.T.tocsr()
    for _ in range(_MOST_ITERATIONS):
        dual = hessian @ x - transposed @ multipliers
        primal = rows @ x + eps * multipliers - slack - bounds
        mean = float(multipliers @ slack) / m
        if max(np.abs(dual).max(), np.abs(primal).max()) <= _TOLERANCE * scale and (
            mean <= (_TOLERANCE * scale) * scale
        ):
            break
        diagonal = slack + eps * multipliers
        weights = sp.diags_array(multipliers / diagonal)
        factor = splu((hessian + transposed @ weights @ rows).tocsc())
        # First with all products of multipliers and slacks aimed at 0, then, corrected, at a center
        # that is the closer to 0 the farther the first step can go.
        products = multipliers * slack
        for corrector in (False, True):
            pull = (products + multipliers * primal) / diagonal
            dx = factor.solve(-dual - transposed @ pull)
            dm = -pull - multipliers * (rows @ dx) / diagonal
            ds = rows @ dx + eps * dm + primal
            reach = min(_largest_step(multipliers, dm), _largest_step(slack, ds))
            if not corrector:
                ahead = float((multipliers + reach * dm) @ (slack + reach * ds)) / m
                products = products + dm * ds - (ahead / mean) ** 3 * mean
        x, multipliers, slack = x + reach * dx, multipliers + reach * dm, slack + reach * ds
    return x


def _largest_step(values: FloatArray, change: FloatArray) -> float:
    """Up to 1, with which positive values stay so."""
    falling = change < 0.0
    shares = -_SHORT_OF_ZERO * values[falling] / change[falling]
    return float(shares.min(initial=1.0))

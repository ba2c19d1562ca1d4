"""Modes that curve downward on the constraint, and the step that turns them over."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse as sp

from flexscale.solve.constraint import ConstrainedSystem
from flexscale.solve.linear import build_factorization
from flexscale.solve.negative_modes import negative_modes

N = 60


def indefinite(n_negative: int) -> tuple[np.ndarray, np.ndarray]:
    """A symmetric matrix with so many negative eigenvalues, and a unit vector of the constraint."""
    rng = np.random.default_rng(3)
    turn = np.linalg.qr(rng.standard_normal((N, N)))[0]
    values = np.concatenate([-(1.0 + np.arange(n_negative)), 2.0 + np.arange(N - n_negative)])
    constraint = rng.standard_normal(N)
    return turn @ np.diag(values) @ turn.T, constraint / np.linalg.norm(constraint)


@pytest.mark.parametrize("n_negative", [1, 3])
def test_modes_are_those_of_the_constrained_matrix(n_negative):
    matrix, constraint = indefinite(n_negative)
    upper = sp.csr_array(sp.triu(matrix))
    upper.sort_indices()
    factorization = build_factorization(upper.indptr, upper.indices, "superlu")
    system = ConstrainedSystem(factorization, upper.indptr[:-1], constraint, 5)
    found = system.factorize(upper.data)
    basis = scipy.linalg.null_space(constraint[None])
    values, vectors = np.linalg.eigh(basis.T @ matrix @ basis)
    assert found == np.count_nonzero(values < 0.0)
    curvatures, modes = negative_modes(system, found)
    order = np.argsort(curvatures)
    assert curvatures[order] == pytest.approx(values[:found], rel=1e-4)
    expected = basis @ vectors[:, :found]
    assert np.abs(np.sum(modes[:, order] * expected, axis=0)) == pytest.approx(1.0, abs=1e-3)


def test_none_where_there_are_none():
    matrix, constraint = indefinite(0)
    upper = sp.csr_array(sp.triu(matrix))
    factorization = build_factorization(upper.indptr, upper.indices, "superlu")
    system = ConstrainedSystem(factorization, upper.indptr[:-1], constraint, 5)
    assert system.factorize(upper.data) == 0
    assert len(negative_modes(system, 1)[0]) == 0

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


def factorized(matrix: np.ndarray, constraint: np.ndarray) -> ConstrainedSystem:
    upper = sp.csr_array(sp.triu(matrix))
    upper.sort_indices()
    factorization = build_factorization(upper.indptr, upper.indices, "superlu")
    return ConstrainedSystem(factorization, upper.indptr[:-1], constraint, 5)


def upper_values(matrix: np.ndarray) -> np.ndarray:
    return matrix[np.triu_indices(len(matrix))]


@pytest.mark.parametrize("n_negative", [1, 3])
def test_modes_are_those_of_the_constrained_matrix(n_negative):
    matrix, constraint = indefinite(n_negative)
    system = factorized(matrix, constraint)
    found = system.factorize(upper_values(matrix))
    basis = scipy.linalg.null_space(constraint[None])
    values, vectors = np.linalg.eigh(basis.T @ matrix @ basis)
    assert found == np.count_nonzero(values < 0.0)
    modes = negative_modes(system, found)
    order = np.argsort(modes.curvatures)
    assert modes.curvatures[order] == pytest.approx(values[:found], rel=0.05)
    expected = basis @ vectors[:, :found]
    directions = modes.directions / np.linalg.norm(modes.directions, axis=0)
    assert np.abs(np.sum(directions[:, order] * expected, axis=0)) == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize("n_negative", [1, 3, 8])
def test_turned_over_inverse_is_positive(n_negative):
    matrix, constraint = indefinite(n_negative)
    system = factorized(matrix, constraint)
    found = system.factorize(upper_values(matrix))
    modes = negative_modes(system, found)
    assert len(modes) == found > 0
    # Exact however rough the modes are: W^T H W = T.
    inner = modes.directions.T @ matrix @ modes.directions
    assert inner == pytest.approx(np.diag(modes.values), rel=1e-9, abs=1e-9)
    inverse = np.array(
        [modes.turn_over(system.solve(-unit)[0], unit) for unit in np.eye(len(matrix))]
    )
    basis = scipy.linalg.null_space(constraint[None])
    assert np.linalg.eigvalsh(-basis.T @ inverse @ basis).min() > 0.0


def test_none_where_there_are_none():
    matrix, constraint = indefinite(0)
    system = factorized(matrix, constraint)
    assert system.factorize(upper_values(matrix)) == 0
    assert len(negative_modes(system, 1)) == 0

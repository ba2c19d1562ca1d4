"""Factorization backends and the constrained system against dense linear algebra."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp

from flexscale.errors import UnknownNameError
from flexscale.solve.constraint import ConstrainedSystem
from flexscale.solve.linear import (
    ENVIRONMENT_VARIABLE,
    DenseFactorization,
    available_linear_solver,
    build_factorization,
)
from flexscale.solve.unconstrained import UnconstrainedSystem

BACKENDS = ["superlu", "pardiso", "dense"]
N = 60


def matrix(n_negative: int = 0, singular: bool = False) -> np.ndarray:
    """Dense symmetric matrix with a banded pattern and a known number of negative eigenvalues."""
    generator = np.random.default_rng(1)
    lower = np.tril(generator.normal(size=(N, N))) * (
        abs(np.subtract.outer(range(N), range(N))) < 4
    )
    np.fill_diagonal(lower, 4.0)
    signs = np.ones(N)
    signs[:n_negative] = -1.0
    if singular:
        signs[-1] = 0.0
    return lower @ np.diag(signs) @ lower.T


def upper(dense: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    csr = sp.csr_array(np.triu(dense))
    return csr.indptr.astype(np.int64), csr.indices.astype(np.int64), csr.data


def build(name: str, dense: np.ndarray):
    if name == "pardiso":
        pytest.importorskip("pypardiso")
    indptr, indices, values = upper(dense)
    if name == "dense":
        return DenseFactorization(indptr, indices), indptr, values
    return build_factorization(indptr, indices, name), indptr, values


@pytest.mark.parametrize("name", BACKENDS)
@pytest.mark.parametrize("n_negative", [0, 1, 5])
def test_solution_and_inertia(name, n_negative):
    dense = matrix(n_negative)
    factorization, _, values = build(name, dense)
    right = np.random.default_rng(2).normal(size=(N, 3))
    assert factorization.factorize(values) == n_negative
    assert factorization.solve(right) == pytest.approx(np.linalg.solve(dense, right), rel=1e-9)


@pytest.mark.parametrize("name", BACKENDS)
def test_values_can_change_on_the_same_pattern(name):
    factorization, _, values = build(name, matrix())
    factorization.factorize(values)
    assert factorization.factorize(2.0 * values) == 0
    right = np.ones((N, 1))
    expected = np.linalg.solve(2.0 * matrix(), right)
    assert factorization.solve(right) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("name", BACKENDS)
@pytest.mark.parametrize(("n_negative", "singular"), [(0, False), (2, False), (0, True)])
def test_constrained_solution_and_inertia(name, n_negative, singular):
    """Against the dense bordered system and the eigenvalues on the constraint's null space."""
    dense = matrix(n_negative, singular)
    factorization, indptr, values = build(name, dense)
    generator = np.random.default_rng(3)
    constraint, right = generator.random(N), generator.normal(size=N)
    # A singular matrix is only solvable if the shift unknown takes part in its null vector.
    system = ConstrainedSystem(factorization, indptr[:-1], constraint, N - 1)
    found = system.factorize(values)
    basis = np.linalg.svd(constraint[None])[2][1:]
    assert found == np.count_nonzero(np.linalg.eigvalsh(basis @ dense @ basis.T) < 0.0)
    bordered = np.block([[dense, constraint[:, None]], [constraint[None], np.zeros((1, 1))]])
    expected = np.linalg.solve(bordered, np.append(right, 0.3))
    step, multiplier = system.solve(right, target=0.3)
    assert step == pytest.approx(expected[:-1], rel=1e-8, abs=1e-10)
    assert multiplier == pytest.approx(expected[-1], rel=1e-8)


def test_damping_makes_a_matrix_positive():
    factorization, indptr, values = build("superlu", matrix(3))
    system = ConstrainedSystem(factorization, indptr[:-1], np.ones(N), 0)
    assert system.factorize(values) > 0
    assert system.factorize(values, damping=100.0) == 0


def test_solver_is_chosen_by_name_and_environment(monkeypatch):
    assert available_linear_solver("superlu") == "superlu"
    monkeypatch.setenv(ENVIRONMENT_VARIABLE, "superlu")
    assert available_linear_solver() == "superlu"
    with pytest.raises(UnknownNameError, match="superlu"):
        available_linear_solver("superlux")


@pytest.mark.parametrize("name", BACKENDS)
@pytest.mark.parametrize("n_negative", [0, 3])
def test_unconstrained_system(name, n_negative):
    """Solution, inertia and damping without a constraint; target and multiplier do not matter."""
    dense = matrix(n_negative)
    factorization, indptr, values = build(name, dense)
    system = UnconstrainedSystem(factorization, indptr[:-1])
    assert system.factorize(values) == n_negative
    right = np.random.default_rng(5).normal(size=N)
    step, multiplier = system.solve(right, target=1.0)
    assert step == pytest.approx(np.linalg.solve(dense, right), rel=1e-9)
    assert multiplier == 0.0
    assert system.factorize(values, damping=100.0) == 0

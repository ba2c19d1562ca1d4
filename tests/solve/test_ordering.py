"""Orders of elimination: permutations, groups kept together, and less fill than as given."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from flexscale.solve.linear import ENVIRONMENT_VARIABLE, build_factorization
from flexscale.solve.ordering import MANY, elimination_order, grouped_order, minimum_degree

RNG = np.random.default_rng(3)


def grid(n: int) -> sp.csr_array:
    """Upper triangle of the five-point stencil on an n x n grid, its nodes in random order."""
    line = sp.diags_array([np.full(n - 1, -1.0), np.full(n, 2.1)], offsets=[1, 0], shape=(n, n))
    line = line + sp.triu(line, 1).T
    full = sp.csr_array(sp.kronsum(line, line))
    shuffled = RNG.permutation(n * n)
    upper = sp.csr_array(sp.triu(full[shuffled][:, shuffled]))
    upper.sort_indices()
    return upper


def fill(matrix: sp.csr_array, order: np.ndarray) -> int:
    """Entries of the Cholesky factor with the unknowns eliminated in this order."""
    full = (matrix + sp.triu(matrix, 1).T).toarray()[np.ix_(order, order)]
    return int(np.count_nonzero(np.abs(np.linalg.cholesky(full)) > 1e-14))


def test_minimum_degree_fills_less():
    matrix = grid(12)
    order = minimum_degree(matrix)
    assert sorted(order) == list(range(144))
    assert fill(matrix, order) < 0.5 * fill(matrix, np.arange(144))


def test_groups_come_last_and_together():
    matrix = grid(8)
    groups = np.full(64, -1)
    groups[5:9], groups[20:26], groups[40:43] = 0, 1, 2
    order = grouped_order(matrix.indptr, matrix.indices, groups)
    assert sorted(order) == list(range(64))
    placed = groups[order]
    assert (placed[:51] == -1).all()
    assert (placed[-3:] == 2).all()
    assert np.count_nonzero(np.diff(placed[51:-3])) == 1  # both other groups in one piece


def test_solutions_do_not_depend_on_the_order():
    matrix = grid(10)
    load = RNG.normal(size=(100, 2))
    full = (matrix + sp.triu(matrix, 1).T).toarray()
    for order in (None, RNG.permutation(100)):
        factorization = build_factorization(matrix.indptr, matrix.indices, order=order)
        assert factorization.factorize(matrix.data) == 0
        assert np.abs(full @ factorization.solve(load) - load).max() < 1e-11


def test_many_groups_by_nested_dissection_all_but_the_last():
    """A row that is coupled with everything does not spoil the order of the others."""
    matrix = sp.lil_array(grid(20))
    matrix[:, 399] = 0.01
    matrix[399, 399] = 10.0
    upper = sp.csr_array(sp.triu(matrix))
    upper.sort_indices()
    groups = np.full(400, -1)
    groups[:MANY], groups[399] = np.arange(MANY), MANY
    order = elimination_order(upper.indptr, upper.indices, groups)
    assert order is not None
    assert sorted(order) == list(range(400))
    assert order[-1] == 399
    assert fill(upper, order) < 0.5 * fill(upper, np.arange(400))


def test_without_pardiso_the_backend_orders_many_groups(monkeypatch):
    monkeypatch.setenv(ENVIRONMENT_VARIABLE, "superlu")
    matrix = grid(5)
    assert elimination_order(matrix.indptr, matrix.indices, np.arange(25)) is None

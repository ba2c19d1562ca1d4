"""The Hessian of cells with many bodies: who is coupled, and that contact is all in it."""

from __future__ import annotations

import numpy as np
import pytest

import flexscale as fs
from flexscale.embedding.bends import Bend
from flexscale.homogenize.bend_line import Line
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.line import follow_line
from flexscale.patterns import Pattern
from flexscale.solve.solver_options import SolverOptions
from tests.derivatives import directional_difference, multiply_upper, relative_error

COARSE = fs.MeshOptions(along=1.5, corner=0.4, scale_size=4.0, scale_layers=1)
N = 4


def squares(n: int) -> CellProblem:
    """n squares in a row, which repeats."""
    tile = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]])
    tiles = [tile + np.array([10.0 * k, 0.0]) for k in range(n)]
    pattern = Pattern.from_polygons(tiles, (10.0 * n, 0.0), (0.0, 10.0))
    return CellProblem.from_pattern(pattern, fs.NativeModel("shell", mesh=COARSE))


@pytest.fixture(scope="module")
def problem() -> CellProblem:
    """Four squares: the first and the third never meet."""
    return squares(N)


def coupled(problem: CellProblem) -> np.ndarray:
    """(N, N) whether the pattern has entries between two bodies."""
    pull_back = problem.pull_back
    groups = pull_back.groups
    rows = np.repeat(np.arange(pull_back.n_active), np.diff(pull_back.indptr))
    found = np.zeros((N + 2, N + 2), dtype=bool)  # the sheet is -1, S is N
    found[groups[rows], groups[pull_back.indices]] = True
    return (found | found.T)[:N, :N]


def test_neighbors_are_coupled_and_no_others(problem):
    apart = np.abs(np.subtract.outer(np.arange(N), np.arange(N)))
    assert np.array_equal(coupled(problem), np.minimum(apart, N - apart) <= 1)


def test_hessian_of_touching_bodies():
    """Derivative of the gradient along a direction of all unknowns: two squares that touch each
    other, and each other's images.
    """
    problem = squares(2)
    line = Line("closing", 0.0, (0.006, 0.0115))
    sample = list(follow_line(problem, line, SolverOptions()))[-1]
    assert sample["contact_pairs"] > 0
    cell, z = problem.bent(line.bend(0.0115)), sample["state"]
    direction = np.zeros(len(z))
    direction[problem.active] = np.random.default_rng(1).normal(size=len(problem.active))
    slope = directional_difference(lambda h: cell.evaluate(z + h * direction).gradient, 1e-7)
    upper = cell.hessian_values(cell.evaluate(z))
    product = multiply_upper(problem.pull_back, upper, direction[problem.active])
    assert relative_error(product, slope) < 1e-6


def test_pattern_grows_where_others_meet(problem, monkeypatch):
    """Rows of the first and the third body in contact make room for both."""
    pull_back, contact = problem.pull_back, problem.contact
    y = problem.embedding.world_map.place(problem.embedding.rest, Bend(0.0, 0.0)).y
    assert not pull_back.cover(y)
    rows = contact.surface.rows
    owners = pull_back._owners(rows)
    pair = np.sort([rows[owners == 0][0], rows[owners == 2][0]])[None]
    monkeypatch.setattr(contact, "pair_blocks", lambda y, project=False: (pair, np.eye(3)[None]))
    assert pull_back.cover(y)
    assert coupled(problem)[0, 2]
    assert not pull_back.cover(y)

"""Forces between things that may part but not overlap."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import nnls

from flexscale.solve.unilateral import unilateral_forces


def solve(compliance: np.ndarray, missing: np.ndarray) -> np.ndarray:
    active, found = np.empty(len(missing), dtype=np.int64), np.empty(len(missing))
    n = unilateral_forces(compliance, missing, active, found)
    forces = np.zeros(len(missing))
    forces[active[:n]] = found[:n]
    return forces


@pytest.mark.parametrize("n", [1, 4, 25])
def test_nothing_overlaps_pulls_or_pushes_without_need(n: int) -> None:
    rng = np.random.default_rng(n)
    for _ in range(50):
        factor = rng.standard_normal((n, n + 2))
        compliance, missing = factor @ factor.T, rng.standard_normal(n)
        forces = solve(compliance, missing)
        left = compliance @ forces - missing
        assert forces.min() >= 0.0
        assert left.min() > -1e-7 * np.abs(missing).max()
        assert abs(forces @ left) < 1e-7 * max(1.0, abs(forces @ missing))


def test_as_least_squares_without_negative_numbers() -> None:
    rng = np.random.default_rng(3)
    factor = rng.standard_normal((12, 15))
    compliance, missing = factor @ factor.T, rng.standard_normal(12)
    lower = np.linalg.cholesky(compliance)
    expected = nnls(lower.T, np.linalg.solve(lower, missing))[0]
    np.testing.assert_allclose(solve(compliance, missing), expected, rtol=1e-8, atol=1e-10)


def test_copies_of_one_thing_do_no_harm() -> None:
    """The compliance is singular: forces are not unique, what they do is."""
    rng = np.random.default_rng(5)
    factor = rng.standard_normal((6, 3))
    factor, missing = np.vstack([factor, factor]), np.tile(factor @ [0.3, -0.2, 0.5], 2)
    compliance = factor @ factor.T
    forces = solve(compliance, missing)
    assert forces.min() >= 0.0
    assert (compliance @ forces - missing).min() > -1e-6
    once = solve(compliance[:6, :6], missing[:6])
    assert forces @ missing == pytest.approx(once @ missing[:6], rel=1e-6)


def test_what_depends_on_others_may_take_their_place() -> None:
    slopes = np.array([[1.0, 0.0], [0.0, 1.0], [2.0, 2.0]])
    missing = np.array([1.0, 0.6, 2.2])
    np.testing.assert_allclose(solve(slopes @ slopes.T, missing), [1.0, 0.6, 0.0], atol=1e-9)
    rng = np.random.default_rng(8)
    for _ in range(500):
        n, rank = int(rng.integers(2, 9)), int(rng.integers(1, 4))
        slopes = rng.standard_normal((n, rank))
        compliance = slopes @ slopes.T
        missing = slopes @ rng.standard_normal(rank) - rng.uniform(0.0, 1.0, n)  # can be met
        forces = solve(compliance, missing)
        left = compliance @ forces - missing
        assert forces.min() >= 0.0
        assert left.min() > -1e-6 * max(1.0, np.abs(missing).max())
        assert abs(forces @ left) < 1e-6 * max(1.0, abs(forces @ missing))


def test_nothing_missing_needs_no_force() -> None:
    assert not solve(np.eye(3), np.array([-1.0, -0.1, 0.0])).any()
    assert solve(np.zeros((0, 0)), np.zeros(0)).shape == (0,)

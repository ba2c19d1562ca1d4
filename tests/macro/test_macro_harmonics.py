"""Circular harmonics: linear fit, the paper's form, and positivity at every angle."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

from flexscale.macro.harmonics import (
    Harmonics,
    constrained_least_squares,
    fit_harmonics,
    harmonic_matrix,
)

DIRECTIONS = np.arange(0.0, 180.0, 15.0)
EVERY = np.arange(0.0, 180.0, 0.01)


def test_recovers_its_own_coefficients() -> None:
    known = Harmonics(np.array([3.0, 1.0, 0.5, -0.2]), np.array([0.0, 0.3, -0.2, 0.1]))
    found = fit_harmonics(DIRECTIONS, known(DIRECTIONS), 3)
    np.testing.assert_allclose(found.cosine, known.cosine, atol=1e-13)
    np.testing.assert_allclose(found.sine, known.sine, atol=1e-13)
    assert found.n_parameters == 7


def test_the_papers_form_gives_the_same_values() -> None:
    known = Harmonics(np.array([3.0, -1.0, 0.5]), np.array([0.0, 0.3, -0.2]))
    terms = [
        c * np.cos(2.0 * k * np.deg2rad(EVERY - d))
        for k, (c, d) in enumerate(zip(known.amplitudes, known.phases, strict=True))
    ]
    np.testing.assert_allclose(sum(terms), known(EVERY), atol=1e-12)
    assert (known.amplitudes[1:] >= 0.0).all()
    assert (known.phases[1:] < 180.0 / np.arange(1, 3)).all()


def test_period_is_half_a_turn() -> None:
    known = Harmonics(np.array([3.0, -1.0]), np.array([0.0, 0.3]))
    np.testing.assert_allclose(known(EVERY + 180.0), known(EVERY), atol=1e-12)


def test_least_value_is_found_between_samples() -> None:
    known = Harmonics(np.array([1.0, 0.3, 0.7, 0.2]), np.array([0.0, 0.6, -0.2, 0.4]))
    assert known.least() == pytest.approx(known(EVERY).min(), abs=1e-6)
    assert known.least() <= known(EVERY).min()
    assert Harmonics(np.array([2.0, 0.0]), np.zeros(2)).least() == 2.0


def test_plain_fit_dips_below_zero_and_the_bounded_one_does_not() -> None:
    values = np.where(np.abs(DIRECTIONS - 90.0) < 40.0, 0.02, 5.0)
    assert fit_harmonics(DIRECTIONS, values, 3).least() < 0.0
    bounded = fit_harmonics(DIRECTIONS, values, 3, floor=0.002)
    assert bounded(EVERY).min() >= 0.002 * (1.0 - 1e-5)


def test_bounded_fit_is_the_best_of_its_kind() -> None:
    values = np.where(np.abs(DIRECTIONS - 90.0) < 40.0, 0.02, 5.0)
    bounded = fit_harmonics(DIRECTIONS, values, 3, floor=0.002)
    matrix, fine = harmonic_matrix(DIRECTIONS, 3), harmonic_matrix(np.arange(0, 180, 0.25), 3)
    other = minimize(
        lambda x: np.sum((matrix @ x - values) ** 2),
        np.r_[5.0, np.zeros(6)],
        constraints={"type": "ineq", "fun": lambda x: fine @ x - 0.002},
        method="SLSQP",
        options={"maxiter": 500, "ftol": 1e-13},
    )
    ours = np.sum((bounded(DIRECTIONS) - values) ** 2)
    assert ours == pytest.approx(other.fun, rel=1e-4)


def test_bound_changes_nothing_where_it_does_not_bind() -> None:
    values = 3.0 + np.cos(np.deg2rad(2.0 * DIRECTIONS)) + 0.1 * np.sin(DIRECTIONS)
    plain, bounded = (fit_harmonics(DIRECTIONS, values, 2, floor=floor) for floor in (None, 0.2))
    np.testing.assert_array_equal(plain.cosine, bounded.cosine)


def test_weights_decide_who_gives_way() -> None:
    """Values that do not fit: relative weights hold the small one, equal weights the large."""
    values = 400.0 - 395.0 * np.cos(np.deg2rad(4.0 * DIRECTIONS))
    values[3] *= 1.1  # 45 degree, the stiffest
    equal = fit_harmonics(DIRECTIONS, values, 2)
    relative = fit_harmonics(DIRECTIONS, values, 2, weights=1.0 / values)
    assert abs(relative(0.0) / values[0] - 1.0) < 0.02 < abs(equal(0.0) / values[0] - 1.0)


def test_ceilings_hold_exactly() -> None:
    values = 10.0 + 3.0 * np.cos(np.deg2rad(2.0 * DIRECTIONS))
    ceilings = (np.array([0.0]), np.array([11.0]))
    found = fit_harmonics(DIRECTIONS, values, 3, ceilings=ceilings)
    assert found(0.0) == pytest.approx(11.0, abs=1e-9)


def test_constrained_least_squares_by_hand() -> None:
    """Nearest point to (2, 2) with x + y <= 2 is (1, 1)."""
    found = constrained_least_squares(
        np.eye(2), np.array([2.0, 2.0]), np.array([[-1.0, -1.0]]), np.array([-2.0])
    )
    np.testing.assert_allclose(found, [1.0, 1.0], atol=1e-12)

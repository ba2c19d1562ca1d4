"""Turning a pattern together with the state of its sheet changes nothing but the frame."""

from __future__ import annotations

import numpy as np
import pytest

import flexscale as fs
from flexscale.homogenize.tangent import TangentStiffness
from tests.macro.fit_samples import DIRECTIONS, law_sweep, tangent
from tests.macro.law_samples import (
    VARIANTS,
    energy_at,
    gradient_at,
    hessian_at,
    random_state,
    rotation,
    table,
    turn_form,
    turn_stiffness,
)


def turn_matrix(turn: float) -> np.ndarray:
    """(6, 6): a state (e, b) is turned by it."""
    block = np.stack([turn_form(unit, turn) for unit in np.eye(3)], axis=1)
    return np.kron(np.eye(2), block)


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("turn", [0.3, 1.1, np.pi / 2.0, 2.0, np.pi])
def test_turned_together(variant: str, turn: float) -> None:
    """Energy to 1e-10, and derivatives, which turn along."""
    own, turned, matrix = table(variant), table(variant, turn), turn_matrix(turn)
    rng = np.random.default_rng(13)
    for _ in range(100):
        state = np.concatenate(random_state(rng))
        there = matrix @ state
        assert energy_at(there, turned) == pytest.approx(energy_at(state, own), rel=1e-10)
        gradient = matrix.T @ gradient_at(there, turned)
        expected = gradient_at(state, own)
        np.testing.assert_allclose(gradient, expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())
        hessian = matrix.T @ hessian_at(there, turned) @ matrix
        expected = hessian_at(state, own)
        np.testing.assert_allclose(hessian, expected, rtol=0.0, atol=1e-7 * np.abs(expected).max())


def test_energy_sees_the_pattern_turn() -> None:
    """The check above can fail: a pattern turned alone has another energy."""
    state = np.array([0.0, 0.0, 0.0, 0.02, 0.0, 0.0])
    for variant in VARIANTS:
        alone = energy_at(state, table(variant, 1.1))
        assert abs(alone / energy_at(state, table(variant)) - 1.0) > 0.01


@pytest.mark.parametrize("variant", VARIANTS)
def test_half_a_turn_of_a_direction_changes_nothing(variant: str) -> None:
    state = np.array([0.0, 0.0, 0.0, 0.02, 0.003, -0.004])
    half = energy_at(state, table(variant, np.pi))
    assert half == pytest.approx(energy_at(state, table(variant)), rel=1e-12)


def test_fit_of_a_turned_sweep_is_the_turned_fit() -> None:
    """From samples to tensors: 1e-5, since harmonics are adjusted to samples by iteration."""
    sweep, known = law_sweep(softening=6.0, noise=0.01), tangent()
    turned_sweep = sweep.copy(deep=True)
    for name in ("moment", "energy_density"):
        turned_sweep[name].values = np.roll(sweep[name].values, 3, axis=1)
    turn = np.deg2rad(3.0 * (DIRECTIONS[1] - DIRECTIONS[0]))
    turned_tangent = TangentStiffness(
        turn_stiffness(known.matrix, turn), turn_stiffness(known.in_plane, turn)
    )
    model, there = fs.fit(sweep, known), fs.fit(turned_sweep, turned_tangent)
    rng, r = np.random.default_rng(17), rotation(turn)
    tensors = 0.015 * rng.standard_normal((50, 2, 2))
    tensors += np.swapaxes(tensors, -1, -2)
    np.testing.assert_allclose(
        there.tensor_energy(r @ tensors @ r.T), model.tensor_energy(tensors), rtol=1e-5
    )

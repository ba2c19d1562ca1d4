"""Energy of gaps that close, as a sheet law: closed forms and derivatives."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

from flexscale.homogenize.flat_contact import FlatContact
from flexscale.macro.gap_model import GapModel
from tests.derivatives import directional_difference, relative_error
from tests.macro.law_samples import IN_PLANE, TANGENT

SCALE = np.array([0.05] * 3 + [0.02] * 3)  # of the states


def contact(n: int = 5) -> FlatContact:
    """Gaps of 0.4 mm, some of which close in any direction; any three are independent."""
    rng = np.random.default_rng(2)
    factor = rng.standard_normal((n, n + 1))
    slopes = 40.0 * rng.standard_normal((n, 3))
    return FlatContact(np.full(n, 0.4), slopes, 0.2 * factor @ factor.T + 0.02 * np.eye(n))


def model(gaps: FlatContact, **changes: float) -> GapModel:
    return GapModel(TANGENT, IN_PLANE, gaps, **changes)


def test_one_gap_is_a_spring_beyond_its_onset() -> None:
    gap = FlatContact(np.array([0.4]), np.array([[-40.0, -20.0, 0.0]]), np.array([[0.5]]))
    found = model(gap)
    assert found.onset(0.0) == pytest.approx(0.01)
    assert found.onset(90.0) == pytest.approx(0.02)
    assert found.onset(0.0, "opening") == np.inf
    both = np.diag([0.01, 0.01])  # two curvatures close one gap together
    assert found.tensor_onset(both) == pytest.approx(2.0 / 3.0)
    free = 0.5 * np.array([0.01, 0.01, 0.0]) @ TANGENT @ [0.01, 0.01, 0.0]
    missing = 40.0 * 0.01 + 20.0 * 0.01 - 0.4
    assert found.tensor_energy(both) == pytest.approx(free + 0.5 * missing**2 / 0.5)


def test_energy_is_the_least_at_which_gaps_stay_open() -> None:
    """The dual, by another solver."""
    gaps, rng = contact(), np.random.default_rng(4)
    for _ in range(5):
        tensor = 0.02 * rng.standard_normal((2, 2))
        tensor = 0.5 * (tensor + tensor.T)
        k = np.array([tensor[0, 0], tensor[1, 1], 2.0 * tensor[0, 1]])
        missing = -(gaps.distances + gaps.slopes @ k)
        dual = minimize(
            lambda p, m=missing: 0.5 * p @ gaps.compliance @ p - p @ m,
            np.zeros(5), bounds=[(0.0, None)] * 5,
            jac=lambda p, m=missing: gaps.compliance @ p - m,
            options={"ftol": 1e-15, "gtol": 1e-12},
        )  # fmt: skip
        expected = 0.5 * k @ TANGENT @ k - dual.fun
        assert model(gaps).tensor_energy(tensor) == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("softening", [0.0, 2.0])
def test_derivatives(softening: float) -> None:
    law = model(contact(), softening=softening, contact_softening=softening, w_biaxial=50.0)
    law = law.sheet_law()
    rng, checked, closed = np.random.default_rng(1), 0, 0
    for state in SCALE * rng.standard_normal((40, 6)):
        gradient, hessian = (found[0] for found in law.derivatives(state[None]))
        ends = [
            law.derivatives((state + sign * 2e-4 * row)[None])[1][0]
            for row in np.diag(SCALE)
            for sign in (1.0, -1.0)
        ]
        both = np.outer(SCALE, SCALE)
        jumps = [np.abs((end - hessian) * both).max() for end in ends]
        if max(jumps) > 1e-2 * np.abs(hessian * both).max():
            continue  # a gap closes between the points of a difference
        differences, second = np.empty(6), np.empty((6, 6))
        for k, unit in enumerate(np.diag(SCALE)):
            differences[k] = directional_difference(
                lambda t, u=unit, at=state: law.energies((at + t * u)[None])[0], 1e-4
            )
            second[k] = (
                directional_difference(
                    lambda t, u=unit, at=state: law.gradients((at + t * u)[None])[0], 1e-4
                )
                / SCALE
            )
        assert relative_error(gradient * SCALE, differences) < 1e-6
        assert relative_error(hessian * both, second * both) < 1e-6
        checked += 1
        closed += law.energies(state[None])[0] > 1.01 * model_free(state, softening)
    assert checked > 20
    assert closed > 10


def model_free(state: np.ndarray, softening: float) -> float:
    none = FlatContact(np.zeros(0), np.zeros((0, 3)), np.zeros((0, 0)))
    free = model(none, softening=softening, w_biaxial=50.0).sheet_law()
    return float(free.energies(state[None])[0])


def test_uniaxial_moment_is_the_derivative_of_the_energy() -> None:
    found = model(contact(), contact_softening=1.0)
    for side in ("closing", "opening"):
        for direction in (0.0, 35.0, 120.0):
            slope = directional_difference(
                lambda t, d=direction, s=side: found.energy(0.018 + t, d, s), 1e-6
            )
            assert found.moment(0.018, direction, side) == pytest.approx(slope, rel=1e-6)

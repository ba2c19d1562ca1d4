"""The law of a joint: derivatives inside and beyond its bounds, and how it goes on there."""

from __future__ import annotations

import numpy as np
import pytest

from flexscale.errors import BadInputError
from flexscale.mechanics.joint_law import JointLaw
from tests.derivatives import directional_difference, relative_error

QUADRATIC = [(2, 0, 0, 0), (1, 0, 0, 1), (0, 0, 0, 2), (0, 2, 0, 0), (0, 0, 2, 0)]
HIGHER = [(3, 0, 0, 0), (1, 0, 0, 2), (2, 2, 0, 1), (0, 4, 0, 0), (0, 2, 2, 1), (3, 0, 0, 4)]


def law() -> JointLaw:
    return JointLaw(
        exponents=np.array(QUADRATIC + HIGHER, dtype=np.int64),
        coefficients=np.array(
            [0.22, -0.07, 0.035, 0.06, 0.09, -0.02, 0.03, 0.004, 0.005, 0.01, 0.02]
        ),
        thickness=0.4,
        modulus=26.0,
        bounds=np.array([[-0.15, 1.0], [-0.4, 0.4], [-0.4, 0.4], [-0.35, 0.35]]),
        band=(4.2, 0.5, -0.1, 0.3),
    )


def poses(n: int, reach: float) -> np.ndarray:
    rng = np.random.default_rng(7)
    low, high = law().bounds.T
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    return middle + reach * half * rng.uniform(-1.0, 1.0, (n, 4))


@pytest.mark.parametrize("reach", [1.0, 1.6, 5.0])
def test_gradient_and_hessian_agree_with_differences(reach: float) -> None:
    rng = np.random.default_rng(3)
    for q in poses(20, reach):
        along = rng.normal(size=4) * np.array([0.4, 0.4, 0.4, 0.35])
        _, gradient, hessian = (found[0] for found in law().evaluate(q[None]))
        energy = directional_difference(
            lambda step, q=q, along=along: law().evaluate(q + step * along)[0][0], 1e-4
        )
        forces = directional_difference(
            lambda step, q=q, along=along: law().evaluate(q + step * along)[1][0], 1e-4
        )
        # Across a bound the third derivative jumps: differences over 2e-4 of the range see 1e-6.
        assert relative_error(gradient @ along, energy) < 1e-6
        assert relative_error(hessian @ along, forces) < 1e-6


def test_energy_gradient_and_hessian_are_continuous_at_the_bounds() -> None:
    low, high = law().bounds.T
    for i in range(4):
        for edge, outwards in ((low[i], -1.0), (high[i], 1.0)):
            q = np.array([0.1, 0.2, -0.1, 0.05])
            q[i] = edge
            beyond = q.copy()
            beyond[i] += outwards * 1e-9
            for inside, outside in zip(law().evaluate(q), law().evaluate(beyond), strict=True):
                np.testing.assert_allclose(outside, inside, rtol=1e-6, atol=1e-7)


def test_energy_grows_in_every_direction_far_out() -> None:
    rng = np.random.default_rng(5)
    for _ in range(50):
        along = rng.normal(size=4)
        along *= 10.0 / np.linalg.norm(along)
        near, far = law().evaluate(np.array([along, 2.0 * along]))[0]
        assert far > 2.0 * near > 0.0


def test_energy_is_modulus_times_thickness_squared_of_the_terms() -> None:
    u, w, s, phi = 0.2, 0.1, -0.3, 0.15
    x = np.array([u / 0.4, w / 0.4, s / 0.4, phi])
    terms = np.prod(x ** law().exponents, axis=1)
    expected = 26.0 * 0.4**2 * terms @ law().coefficients
    np.testing.assert_allclose(law().evaluate(np.array([[u, w, s, phi]]))[0], expected, rtol=1e-13)


def test_stiffness_at_rest_is_of_the_quadratic_terms() -> None:
    np.testing.assert_allclose(law().stiffness[0, 0], 26.0 * 0.44)
    np.testing.assert_allclose(law().stiffness[0, 3], 26.0 * 0.4 * -0.07)
    np.testing.assert_allclose(law().stiffness[3, 3], 26.0 * 0.16 * 0.07)


def test_inside_is_the_box_and_the_band_around_touching() -> None:
    q = np.array(
        [
            [0.0, 0.0, 0.0, 0.0],
            [0.95, 0.0, 0.0, 0.3],  # touching
            [0.5, 0.0, 0.0, 0.3],  # the tops would overlap
            [0.9, 0.0, 0.0, -0.2],  # far open, and opened further
            [0.0, 0.41, 0.0, 0.0],
        ]
    )
    assert law().inside(q).tolist() == [True, True, False, False, False]


def test_a_power_beyond_the_tables_is_refused() -> None:
    with pytest.raises(BadInputError, match="power of 12"):
        JointLaw(np.array([[12, 0, 0, 0]]), np.ones(1), 0.4, 26.0, law().bounds)

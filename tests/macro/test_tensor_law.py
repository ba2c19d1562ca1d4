"""Energy of first and second form: derivatives, limits, singular states, meaning of its numbers."""

from __future__ import annotations

import numpy as np
import pytest

from flexscale.embedding.curvature_map import POSITION, place_images
from flexscale.macro.harmonics import Harmonics
from flexscale.macro.law_table import DELTA, least_onset
from flexscale.macro.polar import PolarLaw
from flexscale.macro.tensor_law import energy
from tests.derivatives import directional_difference, relative_error
from tests.macro.law_samples import (
    BIAXIAL,
    IN_PLANE,
    POLAR,
    SOFTENING,
    TANGENT,
    VARIANTS,
    energy_at,
    gradient_at,
    hessian_at,
    polar_of,
    principal_curvatures,
    random_state,
    table,
)

SCALE = np.array([0.05] * 3 + [0.02] * 3)  # of the states
ZERO = np.zeros(3)


def states(count: int) -> list[np.ndarray]:
    """Random states with principal curvatures apart, and off the kink by more than a step."""
    rng, found = np.random.default_rng(7), []
    while len(found) < count:
        state = np.concatenate(random_state(rng))
        low, high = principal_curvatures(state[3:])
        if high - low > 0.002:
            found.append(state)
    return found


def crosses_the_kink(state: np.ndarray, step: np.ndarray, parameters: np.ndarray) -> bool:
    """Whether the Hessian jumps between the outermost points of a difference."""
    ends = [hessian_at(state + sign * step, parameters) for sign in (2.0, -2.0)]
    return bool(np.abs((ends[0] - ends[1]) * np.outer(SCALE, SCALE)).max() > 1e-3)


@pytest.mark.parametrize("variant", VARIANTS)
def test_derivatives(variant: str) -> None:
    parameters, checked = table(variant), 0
    for state in states(60):
        hessian, gradient = hessian_at(state, parameters), gradient_at(state, parameters)
        np.testing.assert_allclose(hessian, hessian.T, rtol=0.0, atol=1e-9 * np.abs(hessian).max())
        differences, second = np.empty(6), np.empty((6, 6))
        if any(crosses_the_kink(state, 1e-4 * row, parameters) for row in np.diag(SCALE)):
            continue
        for k, unit in enumerate(np.eye(6)):
            differences[k] = directional_difference(
                lambda t, u=unit, at=state: energy_at(at + t * u, parameters), 1e-4 * SCALE[k]
            )
            second[k] = directional_difference(
                lambda t, u=unit, at=state: gradient_at(at + t * u, parameters), 1e-4 * SCALE[k]
            )
        both = np.outer(SCALE, SCALE)
        assert relative_error(gradient * SCALE, differences * SCALE) < 1e-6
        assert relative_error(hessian * both, second * both) < 1e-6
        checked += 1
    assert checked > 50


@pytest.mark.parametrize("variant", VARIANTS)
def test_singular_states_have_finite_derivatives(variant: str) -> None:
    parameters, rng = table(variant), np.random.default_rng(11)
    second_forms = [ZERO, *([k, 0.0, k] for k in (1e-12, 0.01, -0.01, 0.05, -0.05))]
    second_forms += [[1e-300, 0.0, 0.0], [0.0, 1e-9, 0.0], [0.02, 0.0, 0.0], [0.01, 0.0, -0.01]]
    second_forms += list(10.0 ** rng.uniform(-9, -1, (500, 1)) * rng.standard_normal((500, 3)))
    for b in second_forms:
        state = np.concatenate([ZERO, b])
        assert np.isfinite(energy_at(state, parameters))
        assert energy_at(state, parameters) >= 0.0
        assert np.isfinite(gradient_at(state, parameters)).all()
        assert np.isfinite(hessian_at(state, parameters)).all()


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_uniaxial_bending_is_the_two_regime_law(variant: str, sign: float) -> None:
    """Of that direction and side; "paper" misses it by the share (δ/κ)² of its rounding."""
    parameters = table(variant)
    tolerance = 1e-12 if variant == "tangent" else 10.0 * (DELTA / 0.002) ** 2
    side = 0 if sign > 0.0 else 1
    for direction in np.arange(0.0, 180.0, 7.0):
        c, s = np.cos(np.deg2rad(direction)), np.sin(np.deg2rad(direction))
        law = polar_of(variant).law(np.array(direction), side, within=False)
        for kappa in (0.002, 0.009, 0.013, 0.03):
            b = sign * kappa * np.array([c * c, c * s, s * s])
            assert energy(ZERO, b, parameters) == pytest.approx(law.energy(kappa), rel=tolerance)
            along = gradient_at(np.concatenate([ZERO, b]), parameters)[3:] @ [c * c, c * s, s * s]
            assert sign * along == pytest.approx(law.moment(kappa), rel=tolerance)


def test_positive_second_form_closes() -> None:
    """The native cell closes at positive curvature; its surface there has b = n·x_uu > 0."""
    kappa, step = 0.01, 0.5
    place = np.array([-step, 0.0, 0.0, 0.0, 0.0, 0.0, step, 0.0, 0.0, 0.0, 0.0, 0.0])
    nodes, kinds, none = np.array([0, 3, 6]), np.full(3, POSITION), np.zeros((3, 2))
    x, jacobian, rate = np.empty((3, 3)), np.empty((3, 3, 6)), np.empty((3, 3))
    place_images(place, kappa, 0.0, kinds, nodes, none, none, x, jacobian, rate)
    second_form = (x[0, 2] - 2.0 * x[1, 2] + x[2, 2]) / step**2  # the normal at 0 is e3
    assert second_form == pytest.approx(kappa, rel=1e-4)
    bent, closing = np.array([second_form * 2.0, 0.0, 0.0]), polar_of("paper").law(np.array(0.0), 0)
    assert energy(ZERO, bent, table("paper")) == pytest.approx(closing.energy(bent[0]), rel=1e-6)


def test_before_contact_the_tangent_energy_is_that_of_the_flat_cell() -> None:
    """Also where principal curvatures couple; softened by the energy itself."""
    parameters, rng = table("tangent"), np.random.default_rng(5)
    for b in 0.003 * rng.uniform(-1.0, 1.0, (20, 3)):
        k = np.array([b[0], b[2], 2.0 * b[1]])
        expected = np.log1p(SOFTENING * 0.5 * k @ TANGENT @ k) / SOFTENING
        expected += 0.5 * BIAXIAL * (b[0] * b[2] - b[1] ** 2) ** 2
        assert energy(ZERO, b, parameters) == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize("variant", VARIANTS)
def test_membrane_is_st_venant_kirchhoff(variant: str) -> None:
    e = np.array([0.03, -0.02, 0.01])
    strain = np.array([0.5 * e[0], 0.5 * e[2], e[1]])
    flat = energy(ZERO, ZERO, table(variant))
    assert energy(e, ZERO, table(variant)) - flat == pytest.approx(
        0.5 * strain @ IN_PLANE @ strain, rel=1e-12
    )
    stress = gradient_at(np.concatenate([e, ZERO]), table(variant))[:3]
    expected = (IN_PLANE @ strain) * [0.5, 0.5, 1.0]
    np.testing.assert_allclose(stress[[0, 2, 1]], expected, rtol=1e-12)


def around_umbilic(radius: float, variant: str) -> np.ndarray:
    """Energies on a small circle of tensors around κ1 = κ2 = 0.02."""
    angles, parameters = np.arange(0.0, 2.0 * np.pi, 0.1), table(variant)
    shifts = radius * np.stack([np.cos(angles), np.sin(angles), -np.cos(angles)], axis=1)
    return np.array([energy(ZERO, np.array([0.02, 0.0, 0.02]) + s, parameters) for s in shifts])


def test_tangent_energy_is_continuous_at_equal_curvatures() -> None:
    assert np.ptp(around_umbilic(1e-6, "tangent")) < 1e-3 * around_umbilic(0.0, "tangent")[0]
    # The paper's is not: that is why it is not the default.
    assert np.ptp(around_umbilic(1e-5, "paper")) > 1e-2 * around_umbilic(0.0, "paper")[0]


def test_hessian_at_the_onset_is_that_before_contact() -> None:
    onset = Harmonics(np.array([0.015625, 0.0, 0.0, 0.0]), np.zeros(4))  # exact in binary
    polar = PolarLaw(POLAR.sides, POLAR.a, POLAR.b, (onset, onset), ("kappa_0", "kappa_0"), 0.02)
    parameters = table("tangent", polar=polar)
    at, before, after = (
        hessian_at(np.array([0.0, 0.0, 0.0, factor * 0.015625, 0.0, 0.0]), parameters)[3, 3]
        for factor in (1.0, 0.999, 1.001)
    )
    assert at == pytest.approx(before, rel=1e-9)
    assert after > 1.5 * before


def test_biaxial_resistance_acts_on_double_curvature_only() -> None:
    """½ w det²: nothing in uniaxial bending, all in twist."""
    parameters = table("paper")
    without = parameters.copy()
    without[12] = 0.0
    for b, det in (([0.01, 0.0, 0.0], 0.0), ([0.0, 0.004, 0.0], -1.6e-5)):
        form = np.array(b)
        extra = energy(ZERO, form, parameters) - energy(ZERO, form, without)
        assert extra == pytest.approx(0.5 * BIAXIAL * det**2, abs=1e-18)


def test_least_onset_is_where_contact_begins() -> None:
    """Elements below it skip contact; half a percent above it, one of 2000 directions has some."""
    least, parameters = least_onset(POLAR), table("tangent")
    angles = np.linspace(0.0, np.pi, 2000)
    unit = np.stack([np.cos(angles) ** 2, np.cos(angles) * np.sin(angles), np.sin(angles) ** 2])
    for factor, touched in ((1.0 - 1e-9, False), (1.005, True)):
        excess = []
        for sign in (1.0, -1.0):
            for b in sign * factor * least * unit.T:
                k = np.array([b[0], b[2], 2.0 * b[1]])
                flat = np.log1p(SOFTENING * 0.5 * k @ TANGENT @ k) / SOFTENING
                excess.append(energy(ZERO, b, parameters) / flat - 1.0)
        assert (max(excess) > 1e-7) == touched


def test_side_that_was_not_sampled_never_touches() -> None:
    one = PolarLaw(("closing",), POLAR.a, POLAR.b[:1], POLAR.onset[:1], ("kappa_0",), 0.02)
    b = np.array([-0.05, 0.0, 0.0])
    expected = 0.5 * TANGENT[0, 0] * 0.05**2  # this polar law has no softening
    assert energy(ZERO, b, table("tangent", polar=one)) == pytest.approx(expected, rel=1e-13)

"""Harmonics adjusted to samples: derivatives, what is gained, and what stays true."""

from __future__ import annotations

import numpy as np
import pytest

from flexscale.macro.flat_response import FlatResponse
from flexscale.macro.harmonics import stiffness_harmonics
from flexscale.macro.polar import PolarLaw, fit_directions, fit_polar
from flexscale.macro.refine import _collect, _Problem, fit_refined
from flexscale.macro.samples import Samples, read_samples
from tests.derivatives import directional_difference, relative_error
from tests.macro.fit_samples import CURVATURES, kappa_0_of, law_sweep, tangent

DIRECTIONS = np.arange(0.0, 180.0, 7.5)
FLAT = FlatResponse(stiffness_harmonics(tangent().matrix))


def angular(directions: np.ndarray) -> np.ndarray:
    """Onset with kinks, as no harmonics of order 3 have them."""
    return 0.007 + 0.006 * np.abs(np.sin(np.deg2rad(3.0 * directions)))


def part_of_the_circle(directions: np.ndarray) -> np.ndarray:
    inverse = 30.0 + 70.0 * np.cos(2.0 * np.deg2rad(directions - 45.0))
    return np.where(inverse > 50.0, 1.0 / np.maximum(inverse, 1.0), np.nan)


def fits(onset) -> tuple[Samples, PolarLaw, PolarLaw]:  # type: ignore[no-untyped-def]
    """Samples, and their harmonics before and after."""
    sweep = law_sweep(directions=DIRECTIONS, closing=onset, opening=None, touches=True)
    samples = read_samples(sweep)
    laws = fit_directions(samples, "relative", FLAT)
    before = fit_polar(laws, samples, "relative", FLAT)
    after = fit_refined(laws, samples, "relative", FLAT)
    assert before is not None
    assert after is not None
    return samples, before, after


def moment_errors(polar: PolarLaw, samples: Samples) -> np.ndarray:
    moments = [polar.law(np.array(d), 0).moment(samples.curvatures) for d in samples.directions]
    return np.abs(np.array(moments) / samples.moment[0] - 1.0)


@pytest.mark.parametrize("onset", [angular, part_of_the_circle])
def test_jacobian(onset) -> None:  # type: ignore[no-untyped-def]
    samples, before, _ = fits(onset)
    every = np.full(len(DIRECTIONS), True)
    side = _collect(samples, 0, every, "relative", FLAT)
    inverse = before.onset_quantity[0] == "1/kappa_0"
    assert inverse == (onset is part_of_the_circle)
    problem = _Problem(before.b[0], before.onset[0], inverse, side)
    x = problem.start + 0.01 * np.random.default_rng(1).standard_normal(14)
    found = problem.jacobian(x)
    for k, unit in enumerate(np.eye(14)):
        column = directional_difference(lambda t, u=unit: problem.residuals(x + t * u), 1e-6)
        assert relative_error(found[:, k], column) < 1e-5


@pytest.mark.parametrize("onset", [angular, part_of_the_circle])
def test_samples_are_met_better(onset) -> None:  # type: ignore[no-untyped-def]
    samples, before, after = fits(onset)
    errors = [np.minimum(moment_errors(polar, samples), 1.0).mean() for polar in (before, after)]
    assert errors[1] < 0.9 * errors[0]


def test_what_is_met_already_stays() -> None:
    _, before, after = fits(kappa_0_of)
    np.testing.assert_allclose(after.b[0].cosine, before.b[0].cosine, rtol=1e-3, atol=0.5)
    np.testing.assert_allclose(after.onset[0].cosine, before.onset[0].cosine, atol=1e-6)


def test_positive_and_free_of_contact_as_before() -> None:
    _, _, after = fits(angular)
    assert after.b[0].least() > 0.0
    assert after.onset[0].least() > 0.0
    _, _, after = fits(part_of_the_circle)
    free = DIRECTIONS[np.isnan(part_of_the_circle(DIRECTIONS))]
    assert (after.onset[0](free) <= 1.0 / CURVATURES[-1] * (1.0 + 1e-6)).all()


def test_without_a_flat_response_nothing_is_adjusted() -> None:
    """The paper's choice."""
    sweep = law_sweep(directions=DIRECTIONS, closing=angular, opening=None, touches=True)
    samples = read_samples(sweep)
    laws = fit_directions(samples, "relative")
    polar, same = fit_polar(laws, samples, "relative"), fit_refined(laws, samples, "relative")
    assert polar is not None
    assert same is not None
    np.testing.assert_array_equal(polar.onset[0].cosine, same.onset[0].cosine)

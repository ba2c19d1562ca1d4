"""The two-regime law of one direction and its fit."""

from __future__ import annotations

import numpy as np
import pytest

from flexscale.datasets.variables import WEIGHTINGS, Weighting
from flexscale.macro.uniaxial import Line, UniaxialLaw, fit_uniaxial

KAPPA = np.linspace(0.0025, 0.02, 8)


def line(law: UniaxialLaw, *, noise: float = 0.0, free_until: float | None = None) -> Line:
    scatter = 1.0 + noise * np.random.default_rng(3).standard_normal((2, len(KAPPA)))
    return Line(KAPPA, law.energy(KAPPA) * scatter[0], law.moment(KAPPA) * scatter[1], free_until)


def straight(a: float) -> UniaxialLaw:
    return UniaxialLaw(a, np.nan, np.nan)


def test_moment_is_continuous_and_energy_its_integral() -> None:
    law = UniaxialLaw(60.0, 240.0, 0.01)
    at = np.array([0.0, 0.005, 0.01, 0.015])
    np.testing.assert_allclose(law.moment(at), [0.0, 0.3, 0.6, 1.8], rtol=1e-14)
    fine = np.linspace(0.0, 0.015, 3001)
    integral = np.trapezoid(law.moment(fine), fine)
    assert law.energy(0.015) == pytest.approx(integral, rel=1e-7)


def test_law_without_contact_goes_on_straight() -> None:
    law = straight(60.0)
    assert not law.has_contact
    np.testing.assert_allclose(law.moment(np.array([0.01, 5.0])), [0.6, 300.0])
    np.testing.assert_allclose(law.energy(0.01), 0.003)


@pytest.mark.parametrize("weighting", WEIGHTINGS)
@pytest.mark.parametrize("onset", [0.0049, 0.0101, 0.0125, 0.0170])
def test_recovers_a_known_law(weighting: Weighting, onset: float) -> None:
    law = fit_uniaxial({"closing": line(UniaxialLaw(4.5, 2500.0, onset))}, weighting)["closing"]
    # The sums of squares cancel to 1e-16, their minimum is known to the root of that.
    assert law.a == pytest.approx(4.5, rel=1e-6)
    assert law.b == pytest.approx(2500.0, rel=1e-6)
    assert law.kappa_0 == pytest.approx(onset, rel=1e-6)


def test_sides_share_a_but_not_the_rest() -> None:
    lines = {
        "closing": line(UniaxialLaw(60.0, 240.0, 0.0131)),
        "opening": line(UniaxialLaw(60.0, 150.0, 0.0061)),
    }
    laws = fit_uniaxial(lines)
    assert laws["closing"].a == laws["opening"].a == pytest.approx(60.0, rel=1e-6)
    assert laws["closing"].kappa_0 == pytest.approx(0.0131, rel=1e-6)
    assert laws["opening"].b == pytest.approx(150.0, rel=1e-5)


def test_shared_a_lies_between_what_each_side_wants() -> None:
    laws = fit_uniaxial({"closing": line(straight(60.0)), "opening": line(straight(63.0))})
    assert 60.5 < float(laws["closing"].a) < 62.5
    assert laws["opening"].a == laws["closing"].a


@pytest.mark.parametrize("noise", [0.0, 0.01, 0.03])
def test_a_straight_line_has_no_contact(noise: float) -> None:
    laws = fit_uniaxial({"closing": line(straight(60.0), noise=noise)})
    assert np.isnan(laws["closing"].kappa_0)
    assert np.isnan(laws["closing"].b)
    assert laws["closing"].a == pytest.approx(60.0, rel=max(noise, 1e-12))


def test_softening_is_no_contact() -> None:
    moment = 60.0 * KAPPA - 800.0 * KAPPA**2
    energy = 30.0 * KAPPA**2 - 800.0 / 3.0 * KAPPA**3
    assert not fit_uniaxial({"opening": Line(KAPPA, energy, moment)})["opening"].has_contact


def test_noise_moves_the_onset_little() -> None:
    law = fit_uniaxial({"closing": line(UniaxialLaw(60.0, 600.0, 0.0101), noise=0.01)})["closing"]
    assert law.kappa_0 == pytest.approx(0.0101, rel=0.03)
    assert law.a == pytest.approx(60.0, rel=0.02)


def test_measured_contact_decides_where_there_is_some() -> None:
    gentle = UniaxialLaw(60.0, 64.0, 0.0101)
    assert not fit_uniaxial({"closing": line(gentle)})["closing"].has_contact
    assert fit_uniaxial({"closing": line(gentle, free_until=0.0)})["closing"].has_contact
    stiff = UniaxialLaw(60.0, 600.0, 0.0101)
    assert not fit_uniaxial({"closing": line(stiff, free_until=np.inf)})["closing"].has_contact


def test_relative_weighting_keeps_small_curvatures() -> None:
    """The paper's Fig. 12 a, b: absolute errors of a law that is not exact spoil a."""
    beyond = np.maximum(KAPPA - 0.0101, 0.0)
    moment = 4.5 * KAPPA + 3000.0 * beyond - 60000.0 * beyond**2
    energy = 2.25 * KAPPA**2 + 1500.0 * beyond**2 - 20000.0 * beyond**3
    # A little stiffening before contact, as geometry causes it.
    moment, energy = moment + 100.0 * KAPPA**2, energy + 100.0 / 3.0 * KAPPA**3
    off = {}
    for weighting in WEIGHTINGS:
        law = fit_uniaxial({"closing": Line(KAPPA, energy, moment)}, weighting)["closing"]
        error = np.abs(law.moment(KAPPA) / moment - 1.0)
        off[weighting] = float(np.median(error))
    assert off["relative"] < 0.08 < off["absolute"]


def test_onset_is_not_before_scales_touch() -> None:
    """A kink in the free sheet, as of one side softer than the other, is not taken for contact."""
    law = UniaxialLaw(60.0, 90.0, 0.004)
    early = fit_uniaxial({"closing": line(law)})["closing"]
    assert early.kappa_0 == pytest.approx(0.004, rel=1e-4)
    known = fit_uniaxial({"closing": line(law, free_until=0.01)})["closing"]
    assert known.kappa_0 >= 0.01


def test_known_stiffness_is_kept() -> None:
    law, known = UniaxialLaw(60.0, 400.0, 0.01), UniaxialLaw(58.0, np.nan, np.nan)
    fitted = fit_uniaxial({"closing": line(law), "opening": line(law)}, known=known)
    for side in ("closing", "opening"):
        assert fitted[side].a == 58.0
        assert fitted[side].b == pytest.approx(400.0, rel=0.05)


def test_known_softening_leaves_contact_to_be_found() -> None:
    law = UniaxialLaw(60.0, 400.0, 0.01, 20.0)
    known = UniaxialLaw(60.0, np.nan, np.nan, 20.0)
    found = fit_uniaxial({"closing": line(law)}, known=known)["closing"]
    assert (found.a, found.softening) == (60.0, 20.0)
    assert found.b == pytest.approx(400.0, rel=1e-4)
    assert found.kappa_0 == pytest.approx(0.01, rel=1e-4)


def test_softened_moment_is_the_derivative_of_its_energy() -> None:
    law, kappa, step = UniaxialLaw(60.0, 400.0, 0.01, 20.0), np.linspace(0.001, 0.0305, 30), 1e-7
    difference = (law.energy(kappa + step) - law.energy(kappa - step)) / (2.0 * step)
    np.testing.assert_allclose(difference, law.moment(kappa), rtol=1e-6)
    before = UniaxialLaw(60.0, 400.0, np.nan, 20.0)
    # Where the energy without softening is 1/s, the moment is half.
    assert before.moment(np.sqrt(2.0 / 20.0 / 60.0)) == pytest.approx(
        0.5 * 60.0 * np.sqrt(2.0 / 20.0 / 60.0)
    )

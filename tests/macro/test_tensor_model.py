"""The model of any bending: derivatives, what it has exactly, fits of known laws, refusals."""

from __future__ import annotations

import logging
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import flexscale as fs
from flexscale.errors import BadInputError, SchemaError
from flexscale.homogenize.flat_contact import FlatContact
from flexscale.macro import corrected_gap_law, gap_fit, gap_law
from flexscale.macro.gap_correction import N_CELLS, fit_correction
from flexscale.macro.gap_fit import ClosingGaps, fit_gaps
from flexscale.macro.law_table import build_rest_table
from flexscale.macro.tensor_model import _errors, _law
from flexscale.macro.tensor_samples import TensorSamples
from flexscale.mechanics.sheet_law import SheetLaw
from tests.derivatives import directional_difference, relative_error
from tests.macro.law_samples import IN_PLANE, TANGENT
from tests.macro.test_gap_law import contact

REACH = 0.03


def gaps() -> ClosingGaps:
    turns = 300.0 * np.random.default_rng(5).standard_normal((5, 3, 3))
    return ClosingGaps(contact(), turns + turns.transpose(0, 2, 1), 0.3, 0.7)


def gap_table(given: ClosingGaps) -> np.ndarray:
    rest = build_rest_table(TANGENT, IN_PLANE, 0.0, given.softening)
    own = given.contact
    return gap_law.build_gap_table(
        rest, own.distances, own.slopes, own.compliance, given.contact_softening, given.turns
    )


def random_places(n: int, seed: int = 0) -> np.ndarray:
    """(n, 3) places in a sphere of the reach."""
    rng = np.random.default_rng(seed)
    ways = rng.standard_normal((n, 3))
    return ways / np.linalg.norm(ways, axis=1)[:, None] * REACH * rng.uniform(0.1, 1.0, (n, 1))


def samples_of(law: SheetLaw, places: np.ndarray) -> TensorSamples:
    """What a tensor sweep would have of a sheet with this law."""
    n = len(places)
    root = np.sqrt(0.5)
    states = np.zeros((n, 6))
    states[:, 3:] = places[:, [0, 2, 1]] * [1.0, root, 1.0]
    moments = law.gradients(states)[:, [3, 5, 4]] * [1.0, 1.0, root]
    numbers = np.arange(n)
    return TensorSamples(
        places, law.energies(states), moments, np.ones(n, dtype=bool), numbers, 0 * numbers, numbers
    )


@pytest.mark.parametrize("length", [0.6, 1.4])
def test_derivatives_are_exact_within_the_reach_and_beyond(length: float) -> None:
    rng = np.random.default_rng(1)
    coefficients = 0.1 * rng.standard_normal((N_CELLS + 3,) * 3)
    law = _law(gap_table(gaps()), IN_PLANE, REACH, coefficients)
    for _ in range(20):
        state, way = np.zeros(6), rng.standard_normal(6) * ([0.05] * 3 + [0.02] * 3)
        place = rng.standard_normal(3)
        place *= length * REACH / np.linalg.norm(place)
        state[:3] = 0.05 * rng.standard_normal(3)
        state[3:] = place[[0, 2, 1]] * [1.0, np.sqrt(0.5), 1.0]
        gradient, hessian = law.derivatives(state[None])

        def energy(s: float, state: np.ndarray = state, way: np.ndarray = way) -> float:
            return float(law.energies((state + s * way)[None])[0])

        def slope(s: float, state: np.ndarray = state, way: np.ndarray = way) -> np.ndarray:
            return law.gradients((state + s * way)[None])[0]

        assert relative_error(gradient[0] @ way, directional_difference(energy, 1e-4)) < 1e-6
        assert relative_error(hessian[0] @ way, directional_difference(slope, 1e-5)) < 1e-5


def test_without_correction_it_is_the_law_of_the_gaps() -> None:
    table, states = gap_table(gaps()), np.zeros((50, 6))
    states[:, 3:] = random_places(50)
    zero = _law(table, IN_PLANE, REACH, np.zeros((N_CELLS + 3,) * 3))
    own = SheetLaw(gap_law.energy, gap_law.law, table, 1.0)
    assert zero.energies(states) == pytest.approx(own.energies(states), rel=1e-13)
    for found, expected in zip(zero.derivatives(states), own.derivatives(states), strict=True):
        assert np.abs(found - expected).max() < 1e-12 * np.abs(expected).max()


def test_the_correction_goes_on_smoothly_beyond_the_reach() -> None:
    coefficients = 0.2 * np.random.default_rng(3).standard_normal((N_CELLS + 3,) * 3)
    table = np.concatenate([[len(coefficients), REACH], coefficients.ravel()])
    first, second = np.empty(3), np.empty((0, 0))
    way = np.array([0.6, -0.5, 0.4]) / np.linalg.norm([0.6, -0.5, 0.4])

    def at(length: float) -> tuple[float, np.ndarray]:
        place = tuple(length * way)
        value = corrected_gap_law.correction(place, table, 0, first, second)
        return value, first.copy()

    inside, outside = at(REACH * (1.0 - 1e-9)), at(REACH * (1.0 + 1e-9))
    assert inside[0] == pytest.approx(outside[0], abs=1e-8)
    assert inside[1] == pytest.approx(outside[1], rel=1e-6)
    # Far away it ends at the sphere of 1.1 times the reach.
    assert at(5.0 * REACH)[0] == pytest.approx(at(50.0 * REACH)[0], abs=1e-9)


def test_numbers_of_gaps_have_exact_derivatives() -> None:
    given, rng = gaps(), np.random.default_rng(2)
    n = len(given.contact)
    values = np.concatenate([
        [given.softening, given.contact_softening], given.contact.distances,
        given.contact.slopes.ravel(), 200.0 * rng.standard_normal(6 * n), rng.uniform(0.5, 1.5, n),
    ])  # fmt: skip
    law = SheetLaw(gap_law.energy, gap_law.law, gap_table(given), 1.0)
    samples = samples_of(law, random_places(40))
    _, _, by, moment_by = gap_fit._evaluate(values, given.contact, TANGENT, samples)
    for k in range(len(values)):
        step = np.zeros(len(values))
        step[k] = 1e-6 * max(abs(values[k]), 1.0)
        ahead, back = (
            gap_fit._evaluate(values + sign * step, given.contact, TANGENT, samples)
            for sign in (1.0, -1.0)
        )
        for which, exact in ((0, by[:, k]), (1, moment_by[:, :, k])):
            difference = (ahead[which] - back[which]) / (2.0 * step[k])
            assert np.abs(difference - exact).max() <= 1e-5 * max(np.abs(exact).max(), 1e-6)


def test_a_law_of_gaps_is_found_again() -> None:
    """From gaps without turns whose distances and compliances are off by a fifth."""
    true = gaps()
    law = SheetLaw(gap_law.energy, gap_law.law, gap_table(true), 1.0)
    samples = samples_of(law, random_places(2000))
    start = replace(
        true.contact,
        distances=1.2 * true.contact.distances,
        compliance=0.8 * true.contact.compliance,
    )
    found = fit_gaps(start, TANGENT, samples)
    again = SheetLaw(gap_law.energy, gap_law.law, gap_table(found), 1.0)
    unseen = samples_of(law, random_places(500, seed=1))
    energies, moments = _errors(again, unseen)
    assert np.median(np.abs(energies)) < 1e-4
    assert np.quantile(np.abs(moments), 0.95) < 0.01
    assert found.softening == pytest.approx(true.softening, rel=0.05)


def test_what_a_grid_can_tell_is_corrected_exactly() -> None:
    """Energies off by the exponential of a quadratic, which cubic splines have."""
    table = gap_table(gaps())
    law = SheetLaw(gap_law.energy, gap_law.law, table, 1.0)
    samples = samples_of(law, random_places(4000))
    x = samples.places / REACH
    c = 0.1 + 0.2 * x[:, 0] - 0.1 * x[:, 1] * x[:, 2]
    by = np.stack([np.full(len(x), 0.2), -0.1 * x[:, 2], -0.1 * x[:, 1]], axis=1) / REACH
    factor = np.exp(c)
    off = replace(
        samples,
        energies=factor * samples.energies,
        moments=factor[:, None] * (samples.moments + samples.energies[:, None] * by),
    )
    coefficients = fit_correction(off, samples.energies, samples.moments, REACH)
    energies, moments = _errors(_law(table, IN_PLANE, REACH, coefficients), off)
    assert np.abs(energies).max() < 1e-3
    assert np.quantile(moments, 0.95) < 2e-3


RAYS = {"directions": [0, 15, 30, 45], "shapes": [-135, -90, -60, -45, -20, 0, 20, 45]}


@pytest.fixture(scope="module")
def pattern() -> fs.Pattern:
    return fs.named_pattern("hexagon")


@pytest.fixture(scope="module")
def sweep(pattern: fs.Pattern) -> xr.Dataset:
    return fs.tensor_sweep(pattern, **RAYS, curvatures=[0.0015 * k for k in range(17)])


@pytest.fixture(scope="module")
def model(pattern: fs.Pattern, sweep: xr.Dataset) -> fs.TensorModel:
    return fs.tensor_model(sweep, fs.gap_model(pattern))


def test_it_follows_the_samples(model: fs.TensorModel, sweep: xr.Dataset) -> None:
    energies, moments = model.errors(sweep)
    assert np.median(np.abs(energies)) < 0.005
    assert np.quantile(np.abs(energies), 0.95) < 0.03
    assert np.median(moments) < 0.02
    known = model.energy_error[np.isfinite(model.energy_error)]
    assert np.sort(known) == pytest.approx(np.sort(energies), rel=1e-9)
    # Rays that a fit has not seen are harder, and their errors are told.
    assert (model.held_out_error[0, :, 0] > 0.0).all()
    assert "held out" in repr(model)


def test_it_is_a_dataset_and_back(model: fs.TensorModel) -> None:
    again = fs.TensorModel.from_dataset(model.to_dataset())
    tensor = np.array([[0.012, 0.004], [0.004, -0.008]])
    assert again.tensor_energy(tensor) == model.tensor_energy(tensor)
    assert np.array_equal(again.energy_error, model.energy_error, equal_nan=True)
    assert again.labels == model.labels
    assert repr(again) == repr(model)


def test_curvatures_beyond_the_data_are_told(
    model: fs.TensorModel, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.WARNING):
        model.tensor_energy(np.diag([0.017, 0.016]))
    assert not caplog.records
    with caplog.at_level(logging.WARNING):
        model.tensor_energy(np.diag([0.02, 0.02]))
    assert "0.02828 mm-1, but the law was fitted up to 0.024 mm-1" in caplog.text


def test_other_cells_and_sheets_that_are_held_are_refused(
    pattern: fs.Pattern, sweep: xr.Dataset
) -> None:
    other = fs.gap_model(fs.named_pattern("square"))
    with pytest.raises(BadInputError, match=r"take fs\.gap_model of the pattern"):
        fs.tensor_model(sweep, other)
    rays = {"directions": [0.0], "shapes": [0.0, 45.0], "curvatures": [0.0, 0.001]}
    held = fs.tensor_sweep(pattern, **rays, in_plane="held")
    with pytest.raises(BadInputError, match="in_plane='free'"):
        fs.tensor_model(held, fs.gap_model(pattern))
    with pytest.raises(BadInputError, match="needs 100 converged samples"):
        fs.tensor_model(sweep.isel(curvature=[0, 1], shape=[0, 1]), fs.gap_model(pattern))
    with pytest.raises(BadInputError, match=r"fs\.gap_model makes it"):
        fs.tensor_model(sweep, sweep)


@pytest.mark.parametrize(
    ("name", "change", "said"),
    [
        ("correction", np.nan, "not finite"),
        ("held_out_error", -1.0, "must not be negative"),
        ("softening", -1.0, "below 0"),
        ("largest_curvature", 0.0, "must be above 0"),
    ],
)
def test_values_that_cannot_be_are_refused(
    model: fs.TensorModel, name: str, change: float, said: str
) -> None:
    wrong = model.to_dataset()
    wrong[name] = xr.full_like(wrong[name], change)
    with pytest.raises(SchemaError, match=said):
        fs.TensorModel.from_dataset(wrong)


def test_a_pattern_whose_scales_never_meet_has_no_gaps() -> None:
    none = FlatContact(np.zeros(0), np.zeros((0, 3)), np.zeros((0, 0)))
    law = SheetLaw(
        gap_law.energy, gap_law.law, gap_table(ClosingGaps(none, np.zeros((0, 3, 3)), 0.4)), 1.0
    )
    samples = samples_of(law, random_places(300))
    found = fit_gaps(none, TANGENT, samples)
    assert found.softening == pytest.approx(0.4, rel=1e-4)

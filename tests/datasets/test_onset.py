"""How gradually contact sets in: sudden and gradual curves with known answers."""

from __future__ import annotations

import numpy as np
import pytest

from flexscale.datasets.kinds.sweep import build_sweep_dataset
from flexscale.datasets.onset import contact_onset
from flexscale.errors import MissingDataError
from tests.datasets.dataset_samples import SCALARS, sweep, sweep_arrays

KAPPA = np.linspace(0.0, 0.03, 31)
A, B = 10.0, 1000.0


def curve(begin: float, end: float) -> np.ndarray:
    """Moment whose slope rises linearly from A to B between two curvatures."""
    fine = np.linspace(0.0, 0.03, 30001)
    share = np.clip((fine - begin) / max(end - begin, 1e-9), 0.0, 1.0)
    slope = A + (B - A) * share
    moment = np.concatenate([[0.0], np.cumsum(0.5 * (slope[1:] + slope[:-1]) * np.diff(fine))])
    return np.interp(KAPPA, fine, moment)


def dataset(moments: np.ndarray, touching_from: float):
    shape = (2, 1, len(KAPPA))
    arrays = sweep_arrays(shape, KAPPA)
    arrays["moment"] = np.broadcast_to(moments, shape).copy()
    arrays["contact_pairs"] = np.broadcast_to(np.where(touching_from <= KAPPA, 5, 0), shape).copy()
    arrays["contact_pairs"][1] = 0
    arrays["energy_density_contact"] = np.zeros(shape)
    arrays["min_gap"] = np.full(shape, 0.1)
    arrays["contact_force"] = np.zeros(shape)
    return build_sweep_dataset(
        ["closing", "opening"], [0.0], KAPPA, arrays, scalars=SCALARS, config={}
    )


def test_sudden_onset_is_as_wide_as_the_samples_apart():
    found = contact_onset(dataset(curve(0.0105, 0.0105), 0.011)).sel(side="closing", direction=0.0)
    assert found.free_until == pytest.approx(0.010)
    assert found.touches_from == pytest.approx(0.011)
    assert 0.5 * (found.onset_begin + found.onset_end) == pytest.approx(0.0105, abs=0.0005)
    assert found.onset_spread <= found.onset_resolution
    assert found.onset_resolution == pytest.approx(0.8 * 0.002 / 0.0105, rel=0.1)


def test_gradual_onset_is_measured():
    found = contact_onset(dataset(curve(0.01, 0.02), 0.011)).sel(side="closing", direction=0.0)
    assert found.onset_begin == pytest.approx(0.011, abs=3e-4)
    assert found.onset_end == pytest.approx(0.019, abs=3e-4)
    assert found.onset_spread == pytest.approx(0.008 / 0.015, rel=0.05)
    assert found.onset_spread > 4.0 * found.onset_resolution


def test_a_sweep_of_which_nothing_converged_has_no_onset():
    moments = np.full(len(KAPPA), np.nan)
    failed = dataset(moments, 0.011)
    failed["min_gap"] = failed["min_gap"] * np.nan
    failed["contact_pairs"] = 0 * failed["contact_pairs"]
    found = contact_onset(failed)
    assert all(np.isnan(found[name]).all() for name in found.data_vars)


def test_nothing_without_touching():
    found = contact_onset(dataset(curve(0.0105, 0.0105), 0.011)).sel(side="opening", direction=0.0)
    assert all(np.isnan(found[name]) for name in found.data_vars)


def test_sweeps_without_contact_are_refused():
    with pytest.raises(MissingDataError, match="without contact"):
        contact_onset(sweep())  # as `build_sweep_dataset` leaves it: no distances


def test_units_everywhere():
    found = contact_onset(dataset(curve(0.01, 0.02), 0.011))
    assert all(found[name].attrs["units"] in ("mm-1", "1") for name in found.data_vars)

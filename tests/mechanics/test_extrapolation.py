"""Whatever asks a law beyond the curvatures it was fitted to gets one warning, and its number."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import flexscale as fs
from tests.macro.fit_samples import law_sweep, tangent
from tests.macro.test_gap_law import contact
from tests.macro.test_gap_law import model as gaps_of

MODELS = {
    "MacroModel": lambda: fs.fit(law_sweep(), tangent()),
    "GapModel": lambda: gaps_of(contact()),
}


def turned(curvature: float) -> np.ndarray:
    """Bending in a direction, of which no entry of the tensor is as large as the curvature."""
    n = np.array([np.cos(0.6), np.sin(0.6)])
    return curvature * np.outer(n, n)


QUESTIONS: dict[str, Callable[[Any, float], Any]] = {
    "moment": lambda model, kappa: model.moment([0.5 * kappa, kappa], [[10.0], [40.0]]),
    "energy": lambda model, kappa: model.energy(kappa, 30.0),
    "tensor_moment": lambda model, kappa: model.tensor_moment(turned(-kappa)),
    "tensor_energy": lambda model, kappa: model.tensor_energy(turned(kappa)),
}


@pytest.fixture(scope="module", params=MODELS)
def model(request: pytest.FixtureRequest) -> Any:
    return MODELS[request.param]()


@pytest.mark.parametrize("name", QUESTIONS)
def test_beyond_its_data_a_law_warns_once(
    model: Any, name: str, caplog: pytest.LogCaptureFixture
) -> None:
    limit = model.largest_curvature
    with caplog.at_level(logging.WARNING):
        assert np.isfinite(QUESTIONS[name](model, limit)).all()
        assert not caplog.records, "the last curvature of the data is no extrapolation"
        assert np.isfinite(QUESTIONS[name](model, 1.1 * limit)).all()
    assert len(caplog.records) == 1
    assert f"up to {1.1 * limit:.4g} mm-1" in caplog.text
    assert f"fitted up to {limit:.4g} mm-1: what lies beyond is extrapolated" in caplog.text

"""Sheets of a fitted macro model between end strips."""

from __future__ import annotations

import logging

import pytest

import flexscale as fs
from flexscale.errors import BadInputError
from flexscale.status import SolveStatus
from tests.macro.fit_samples import law_sweep, tangent

OPTIONS = fs.SheetOptions(size=6.0)


@pytest.fixture(scope="module")
def model():
    return fs.fit(law_sweep(), tangent())


@pytest.mark.parametrize(("curvature", "direction"), [(0.006, 0.0), (0.016, 60.0), (-0.012, 20.0)])
def test_wide_sheets_have_the_energy_of_the_law(model, curvature, direction):
    """Only within some mm of the free edges does a sheet leave the cylinder and save energy: what
    is missing to the law's energy density falls as 1 / width."""
    side = "closing" if curvature > 0.0 else "opening"
    law, missing = model.energy(abs(curvature), direction, side), []
    for width in (60.0, 180.0):
        sheet = fs.simulate_sheet(
            model, length=60.0, width=width, curvature=curvature, direction=direction,
            options=OPTIONS,
        )  # fmt: skip
        assert sheet.status == SolveStatus.converged
        missing.append(1.0 - sheet.energy_density / law)
    assert 0.0 < missing[1] < 0.1
    assert missing[0] / missing[1] == pytest.approx(3.0, rel=0.2)


def test_a_sheet_bent_beyond_the_sweep_warns_once(model, caplog):
    with caplog.at_level(logging.WARNING):
        fs.simulate_sheet(model, length=60.0, width=30.0, curvature=0.022, options=OPTIONS)
    assert len(caplog.records) == 1
    assert "fitted up to 0.02" in caplog.text


def test_a_model_without_in_plane_stiffness_is_refused():
    paper = fs.fit(law_sweep(), variant="paper")
    with pytest.raises(BadInputError, match="in-plane stiffness"):
        fs.simulate_sheet(paper, length=60.0, width=30.0, curvature=0.01)

"""Stored datasets computed again from their recipes."""

from __future__ import annotations

import dataclasses
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import flexscale as fs
from flexscale.cli import main
from flexscale.datasets.store import Entry, Store
from flexscale.errors import MissingDataError
from flexscale.status import SolveStatus
from flexscale.steps.catalog import STEPS
from flexscale.steps.recompute import recompute, relative_differences
from flexscale.steps.step import Resources
from tests.macro.fit_samples import law_sweep, tangent

CELL = {"pattern": fs.Pattern(fs.Tiling("IH20")).to_config(), "mesh": {}}
SHEET = CELL | {
    "length": 60.0, "width": 30.0, "curvatures": [0.0, 0.01], "direction": 0.0,
    "sides": ["closing"], "size": 15.0,
}  # fmt: skip
FIT = CELL | {"weighting": "relative", "variant": "tangent", "w_biaxial": None}


@pytest.fixture
def stored(tmp_path: Path) -> Entry:
    """A sheet, and the fit that it is of."""
    store, step = Store(tmp_path), STEPS["sheet"]
    model = fs.fit(law_sweep(), tangent())
    fit = store.publish(model.to_dataset(), "fit", STEPS["fit"].recipe(FIT))
    sheet = step.compute(step.task(SHEET), {"fit": store.load(fit)}, Resources())
    return store.publish(sheet, "sheet", step.recipe(SHEET), [fit])


def test_the_same_code_gives_the_same_digest(stored: Entry, tmp_path: Path) -> None:
    found = recompute(stored, fs.open_registry(tmp_path))
    assert found.same
    assert found.close
    assert found.differences == {}
    assert found.version == found.stored_version == STEPS["sheet"].version


def test_changed_numbers_are_told_apart_from_rounding(tmp_path: Path, stored: Entry) -> None:
    sheet = Store(tmp_path).load(stored)
    rounded = sheet.copy(deep=True)
    rounded["energy"].values *= 1.0 + 1e-12
    rounded["newton_iterations"].values[0, 1] += 1
    found = relative_differences(rounded, sheet)
    assert set(found) == {"energy", "newton_iterations"}
    assert found["energy"] == pytest.approx(1e-12, rel=1e-3)
    changed = sheet.copy(deep=True)
    changed["moment"].values[0, 1] *= 1.01
    assert relative_differences(changed, sheet) == {"moment": pytest.approx(0.01)}
    lost = sheet.copy(deep=True)
    lost["slide"].values[0, 1] = np.nan
    assert relative_differences(lost, sheet) == {"slide": np.inf}
    stalled = sheet.copy(deep=True)
    stalled["status"].values[0, 1] = SolveStatus.stalled
    assert relative_differences(stalled, sheet) == {"status": np.inf}
    assert relative_differences(sheet.drop_vars("slide"), sheet) == {"slide": np.inf}


def call(monkeypatch: pytest.MonkeyPatch, *arguments: object) -> int:
    monkeypatch.setattr(sys, "argv", ["flexscale", *map(str, arguments)])
    with pytest.raises(SystemExit) as caught:
        main.main()
    return int(caught.value.code or 0)


def test_the_command_says_how_much_numbers_have_changed(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    stored: Entry,
    tmp_path: Path,
) -> None:
    assert call(monkeypatch, "data", "recompute", stored.id, "--results", tmp_path) == 0
    assert "same content, digest" in capsys.readouterr().out
    step = STEPS["sheet"]
    compute = step.compute

    def stiffer(*given: object) -> object:
        sheet = compute(*given)
        sheet["energy"].values *= 1.0 + factor
        return sheet

    monkeypatch.setitem(STEPS, "sheet", replace(step, compute=stiffer))
    factor = 1e-9
    assert call(monkeypatch, "data", "recompute", stored.id, "--results", tmp_path) == 0
    said = capsys.readouterr().out
    assert "same within the solver's tolerance" in said
    assert "energy                       differs by 1e-09 of its largest value" in said
    factor = 0.02
    assert call(monkeypatch, "data", "recompute", stored.id, "--results", tmp_path) == 4
    said = capsys.readouterr()
    assert "other numbers" in said.out
    assert "differs by 0.02 of its largest value" in said.out
    assert f"flexscale data show {stored.id}" in said.err


def test_a_dataset_without_its_inputs_is_refused(stored: Entry, tmp_path: Path) -> None:
    alone = fs.open_registry(tmp_path)
    alone._entries = tuple(entry for entry in alone if entry.kind == "sheet")
    with pytest.raises(MissingDataError, match="fit:"):
        recompute(stored, alone)


@pytest.mark.parametrize("kind", ["cell", "fit"])
def test_shipped_datasets_come_out_again(kind: str, shipped_results: Path) -> None:
    """To the last bit on the machine that made them; sums may be rounded otherwise elsewhere."""
    registry = fs.open_registry(shipped_results)
    entry = registry.find(kind=kind, pattern="square").one()
    found = recompute(entry, registry)
    assert found.close, found.differences
    assert found.version == found.stored_version


@pytest.mark.slow
def test_a_shipped_stiffness_comes_out_again(shipped_results: Path) -> None:
    """A linear problem: rounding is all that machines and versions may differ by."""
    registry = fs.open_registry(shipped_results)
    found = recompute(registry.find(kind="tangent", pattern="square").one(), registry)
    assert max(found.differences.values(), default=0.0) < 1e-9


def test_noise_does_not_count(stored: Entry, tmp_path: Path) -> None:
    found = recompute(stored, fs.open_registry(tmp_path))
    noisy = dataclasses.replace(found, same=False, differences={"residual_norm": 0.9})
    assert noisy.close
    assert not dataclasses.replace(noisy, differences={"moment": 0.9}).close


def test_sines_that_symmetry_makes_zero_are_measured_against_the_cosines() -> None:
    """Their own largest value is rounding, of which any other rounding is a large part."""
    stored = xr.Dataset(
        {"cos_coefficient": ("order", [10.0, 2.0]), "sin_coefficient": ("order", [0.0, 1e-12])}
    )
    rounded = stored.assign(sin_coefficient=("order", [0.0, -1e-12]))
    assert relative_differences(rounded, stored) == {"sin_coefficient": pytest.approx(2e-13)}
    skew = stored.assign(sin_coefficient=("order", [0.0, 0.1]))
    assert relative_differences(skew, stored) == {"sin_coefficient": pytest.approx(0.01)}

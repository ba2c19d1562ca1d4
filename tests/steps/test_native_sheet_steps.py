"""Steps of sheets and testing devices of scales: datasets, progress, checkpoints, failures."""

from __future__ import annotations

from collections.abc import Callable
from itertools import takewhile
from typing import Any

import numpy as np
import pytest
import xarray as xr

import flexscale as fs
from flexscale.datasets.checks import check_dataset
from flexscale.errors import SchemaError
from flexscale.plotting.style import NATIVE_COLOR
from flexscale.sides import SIDES
from flexscale.status import SolveStatus
from flexscale.steps.catalog import STEPS
from flexscale.steps.step import Resources
from flexscale.steps.summary import failed_samples
from tests.steps.experiment_samples import NATIVE, plan_of


def test_whole_sheets_of_scales_need_no_fit() -> None:
    jobs = {job.step: job for job in plan_of(NATIVE)}
    assert "fit" not in jobs
    assert jobs["native_sheet"].n_samples == 2
    assert jobs["native_rig"].n_samples == 3 + 2
    block = STEPS["native_rig"].task(jobs["native_rig"].recipe.parameters).block
    assert block.stage.shortenings == (0.1, 0.5)
    assert (block.mandrel.hub, block.mandrel.indentation) == (10.0, 2.0)
    assert jobs["native_turned_sheet"].n_samples == 2 * 3
    assert all(STEPS[name].resumable for name in NAMES)


class Kept:
    """A checkpoint in memory."""

    def __init__(self) -> None:
        self.lines: dict[str, list[dict[str, Any]]] = {}

    def load(self, key: str, fits: Callable[[int, dict[str, Any]], bool]) -> list[dict[str, Any]]:
        samples = enumerate(self.lines.get(key, []))
        return [sample for _, sample in takewhile(lambda item: fits(*item), samples)]

    def append(self, key: str, sample: dict[str, Any]) -> None:
        self.lines.setdefault(key, []).append(sample)

    @property
    def counts(self) -> dict[str, int]:
        return {key: len(samples) for key, samples in self.lines.items()}


class Stopped(Exception):
    """Stands for a kill."""


NAMES = ("native_sheet", "native_turned_sheet", "native_rig")
#: Samples that are kept of the turned sheets and of the disc, by their lines.
TURNED = {f"sheet-{direction}-{side}-0.0": 1 for direction in (0.0, 45.0, 60.0) for side in SIDES}
del TURNED["sheet-60.0-opening-0.0"]
DISC = {"mandrel-closing-0.0": 1, "mandrel-closing-45.0": 1}


def computed(name: str, resources: Resources) -> xr.Dataset:
    """What a step makes of its block of `NATIVE`."""
    (job,) = (job for job in plan_of(NATIVE) if job.step == name)
    step = STEPS[name]
    return step.compute(step.task(job.recipe.parameters), {}, resources)


@pytest.fixture(scope="module")
def native() -> dict[str, xr.Dataset]:
    return {name: computed(name, Resources()) for name in NAMES}


def test_native_sheets_hold_what_the_simulation_gives(native) -> None:
    sheet = native["native_sheet"]
    check_dataset(sheet, "native_sheet")
    pattern = fs.Pattern(fs.Tiling("IH20"))
    alone = fs.simulate_native_sheet(pattern, 60.0, 30.0, curvatures=[0.0, 0.004], side="opening")
    assert "side" not in alone.dims
    for name in ("energy", "moment", "slide", "contact_pairs", "n_scales", "n_unknowns"):
        np.testing.assert_allclose(sheet[name].squeeze(), alone[name], rtol=1e-9)
    np.testing.assert_allclose(sheet["energy"], 60.0 * 30.0 * sheet["energy_density"])
    assert (sheet["moment"].isel(curvature=1) > 0.0).all()
    assert float(sheet["signed_curvature"].isel(curvature=1).squeeze()) == -0.004


def test_native_turned_sheets_hold_what_the_simulations_give(native) -> None:
    turned = native["native_turned_sheet"]
    check_dataset(turned, "native_turned_sheet")
    assert turned["energy"].dims == ("side", "direction")
    pattern = fs.Pattern(fs.Tiling("IH20"))
    alone = fs.simulate_native_sheet(
        pattern, 60.0, 30.0, curvatures=[0.004], direction=45.0, side="opening"
    ).squeeze()
    one = turned.sel(side="opening", direction=45.0)
    for name in ("energy", "moment", "slide", "min_gap", "n_scales", "n_unknowns", "status"):
        np.testing.assert_allclose(one[name], alone[name], rtol=1e-9, err_msg=name)
    assert turned["signed_curvature"].values.tolist() == [0.004, -0.004]
    # Hexagons are the same every 60 degree, and not every 45.
    energy = turned["energy"].sel(side="closing")
    assert float(energy.sel(direction=60.0)) == pytest.approx(float(energy[0]), rel=1e-6)
    assert float(energy.sel(direction=45.0)) != pytest.approx(float(energy[0]), rel=1e-3)


def test_native_turned_sheets_refuse_other_values(native) -> None:
    turned = native["native_turned_sheet"]
    with pytest.raises(SchemaError, match="strictly increasing"):
        check_dataset(turned.isel(direction=[1, 0, 2]), "native_turned_sheet")
    flat = turned.assign_coords(curvature=turned["curvature"].copy(data=0.0))
    with pytest.raises(SchemaError, match="must be positive"):
        check_dataset(flat, "native_turned_sheet")


def test_native_rigs_hold_what_the_simulations_give(native) -> None:
    rig, pattern = native["native_rig"], fs.Pattern(fs.Tiling("IH20"))
    check_dataset(rig, "native_rig")
    sides = ("closing",)
    disc = fs.simulate_native_mandrel(
        pattern, radius=30.0, hub=10.0, indentation=2.0, angles=[0.0, 45.0, 60.0], sides=sides
    )
    strip = fs.simulate_native_stage(
        pattern, length=60.0, width=30.0, shortenings=[0.1, 0.5], direction=90.0, sides=sides
    )
    for device, alone in (("mandrel", disc), ("stage", strip)):
        names = [str(name) for name in rig.variables if str(name).startswith(device)]
        assert names == [str(name) for name in alone.variables if str(name).startswith(device)]
        for name in names:
            np.testing.assert_allclose(rig[name], alone[name], rtol=1e-9, err_msg=name)
    assert (rig["stage_force"] > 0.0).all()
    assert (rig["stage_deflection"] > 0.0).all()
    # Hexagons are the same every 60 degree, and not every 45.
    force = rig["mandrel_force"].sel(side="closing")
    assert float(force.sel(angle=60.0)) == float(force.sel(angle=0.0)) > 0.0
    assert float(force.sel(angle=45.0)) != pytest.approx(float(force.sel(angle=0.0)), rel=1e-3)


def test_figures_show_sheets_of_scales(native) -> None:
    (axes,) = fs.plot.sheet(native["native_sheet"]).axes
    assert "native model" in axes.get_title()
    figure = fs.plot.rig(native["native_rig"])
    disc, stage = figure.axes
    (legend,) = figure.legends
    assert legend.get_title().get_text() == "scales on joints"
    assert {line.get_color() for line in (disc.lines[0], stage.lines[0])} == {NATIVE_COLOR}
    assert "mandrel, 2 mm" in disc.get_title()
    force = native["native_rig"]["stage_force"].sel(side="closing")
    np.testing.assert_allclose(stage.lines[0].get_ydata(), force)


def test_sheets_of_scales_tell_every_sample_that_they_finish(native) -> None:
    events: list[Any] = []
    computed("native_sheet", Resources(on_sample=events.append))
    told = [(event.done, event.total, event.side, event.curvature) for event in events]
    assert told == [(1, 2, "opening", 0.0), (2, 2, "opening", 0.004)]
    events.clear()
    computed("native_turned_sheet", Resources(on_sample=events.append))
    told = [(event.done, event.total, event.side, event.direction) for event in events]
    places = [(side, direction) for direction in (0.0, 45.0, 60.0) for side in SIDES]
    assert told == [(k + 1, 6, *place) for k, place in enumerate(places)]
    assert [event.seconds for event in events] == sorted(event.seconds for event in events)
    events.clear()
    computed("native_rig", Resources(on_sample=events.append))
    assert [event.done for event in events] == [1, 2, 3, 4, 5]
    assert {(event.total, event.n_failed, event.side) for event in events} == {(5, 0, "closing")}
    assert sorted(event.place for event in events[:3]) == [0.0, 45.0, 60.0]
    assert [event.place for event in events[3:]] == [0.1, 0.5]
    assert all(event.status == SolveStatus.converged for event in events)


@pytest.mark.parametrize(
    ("name", "before", "after"),
    [
        ("native_sheet", {"opening-0.0": 1}, {"opening-0.0": 2}),
        ("native_turned_sheet", TURNED, TURNED | {"sheet-60.0-opening-0.0": 1}),
        ("native_rig", DISC | {"stage-closing": 1}, DISC | {"stage-closing": 2}),
    ],
)
def test_sheets_of_scales_go_on_where_they_were_stopped(
    native, name: str, before: dict[str, int], after: dict[str, int]
) -> None:
    """To the last bit, and without solving again what was kept."""
    kept = Kept()

    def stop(event: Any) -> None:
        if event.done == event.total - 1:
            raise Stopped

    with pytest.raises(Stopped):
        computed(name, Resources(checkpoint=kept, on_sample=stop))
    assert kept.counts == before
    again = computed(name, Resources(checkpoint=kept))
    assert kept.counts == after
    xr.testing.assert_equal(again, native[name])


@pytest.mark.parametrize("name", NAMES)
def test_samples_that_are_not_of_the_sheet_are_solved_again(native, name: str) -> None:
    kept = Kept()
    computed(name, Resources(checkpoint=kept))
    number = kept.counts
    for samples in kept.lines.values():
        samples[-1] = samples[-1] | {"energy": 1e3, "force": 1e3, "state": np.zeros(7)}
    again = computed(name, Resources(checkpoint=kept))
    assert kept.counts == {key: count + 1 for key, count in number.items()}
    xr.testing.assert_equal(again, native[name])


def simulated(device: str, model: fs.NativeModel) -> xr.Dataset:
    """A sheet of 60 x 30 mm, a strip as large, or a disc of 30 mm."""
    pattern = fs.Pattern(fs.Tiling("IH20"))
    if device == "sheet":
        return fs.simulate_native_sheet(pattern, 60.0, 30.0, curvatures=[0.0, 0.004], model=model)
    if device == "stage":
        return fs.simulate_native_stage(
            pattern, length=60.0, width=30.0, shortenings=[0.1, 0.5], model=model
        )
    return fs.simulate_native_mandrel(
        pattern, radius=30.0, indentation=2.0, angles=[0.0, 45.0], model=model
    )


@pytest.mark.parametrize(("device", "n_failed"), [("sheet", 2), ("mandrel", 4), ("stage", 4)])
def test_sheets_of_scales_that_fail_keep_their_status(device: str, n_failed: int) -> None:
    found = simulated(device, fs.NativeModel(solver=fs.SolverOptions(max_iterations=1)))
    check_dataset(found, "native_sheet" if device == "sheet" else "native_rig")
    failed = failed_samples(found)
    assert len(failed) == n_failed
    assert "max_iterations" in failed[0].replace(" ", "_")


@pytest.mark.parametrize("device", ["sheet", "mandrel", "stage"])
def test_sheets_of_scales_without_contact_have_no_gaps(device: str) -> None:
    found = simulated(device, fs.NativeModel().without_contact)
    check_dataset(found, "native_sheet" if device == "sheet" else "native_rig")
    name = "min_gap" if device == "sheet" else f"{device}_min_gap"
    assert found[name].isnull().all()
    assert "not modeled" in found[name].attrs["comment"]
    assert not failed_samples(found)

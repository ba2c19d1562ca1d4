"""Jobs in a process of their own: what is lent to a step."""

from __future__ import annotations

import time
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import xarray as xr

from flexscale.datasets.store import Entry, Store
from flexscale.steps.catalog import STEPS
from flexscale.steps.events import EventWriter
from flexscale.steps.experiment import parse_experiment
from flexscale.steps.plan import Job, Plan, build_plan
from flexscale.steps.worker import run_job
from tests.macro.fit_samples import law_sweep


def native_sheet_job(store: Store) -> tuple[Plan, Job, list[Entry]]:
    """A job whose computation tests put another in place of, and its input, which is stored."""
    content = {"patterns": {"square": {"family": "IH76"}}, "native_sheet": {}}
    plan = build_plan(parse_experiment(content, "file.yaml"))
    (job,) = (job for job in plan if job.step == "native_sheet")
    for needed in job.inputs:
        run_job(plan, plan[needed], store, 1, EventWriter(None))
    stored = plan.needed_for(job).stored(store)
    return plan, job, [stored[needed] for needed in job.inputs]


def computed_by(monkeypatch: pytest.MonkeyPatch, step: str, compute: Any) -> None:
    """Let something else do the work of a step."""
    monkeypatch.setitem(STEPS, step, replace(STEPS[step], compute=compute))


class Stopped(Exception):
    """Stands for a kill."""


def test_a_native_sheet_goes_on_from_the_samples_it_has_kept(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    plan, job, _ = native_sheet_job(Store(tmp_path))
    seen: list[list[dict[str, Any]]] = []

    def one_sample(parameters: object, inputs: object, resources: Any) -> None:
        seen.append(resources.checkpoint.load("closing-0"))
        resources.checkpoint.append("closing-0", {"energy": 1.0})
        raise Stopped

    computed_by(monkeypatch, "native_sheet", one_sample)
    for _ in range(2):
        with pytest.raises(Stopped):
            run_job(plan, job, Store(tmp_path), 1, EventWriter(None))
    assert seen == [[], [{"energy": 1.0}]]


class StoppingWriter(EventWriter):
    """Ends the process, as it were, when so many samples are finished."""

    def __init__(self, last: int) -> None:
        super().__init__(None)
        self.last = last
        self.places: list[tuple[str, float, str]] = []

    def write(self, event: str, job: str, **facts: Any) -> None:
        if event == "sample":
            self.places.append((facts["device"], facts["place"], facts["unit"]))
            if facts["done"] == self.last:
                raise Stopped


def test_a_rig_of_scales_goes_on_to_the_last_bit(tmp_path: Path) -> None:
    """Samples that were kept in a file are as good as those of one run."""
    content = {
        "patterns": {"hexagon": {"family": "IH20"}},
        "native_rig": {
            "sides": "closing",
            "mandrel": {"radius": 30, "indentation": 2, "angles": [0, 45]},
            "stage": {"length": 60, "width": 30, "shortenings": [0.1, 0.5, 1.0]},
        },
    }
    plan = build_plan(parse_experiment(content, "file.yaml"))
    (job,) = (job for job in plan if job.step == "native_rig")
    assert job.n_samples == 5
    digests, writers = [], []
    for name, ends in (("once", [0]), ("stopped", [1, 4, 0])):
        store = Store(tmp_path / name)
        for needed in plan.needed_for(job):
            run_job(plan, needed, store, 1, EventWriter(None))
        for last in ends:
            writers.append(StoppingWriter(last))
            with pytest.raises(Stopped) if last else nullcontext():
                run_job(plan, job, store, 1, writers[-1])
        entry = plan.stored(store)[job.id]
        digests.append(entry.content_digest)
        assert store.record(entry)["run"]["resumed"] == (name == "stopped")
    assert digests[0] == digests[1]
    places = [("mandrel", 0.0, "degree"), ("mandrel", 45.0, "degree")]
    places += [("stage", shortening, "mm") for shortening in (0.1, 0.5, 1.0)]
    assert [writer.places for writer in writers] == [places, places[:1], places[:4], places]


def test_records_have_the_processor_time_of_the_step(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Not the time in which the job waited."""
    store = Store(tmp_path)
    plan, job, inputs = native_sheet_job(store)
    records: list[dict[str, Any]] = []

    def busy(parameters: object, inputs: object, resources: object) -> xr.Dataset:
        end = time.process_time() + 0.3
        while time.process_time() < end:
            pass
        time.sleep(0.5)
        return law_sweep()

    def publish(store: Store, *facts: Any) -> Entry:
        records.append(facts[-1])
        return Entry("native_sheet", "0" * 64, "0" * 64, tmp_path, {})

    computed_by(monkeypatch, "native_sheet", busy)
    monkeypatch.setattr(Store, "publish", publish)
    run_job(plan, job, store, 1, EventWriter(None))
    store.checkpoint(job.recipe, inputs).append("closing-0", {"energy": 1.0})
    run_job(plan, job, store, 1, EventWriter(None))
    assert records[1]["resumed"]
    assert not records[0]["resumed"]
    assert 0.3 <= records[0]["cpu_seconds"] <= records[0]["wall_seconds"] - 0.5 + 0.01  # roundings

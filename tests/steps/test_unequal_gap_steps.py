"""Patterns of unequal gaps in experiments: fields, a law for every gap, datasets of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import flexscale as fs
from flexscale.datasets.registry import open_registry
from flexscale.datasets.store import Store
from flexscale.errors import BadInputError
from flexscale.steps.events import EventWriter
from flexscale.steps.experiment import parse_experiment
from flexscale.steps.plan import Plan, build_plan
from flexscale.steps.recompute import recompute
from flexscale.steps.worker import run_job

TILES = [[[x, 0], [x + 10, 0], [x + 10, 10], [x, 10]] for x in (0, 10)]


def content(gap: object, **blocks: Any) -> dict[str, Any]:
    pattern = {"tiles": TILES, "lattice": [[20, 0], [0, 10]], "gap": gap}
    return {"patterns": {"pair": pattern}} | blocks


def plan_of(gap: object, **blocks: Any) -> Plan:
    return build_plan(parse_experiment(content(gap, **blocks), "file.yaml"))


def test_every_gap_of_joints_has_its_law() -> None:
    plan = plan_of([0.4, "800 um"], tangent={}, figures=["tangent", "joint"], joint={})
    joints = [job for job in plan if job.step == "joint"]
    assert [job.recipe.parameters["gap"] for job in joints] == [0.4, 0.6, 0.8]
    assert joints[0].recipe.parameters["pattern"]["gap"] == [0.4, 0.8]
    (tangent,) = (job for job in plan if job.step == "tangent")
    assert set(tangent.inputs) == {job.id for job in joints}
    assert sum(job.title == "joint" and job.step == "figure" for job in plan) == 3
    assert len({job.id for job in plan}) == len(plan.jobs)


def test_one_gap_has_the_recipes_it_had() -> None:
    one, listed = plan_of(0.4, tangent={}), plan_of([0.4, 0.4], tangent={})
    assert [job.id for job in one] == [job.id for job in listed]
    assert "gap" not in one.jobs[0].recipe.parameters
    assert one.jobs[0].recipe.parameters["pattern"]["gap"] == 0.4


def test_datasets_are_made_of_all_laws(tmp_path: Path) -> None:
    plan, store = plan_of([0.4, 0.8], tangent={}), Store(tmp_path)
    for job in plan:
        run_job(plan, job, store, 1, EventWriter(None))
    registry = open_registry(tmp_path)
    labels = [float(registry.load(entry)["gap"]) for entry in registry.find(kind="joint")]
    assert sorted(labels) == [0.4, 0.6, 0.8]
    found = registry.one(kind="tangent")
    assert float(found["gap"]) == 0.4
    pattern = fs.Pattern.from_polygons(np.array(TILES), [20, 0], [0, 10], gap=[0.4, 0.8], name="x")
    known = fs.tangent_stiffness(pattern).matrix
    assert found["matrix"].values == pytest.approx(known, rel=1e-9, abs=1e-9)
    (entry,) = registry.find(kind="tangent")
    assert recompute(entry, registry).same


@pytest.mark.parametrize(
    ("gap", "said"),
    [
        ([0.4], r"patterns\.pair: The gaps given are 1, but the polygons are 2"),
        ([0.4, 0], r"patterns\.pair\.gap: gap 1 is 0 mm, but must be positive"),
        ([0.4, "wide"], r"patterns\.pair\.gap: 'wide' is not a value in mm"),
        ([0.4, None], r"patterns\.pair\.gap: gap 1 must be a number in mm"),
        (None, r"patterns\.pair\.gap: gap must be a number in mm"),
        ({"start": 0.4}, r"patterns\.pair\.gap: gap must be a number in mm"),
        ([0.4, 12], r"patterns\.pair: A gap of 12 mm is too wide for tile 1"),
        ([0.4, 6], r"patterns\.pair: The gap of 3\.2 mm is wider than the scales' half width"),
    ],
)
def test_gaps_that_cannot_be_are_refused(gap: object, said: str) -> None:
    with pytest.raises(BadInputError, match=said):
        plan_of(gap, tangent={})


def test_families_take_no_list() -> None:
    given = {"patterns": {"square": {"named": "square", "gap": [0.4, 0.8]}}}
    with pytest.raises(BadInputError, match=r"patterns\.square: gap is .* a family has one gap"):
        build_plan(parse_experiment(given, "file.yaml"))


def test_one_law_alone_is_for_no_cell() -> None:
    joint = {"gap": 0.6}
    (job,) = plan_of([0.4, 0.8], joint=joint)
    assert job.recipe.parameters["gap"] == 0.6
    with pytest.raises(BadInputError, match=r"`joint` asks for the law of one gap, 0\.6 mm"):
        plan_of([0.4, 0.8], joint=joint, tangent={})
    with pytest.raises(BadInputError, match=r"have gaps of 0\.4, 0\.6, 0\.8 mm, none of 0\.5 mm"):
        plan_of([0.4, 0.8], joint={"gap": 0.5})

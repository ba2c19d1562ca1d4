"""Plans: which jobs an experiment becomes, and what makes two jobs the same."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from flexscale.datasets.store import Store
from flexscale.plotting.figure_scripts import find_scripts
from flexscale.steps.experiment import load_experiment, parse_experiment
from flexscale.steps.plan import Plan, build_plan

ROOT = Path(__file__).parents[2]
CONTENT: dict[str, Any] = {
    "patterns": {"square": {"family": "IH76"}, "hexagon": {"family": "IH20"}},
    "tangent": {},
    "sweep": {"directions": [0, 45], "curvatures": [0, 0.001, 0.002]},
    "figures": ["polar", "tangent"],
}


def plan_of(content: dict[str, Any]) -> Plan:
    return build_plan(parse_experiment(content, "file.yaml"))


def ids_of(content: dict[str, Any]) -> set[str]:
    return {job.id for job in plan_of(content)}


def test_every_pattern_gets_every_job_after_its_inputs() -> None:
    plan = plan_of(CONTENT)
    kinds = [(job.pattern, job.step, job.title) for job in plan]
    assert kinds[:5] == [
        ("square", "joint", "joint"),
        ("square", "tangent", "tangent"),
        ("square", "sweep", "sweep"),
        ("square", "figure", "polar"),
        ("square", "figure", "tangent"),
    ]
    assert len(kinds) == 10
    seen: set[str] = set()
    for job in plan:
        assert set(job.inputs) <= seen
        seen.add(job.id)


def test_sweep_counts_its_samples() -> None:
    assert [job.n_samples for job in plan_of(CONTENT) if job.step == "sweep"] == [12, 12]


def test_the_same_experiment_has_the_same_jobs() -> None:
    assert ids_of(CONTENT) == ids_of(CONTENT)


def test_a_changed_gap_changes_all_jobs_of_its_pattern_only() -> None:
    patterns = {"square": {"family": "IH76", "gap": 0.5}, "hexagon": {"family": "IH20"}}
    shared = ids_of(CONTENT) & ids_of(CONTENT | {"patterns": patterns})
    assert {job_id.split("-")[-2] for job_id in shared} == {"hexagon"}
    assert len(shared) == 5


def test_a_changed_curvature_changes_the_sweep_and_its_figure_only() -> None:
    sweep = {"directions": [0, 45], "curvatures": [0, 0.001]}
    gone = ids_of(CONTENT) - ids_of(CONTENT | {"sweep": sweep})
    assert {job_id.rsplit("-", 2)[0] for job_id in gone} == {"sweep", "figure-polar"}


def test_writing_a_unit_changes_nothing() -> None:
    patterns = {"square": {"family": "IH76", "gap": "0.04 cm"}, "hexagon": {"family": "IH20"}}
    assert ids_of(CONTENT | {"patterns": patterns}) == ids_of(CONTENT)


def test_needed_for_holds_ancestors_only() -> None:
    plan = plan_of(CONTENT)
    figure = next(job for job in plan if job.title == "polar")
    needed = [job.step for job in plan.needed_for(figure)]
    assert needed == ["joint", "sweep"]


def test_fit_comes_from_the_sweep_and_its_figures_from_both() -> None:
    directions = {"start": 0, "stop": 180, "step": 22.5}
    sweep = {"directions": directions, "curvatures": [0, 0.005, 0.01, 0.015]}
    content = CONTENT | {"sweep": sweep, "fit": {}, "figures": ["fit", "fitted_curves"]}
    plan = plan_of(content)
    for job in plan:
        if job.step == "fit":
            assert [plan[needed].step for needed in job.inputs] == ["sweep", "tangent"]
        if job.step == "figure":
            assert [plan[needed].step for needed in job.inputs] == ["fit", "sweep"]
            assert plan.needed_for(job).jobs[-1].step == "fit"
    gone = ids_of(content) - ids_of(content | {"fit": {"weighting": "absolute"}})
    assert {job_id.split("-")[0] for job_id in gone} == {"fit", "figure"}


def test_nothing_is_stored_in_an_empty_folder(tmp_path: Any) -> None:
    assert plan_of(CONTENT).stored(Store(tmp_path)) == {}
    assert list(tmp_path.iterdir()) == []


def test_the_commands_of_paper_figures_make_what_they_need() -> None:
    made: dict[str, set[tuple[str, str, str]]] = {}
    for script in find_scripts(ROOT / "paper_figures"):
        for need in script.needs.values():
            file = need.command.removeprefix("flexscale run ")
            if file not in made:
                plan = build_plan(load_experiment(ROOT / file))
                made[file] = {(job.step, job.family, job.pattern) for job in plan}
            assert (need.kind, need.where["family"], need.where["pattern"]) in made[file]
    assert made


def test_fit_brings_the_tangent_it_needs() -> None:
    """Without a block for it; what the sheet is made of does not change sweep or tangent."""
    directions = {"start": 0, "stop": 180, "step": 22.5}
    sweep = {"directions": directions, "curvatures": [0, 0.005, 0.01, 0.015]}
    content = {key: value for key, value in CONTENT.items() if key != "tangent"}
    content |= {"sweep": sweep, "fit": {}, "figures": []}
    steps = [job.step for job in plan_of(content)]
    assert steps.count("tangent") == steps.count("fit") > 0
    other = content | {"fit": {"variant": "paper", "w_biaxial": "800 N mm3"}}
    gone = ids_of(content) - ids_of(other)
    assert {job_id.split("-")[0] for job_id in gone} == {"fit"}

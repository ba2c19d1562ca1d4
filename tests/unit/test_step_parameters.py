"""What a recipe records is what was computed: every parameter of a native step is used."""

from __future__ import annotations

import importlib
from typing import Any
from unittest import mock

import pytest

from flexscale.errors import ConfigError
from flexscale.steps.base import Resources
from flexscale.steps.catalog import STEPS, NativeParameters
from flexscale.steps.experiment import parse_experiment
from flexscale.steps.plan import build_plan

CONTENT: dict[str, Any] = {
    "patterns": {"square": {"named": "square"}},
    "tangent": {"directions": [0, 45]},
    "sweep": {"directions": [0, 45], "curvatures": [0, 0.005]},
    "shapes": [{"curvature": 0.01}],
    "native_sheet": {"curvatures": [0, 0.01]},
    "native_rig": {"shortenings": [1]},
}
NATIVE_STEPS = [
    name for name, step in STEPS.items() if issubclass(step.parameters, NativeParameters)
]
#: What the steps call, by module; the rest of a step's work needs their results.
CALLED = {
    "tangent": ("CellProblem", "solve_tangent", "build_tangent_dataset", "estimate_mesh_error",
                "note_mesh_error"),
    "sweep": ("sweep",),
    "shape": ("solve_shapes",),
    "native_sheet": ("simulate_native_sheet",),
    "native_rig": ("simulate_native_stage",),
}  # fmt: skip


class Watched:
    """Parameters that remember which of their fields were read."""

    def __init__(self, parameters: NativeParameters) -> None:
        self._parameters, self.read = parameters, set[str]()

    def __getattr__(self, name: str) -> Any:
        if name in type(self._parameters).model_fields:
            self.read.add(name)
            return getattr(self._parameters, name)
        if name.startswith("build_"):  # reads fields of its own
            return getattr(type(self._parameters), name).__get__(self)
        return getattr(self._parameters, name)


@pytest.mark.parametrize("name", NATIVE_STEPS)
def test_a_native_step_reads_all_that_its_recipe_records(name: str) -> None:
    step = STEPS[name]
    (job, *_) = (job for job in build_plan(parse_experiment(CONTENT, "file")) if job.step == name)
    watched = Watched(step.parameters.model_validate(job.recipe.parameters))
    module = importlib.import_module(f"flexscale.steps.{name}")
    with mock.patch.multiple(module, **dict.fromkeys(CALLED[name], mock.DEFAULT)):
        step.compute(watched, {}, Resources())
    assert watched.read == set(step.parameters.model_fields)


@pytest.mark.parametrize("name", ["native_sheet", "native_rig"])
def test_a_bending_measure_reaches_sheets_and_stages_of_scales(name: str) -> None:
    content = CONTENT | {"substrate": {"bending_measure": "form"}}
    (job,) = (job for job in build_plan(parse_experiment(content, "file")) if job.step == name)
    parameters = STEPS[name].parameters.model_validate(job.recipe.parameters)
    module = importlib.import_module(f"flexscale.steps.{name}")
    with mock.patch.object(module, CALLED[name][0]) as simulate:
        STEPS[name].compute(parameters, {}, Resources())
    assert simulate.call_args.kwargs["substrate"].bending_measure == "form"


@pytest.mark.parametrize("name", ["native_sheet", "native_rig"])
@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"substrate": {"element": "edge_angle"}}, "smooth triangles, not 'edge_angle'"),
        ({"scales": {"model": "tets"}}, "scales of few modes, not 'tets'"),
    ],
)
def test_what_finite_sheets_do_not_compute_is_refused_when_planned(
    name: str, options: dict[str, Any], said: str
) -> None:
    content = {"patterns": CONTENT["patterns"], name: CONTENT[name], **options}
    with pytest.raises(ConfigError, match=said):
        parse_experiment(content, "file.yaml")

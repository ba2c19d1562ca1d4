"""What a recipe records is what was computed: every parameter of every step is used.

Each parameter in turn gets another value; then what the step hands to the computation changes, or
the value is refused.
"""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping
from typing import Any
from unittest import mock

import pytest
from pydantic import ValidationError

import flexscale as fs
from flexscale.datasets.recipe_values import leaves
from flexscale.errors import BadInputError, ConfigError
from flexscale.patterns.pattern import Pattern
from flexscale.steps.catalog import STEPS
from flexscale.steps.experiment import parse_experiment
from flexscale.steps.plan import build_plan
from flexscale.steps.step import Resources
from flexscale.tilings import Tiling

SQUARE: dict[str, Any] = {"patterns": {"square": {"named": "square"}}}
CONTENT: dict[str, Any] = SQUARE | {
    "native": "shell",
    "tangent": {"directions": [0, 45]},
    "sweep": {"directions": {"start": 0, "stop": 180, "step": 15},
              "curvatures": [0, 0.002, 0.004, 0.006, 0.008, 0.01]},
    "shape": [{"curvature": 0.01}],
    "fit": {"w_biaxial": 3.0},
    "gap_model": {},
    "joint": {},
    "sheet": {"curvatures": [0, 0.01]},
    "turned_sheet": {"directions": [0, 45]},
    "rig": {"mandrel": {}, "stage": {}},
}  # fmt: skip
#: Tensor sweeps and whole sheets of scales, which stand on joints.
WHOLE: dict[str, Any] = SQUARE | {
    "tensor_sweep": {"shapes": [-45, 0], "curvatures": [0, 0.01]},
    "gap_model": {},
    "tensor_model": {},
    "native_sheet": {"curvatures": [0, 0.01], "offset": [1, 2],
                     "outline": [[0, 0], [100, 0], [100, 50], [50, 40], [0, 50]]},
    "native_turned_sheet": {"directions": [0, 45]},
    "native_rig": {"mandrel": {}, "stage": {"shortenings": [1]}},
}  # fmt: skip
#: What the steps hand their parameters to; results are made up.
HOMOGENIZE, FINITE = "flexscale.homogenize", "flexscale.finite"
MACRO, SHEETS = "flexscale.macro", "flexscale.sheets"
CALLED = {
    "cell": ("flexscale.mesh.torus.build_mesh", f"{HOMOGENIZE}.labels.pattern_scalars",
             "flexscale.datasets.build.build_dataset"),
    "tangent": (f"{HOMOGENIZE}.build.build_problem",
                f"{HOMOGENIZE}.tangent.solve_tangent",
                f"{HOMOGENIZE}.errors_at_rest.note_errors",
                "flexscale.datasets.kinds.tangent.build_tangent_dataset"),
    "sweep": (f"{HOMOGENIZE}.sweep.sweep",),
    "tensor_sweep": (f"{HOMOGENIZE}.tensor_sweep.tensor_sweep",),
    "shape": (f"{HOMOGENIZE}.shape.solve_shapes",),
    "fit": (f"{MACRO}.fit.fit", "flexscale.steps.kinds.fit.dataclasses.replace"),
    "gap_model": (f"{MACRO}.gap_model.gap_model",),
    "tensor_model": (f"{MACRO}.gap_model.GapModel.from_dataset",
                     f"{MACRO}.tensor_model.tensor_model"),
    "joint": ("flexscale.joints.library.solved_joint", "flexscale.steps.kinds.joint._arrays",
              f"{HOMOGENIZE}.labels.pattern_scalars",
              "flexscale.datasets.kinds.joint.build_joint_dataset"),
    "sheet": (f"{MACRO}.model.MacroModel.from_dataset", f"{SHEETS}.bent_sheet.BendingRig",
              "flexscale.datasets.sheet_variables.build_sheet_dataset"),
    "turned_sheet": (f"{MACRO}.fit.fit", f"{SHEETS}.simulate.simulate_sheet",
                     "flexscale.datasets.sheet_variables.build_turned_dataset"),
    "rig": (f"{MACRO}.model.MacroModel.from_dataset", f"{SHEETS}.mandrel.simulate_mandrel",
            f"{SHEETS}.stage.simulate_stage",
            "flexscale.datasets.device_variables.build_rig_dataset"),
    "native_sheet": (f"{FINITE}.native_sheet_dataset.simulate_native_sheet",),
    "native_turned_sheet": (f"{FINITE}.native_turned_sheets.turn_native_sheets",),
    "native_rig": (f"{FINITE}.native_rigs.Progress", f"{FINITE}.native_rigs.mandrel_arrays",
                   f"{FINITE}.native_rigs.stage_arrays", f"{FINITE}.native_rigs.rig_dataset"),
}  # fmt: skip
#: These compute from datasets, which hold pattern and mesh; their recipes repeat them as labels.
FROM_DATASETS = ("fit", "tensor_model", "sheet", "turned_sheet", "rig")


@pytest.fixture(scope="module")
def recipes() -> dict[str, dict[str, Any]]:
    jobs = [
        job for asked in (WHOLE, CONTENT) for job in build_plan(parse_experiment(asked, "file"))
    ]
    return {job.step: dict(job.recipe.parameters) for job in jobs}


def handed_over(name: str, parameters: dict[str, Any]) -> list[str]:
    """All that a step's computation is called with, its recipe apart, as text."""
    step = STEPS[name]
    task = step.task(parameters)
    made_up: list[mock.MagicMock] = []
    patches = [mock.patch(target) for target in CALLED[name]]
    try:
        made_up = [patch.start() for patch in patches]
        for one in made_up:
            number = one.return_value
            number.configure_mock(energy=1.0, energy_density=1.0, moment=1.0, slide=1.0)
            number.configure_mock(largest_curvature=1.0, iterations=1, negative_eigenvalues=0)
            number.configure_mock(status=0, force=1.0, deflection=1.0)
            number.bend.return_value = number
        if name == "turned_sheet":
            made_up[0].return_value.energy = lambda *asked: 1.0
        inputs = dict.fromkeys(task.block.inputs, "dataset")
        step.compute(task, inputs, Resources())
        calls = [call for one in made_up for call in one.mock_calls]
    finally:
        mock.patch.stopall()
    return [_text(call) for call in calls]


def _text(call: Any) -> str:
    _, arguments, named = call
    told = {key: value for key, value in named.items() if key != "config"}
    return f"{_plain(arguments)} {_plain(told)}"


def _plain(value: Any) -> str:
    if isinstance(value, mock.NonCallableMock):
        return "made up"
    if isinstance(value, Mapping):
        return str({key: _plain(item) for key, item in value.items()})
    if isinstance(value, list | tuple):
        return str([_plain(item) for item in value])
    return str(value.to_config()) if hasattr(value, "to_config") else repr(value)


def other_values(value: Any) -> Iterator[Any]:
    """Values to take in the place of one: the first that is not refused is enough."""
    if isinstance(value, bool):
        yield not value
    elif isinstance(value, int):
        yield value + 1
    elif isinstance(value, float):
        yield from (1.01 * value if value else 0.01, 0.5 * value)
    elif isinstance(value, list):
        yield from (value[:-1], value + value[-1:], [])
    elif isinstance(value, str):
        yield from ("opening", "paper", "absolute", "another")
    else:
        yield from (3.0, "another")


def placed(parameters: dict[str, Any], name: str, value: Any) -> dict[str, Any]:
    out = copy.deepcopy(parameters)
    *outer, last = name.split(".")
    inner = out
    for key in outer:
        inner = inner[key]
    inner[last] = value
    return out


@pytest.mark.parametrize("name", STEPS)
def test_every_parameter_of_a_step_reaches_its_computation(
    name: str, recipes: dict[str, dict[str, Any]]
) -> None:
    parameters = recipes[name]
    usual = handed_over(name, parameters)
    assert usual
    assert handed_over(name, parameters) == usual  # or nothing could be told from a change
    unread = []
    for leaf, value in leaves(parameters):
        if leaf == "pattern.name" or (
            name in FROM_DATASETS and leaf.split(".")[0] in ("pattern", "mesh")
        ):
            continue
        for other in (item for item in other_values(value) if item != value):
            try:
                changed = handed_over(name, placed(parameters, leaf, other)) != usual
            except (BadInputError, ValidationError):
                continue
            if not changed:
                unread.append(leaf)
            break
    assert not unread


@pytest.mark.parametrize("name", ["native_sheet", "native_turned_sheet", "native_rig"])
@pytest.mark.parametrize("native", ["shell", "solid"])
def test_whole_sheets_of_other_native_models_are_refused_when_planned(
    name: str, native: str
) -> None:
    content = SQUARE | {"native": native, name: WHOLE[name]}
    with pytest.raises(ConfigError, match=f"on joints, not of the native model '{native}'"):
        parse_experiment(content, "file.yaml")


@pytest.mark.parametrize("native", ["joints", "shell", "solid"])
@pytest.mark.parametrize("name", STEPS)
def test_recipes_of_every_native_model_make_their_task_again(name: str, native: str) -> None:
    step, pattern = STEPS[name], Pattern(Tiling("IH76"))
    options = {"solid": fs.SolidOptions(edge=0.1)} if native == "solid" else {}
    model = fs.NativeModel(native, contact=fs.ContactOptions(activation=0.01), **options)
    asked = CONTENT | WHOLE
    block = step.block.model_validate(asked[name]) if name in asked else step.block()
    parameters = step.parameters(pattern, model, block)
    task = step.task(parameters)
    assert task.block == block
    assert step.parameters(task.pattern, task.native, task.block) == parameters
    if native == "solid" and "mesh" in parameters:
        assert task.native.solid == model.solid

"""Kind `joint`: in an experiment, to a dataset, checked, drawn."""

from __future__ import annotations

import copy

import numpy as np
import pytest
import xarray as xr

import flexscale as fs
from flexscale.datasets.checks import check_dataset
from flexscale.datasets.kinds.joint import quadratic_part
from flexscale.errors import PatternError, SchemaError
from flexscale.joints.library import joint_law
from flexscale.steps.catalog import STEPS
from flexscale.steps.experiment import parse_experiment
from flexscale.steps.plan import build_plan
from flexscale.steps.step import Resources

PATTERNS = {"patterns": {"square": {"named": "square"}}}


def made(block: dict[str, object], **sizes: object) -> xr.Dataset:
    content = copy.deepcopy(PATTERNS | {"joint": block})
    for pattern in content["patterns"].values():
        pattern.update(sizes)
    jobs = {job.step: job for job in build_plan(parse_experiment(content, ""))}
    step = STEPS["joint"]
    return step.compute(step.task(jobs["joint"].recipe.parameters), {}, Resources())


@pytest.fixture(scope="module")
def dataset() -> xr.Dataset:
    """Of the paper's joint, which ships."""
    return made({})


def test_a_dataset_holds_the_law_and_the_states(dataset: xr.Dataset) -> None:
    check_dataset(dataset, "joint")
    law = joint_law(fs.Pattern(fs.Tiling("IH76")))
    assert np.array_equal(dataset["coefficients"].values, law.coefficients)
    stiffness = dataset["stiffness"].values * law.modulus * law.thickness**2
    assert stiffness[3, 3] == pytest.approx(law.stiffness[3, 3])
    assert stiffness[0, 3] / law.thickness == pytest.approx(law.stiffness[0, 3])
    assert float(dataset["gap_ratio"]) == 1.0
    assert float(dataset["height_ratio"]) == 10.0
    assert float(dataset["modulus_ratio"]) == pytest.approx(2020.0 / 26.0, rel=1e-5)
    assert 0 < int(dataset["held_out"].sum()) < dataset.sizes["state"]
    assert dataset.nbytes < 60_000


def test_rigid_scales_and_grooves_are_other_joints(dataset: xr.Dataset) -> None:
    rigid = made({}, scale_material="RIGID")
    assert "modulus_ratio" not in rigid
    softer = float(dataset["stiffness"][0, 0])
    assert float(rigid["stiffness"][0, 0]) > softer
    grooved = made({"groove": True})
    assert float(grooved["groove_depth_ratio"]) == 0.5
    assert float(grooved["stiffness"][0, 0]) != softer


def test_the_recipe_has_no_options_of_a_native_model() -> None:
    jobs = build_plan(parse_experiment(PATTERNS | {"joint": {}}, "file"))
    (job,) = (job for job in jobs if job.step == "joint")
    assert set(job.recipe.parameters) == {"pattern", "groove"}
    assert job.inputs == ()


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("coefficients", np.nan, "not finite"),
        ("exponents", -1, "must not be negative"),
        ("highest", -1.0, "must not be empty"),
        ("force_error", -1.0, "force_error of a joint must not be negative"),
        ("stiffness", 0.0, "not the quadratic part"),
    ],
)
def test_values_that_cannot_be_are_refused(
    dataset: xr.Dataset, name: str, value: float, said: str
) -> None:
    wrong = dataset.copy(deep=True)
    wrong[name][...] = value
    if name == "stiffness":
        wrong[name] = dataset[name] + 0.01 * np.eye(4)
    with pytest.raises(SchemaError, match=said):
        check_dataset(wrong, "joint")


def test_a_stiffness_must_be_symmetric_and_positive(dataset: xr.Dataset) -> None:
    for change, said in ((np.eye(4, k=1), "symmetric"), (-np.eye(4), "positive definite")):
        wrong = dataset.copy(deep=True)
        wrong["stiffness"] = dataset["stiffness"] + change
        with pytest.raises(SchemaError, match=said):
            check_dataset(wrong, "joint")


def test_quadratic_part_of_a_polynomial() -> None:
    exponents = np.array([[2, 0, 0, 0], [1, 0, 0, 1], [0, 0, 0, 3]])
    found = quadratic_part(exponents, np.array([0.5, -0.3, 9.0]))
    assert np.array_equal(found[[0, 0, 3], [0, 3, 3]], [1.0, -0.3, 0.0])


def test_sizes_without_a_joint_are_refused_when_planned() -> None:
    content = {"patterns": {"square": {"named": "square", "substrate_thickness": 0.03}}}
    with pytest.raises(PatternError, match=r"13\.3 thicknesses"):
        build_plan(parse_experiment(content | {"joint": {}}, "file"))


def test_its_figure_has_law_and_states_in_four_panels(dataset: xr.Dataset) -> None:
    figure = fs.plot.joint(dataset)
    units = ("mm]", "mm]", "mm]", "°]")
    assert all(axes.get_xlabel().endswith(u) for axes, u in zip(figure.axes, units, strict=True))
    for place, axes in enumerate(figure.axes):
        law, states = axes.lines[:2]
        assert "[N" in axes.get_ylabel()
        x, y = (np.asarray(data, dtype=float) for data in states.get_data())
        assert len(x) >= (0 if place == 2 else 7)
        at, line = (np.asarray(data, dtype=float) for data in law.get_data())
        assert np.interp(x, at, line) == pytest.approx(y, rel=0.03, abs=0.02 * np.abs(line).max())

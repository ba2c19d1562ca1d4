"""The substrate's elements by name: refused, written down, and part of a result's identity."""

from __future__ import annotations

from typing import Any

import pytest

import flexscale as fs
from flexscale.errors import ConfigError, UnknownNameError
from flexscale.steps.catalog import STEPS
from flexscale.steps.experiment import parse_experiment
from flexscale.steps.plan import build_plan
from flexscale.steps.step import Resources

NATIVE = fs.NativeModel("shell")
CONTENT: dict[str, Any] = {
    "native": "shell",
    "patterns": {"square": {"family": "IH76"}},
    "tangent": {},
    "sweep": {"directions": [0, 45], "curvatures": [0, 0.001]},
    "shape": [{"curvature": 0.001}],
}
COARSE = fs.MeshOptions(along=2.5, corner=0.4, scale_size=4.0, scale_layers=1)


def steps_of(content: dict[str, Any]) -> dict[str, str]:
    """Step -> job id."""
    return {job.step: job.id for job in build_plan(parse_experiment(content, "file.yaml"))}


def test_unknown_element_is_refused_with_a_hint():
    with pytest.raises(UnknownNameError, match="Did you mean 'edge_angle'"):
        fs.SubstrateOptions("edge_angles")
    with pytest.raises(UnknownNameError, match=r"file\.yaml: There is no substrate element 'C2'"):
        parse_experiment(CONTENT | {"substrate": {"element": "C2"}}, "file.yaml")


def test_bending_measures_are_for_c1_triangles():
    assert fs.SubstrateOptions(bending_measure="turn").to_config()["bending_measure"] == "turn"
    with pytest.raises(UnknownNameError, match="no bending measure 'shape'"):
        fs.SubstrateOptions(bending_measure="shape")
    with pytest.raises(ConfigError, match="'edge_angle' has its own"):
        fs.SubstrateOptions("edge_angle", bending_measure="turn")


def test_options_come_back_from_their_config():
    options = fs.SubstrateOptions("edge_angle")
    assert fs.SubstrateOptions(**options.to_config()) == options
    assert options.to_config() == {"element": "edge_angle"}  # it has no choice of measure
    assert fs.SubstrateOptions().bending_measure == "layers"


def test_another_element_is_another_result_of_all_but_the_cell():
    before, after = steps_of(CONTENT), steps_of(CONTENT | {"substrate": {"element": "edge_angle"}})
    assert {step for step in before if before[step] != after[step]} == {"tangent", "sweep", "shape"}


def test_naming_the_default_changes_no_identity():
    assert steps_of(CONTENT | {"substrate": {"element": "c1"}}) == steps_of(CONTENT)
    step, pattern = STEPS["tangent"], fs.Pattern(fs.Tiling("IH76"))
    block = step.block(directions=(0.0,))
    recipe = step.recipe(
        step.parameters(pattern, fs.NativeModel("shell", mesh=COARSE), block)
    ).parameters
    assert recipe["substrate"] == fs.SubstrateOptions().to_config()
    assert recipe["scales"] == fs.ScaleOptions().to_config()
    assert "contact" not in recipe
    assert (
        step.task({"native": "shell", "pattern": pattern.to_config(), "directions": [0.0]}).native
        == NATIVE
    )


def test_steps_compute_with_the_element_they_name():
    """The dataset of the step is that of the function, and says which element it is from."""
    pattern, options = fs.Pattern(fs.Tiling("IH76")), fs.SubstrateOptions("edge_angle")
    step = STEPS["tangent"]
    parameters = step.task(
        {
            "native": "shell",
            "pattern": pattern.to_config(),
            "mesh": COARSE.to_config(),
            "directions": [45.0],
            "substrate": options.to_config(),
        }
    )
    data = step.compute(parameters, {}, Resources())
    expected = fs.tangent_stiffness(
        pattern, model=fs.NativeModel("shell", mesh=COARSE, substrate=options)
    ).stiffness(45.0)
    assert float(data.stiffness[0]) == pytest.approx(expected, rel=1e-12)
    assert '"edge_angle"' in data.attrs["flexscale_config"]

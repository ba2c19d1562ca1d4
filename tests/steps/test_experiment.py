"""Experiment files: units, unknown keys, and everything refused before a solve."""

from __future__ import annotations

import copy
import inspect
import json
from pathlib import Path
from typing import Any

import pytest
import yaml

from flexscale.errors import BadInputError, ConfigError, PatternError, TilingError, UnitRangeError
from flexscale.mechanics.contact_options import ContactOptions
from flexscale.mechanics.scale_options import SCALE_MODELS, ScaleOptions
from flexscale.mechanics.substrate_options import SUBSTRATE_ELEMENTS, SubstrateOptions
from flexscale.mesh.options import MeshOptions
from flexscale.patterns.named import named_pattern
from flexscale.patterns.pattern import Pattern
from flexscale.solve.solver_options import SolverOptions
from flexscale.steps.blocks import PatternBlock
from flexscale.steps.catalog import FIGURES
from flexscale.steps.experiment import ExperimentFile, load_experiment, parse_experiment
from flexscale.steps.option_blocks import option_fields
from flexscale.steps.plan import build_plan
from flexscale.steps.summary import describe_experiment
from flexscale.units import LENGTHS
from tests.steps.experiment_samples import SHELL, SMALL, changed, message_of

QUICKSTART = Path(__file__).parents[2] / "workflows" / "quickstart.yaml"


def test_quickstart_is_the_experiment_of_the_paper() -> None:
    experiment = load_experiment(QUICKSTART)
    assert experiment.sweep is not None
    assert experiment.sweep.directions == tuple(5.0 * i for i in range(36))
    assert experiment.sweep.curvatures[-1] == 0.025  # well behind the onset at 0.01
    patterns = experiment.build_patterns()
    assert {name: p.family for name, p in patterns.items()} == {"square": "IH76", "hexagon": "IH20"}
    assert patterns["square"].gap == 0.4


@pytest.mark.parametrize(
    ("given", "value"),
    [(0.4, 0.4), ("0.4", 0.4), ("0.4 mm", 0.4), ("400 um", 0.4), ("0.04cm", 0.4), ("4e-4 m", 0.4)],
)
def test_values_may_carry_units(given: object, value: float) -> None:
    experiment = parse_experiment(changed(gap=given), "file.yaml")
    assert experiment.patterns["tiles"].gap == value


def test_units_of_the_other_quantities() -> None:
    content = changed(
        tile_area="1 cm2", scale_material={"young_modulus": "2.02 GPa", "poisson_ratio": 0.35}
    )
    content["sweep"] = {"directions": ["0 rad", "90°"], "curvatures": [0, "2 1/m"]}
    experiment = parse_experiment(content, "file.yaml")
    assert experiment.sweep is not None
    assert experiment.sweep.directions == (0.0, 90.0)
    assert experiment.sweep.curvatures == (0.0, 0.002)
    pattern = experiment.build_patterns()["tiles"]
    assert (pattern.tile_area, pattern.scale_material.young_modulus) == (100.0, 2020.0)


def test_ranges_leave_out_their_end() -> None:
    content = copy.deepcopy(SMALL)
    content["sweep"]["curvatures"] = {"start": 0, "stop": "0.002 mm-1", "step": 0.0005}
    experiment = parse_experiment(content, "file.yaml")
    assert experiment.sweep is not None
    assert experiment.sweep.curvatures == (0.0, 0.0005, 0.001, 0.0015)


def test_left_out_values_are_those_of_pattern() -> None:
    pattern = parse_experiment(SMALL, "file.yaml").build_patterns()["tiles"]
    assert pattern.with_(name="square") == Pattern(pattern.tiling)


def test_resolved_experiment_reads_back_the_same() -> None:
    experiment = load_experiment(QUICKSTART)
    content = json.loads(experiment.model_dump_json(exclude_none=True))
    assert parse_experiment(content, "copy") == experiment


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (changed(gpa=0.4), "patterns.tiles: there is no key 'gpa'. Did you mean 'gap'"),
        (changed(gap=-1), "patterns.tiles.gap: gap is -1 mm, but must be positive"),
        (changed(gap="0.4 MPa"), "'0.4 MPa' is not a value in mm"),
        (changed(gap=True), "True is not a value in mm"),
        (changed(gap=float("nan")), "patterns.tiles.gap"),
        (changed(scale_material="PLA"), "there is no material 'PLA'"),
        (
            changed(scale_material={"young_modulus": 1, "poisson_ratio": 0.5}),
            "less than or equal to 0.4999, not 0.5",
        ),
        (changed(tiles=[[[0, 0], [1, 0], [1, 1]]]), "tiles out of place"),
        ({"patterns": {"a": {}}}, "lattice, tiles missing"),
        (
            {"patterns": {"a": {"named": "chevrn"}}},
            "patterns.a: There is no pattern named 'chevrn'. Did you mean 'chevron'",
        ),
        ({"patterns": {"a": {"named": "square", "family": "IH76"}}}, "family out of place"),
        ({"patterns": {"a": {"named": ["square"]}}}, "patterns.a.named"),
        (changed(tiles=None, edges={"a": [[0, 0], [1, "1 mm"]]}), "'1 mm' is not a number: write"),
        (changed(edges={"a": [[0, 0], [0.5, 0.1], [1, 0]]}), "Edge class 'a'"),
        ({"patterns": {}}, "at least one pattern"),
        ({"patterns": {"a b": {"family": "IH76"}}}, "is named 'a b': use letters"),
        (SMALL | {"swep": {}}, "Did you mean 'sweep'"),
        (SMALL | {"figures": ["polr"]}, "figures.0"),
        (SMALL | {"figures": ["tangent"]}, "needs the block `tangent`"),
        (SMALL | {"figures": ["fit"]}, "needs the block `fit`"),
        (SMALL | {"fit": {}, "sweep": None}, "`fit` needs the block `sweep`"),
        (SMALL | {"fit": {"weighting": "relativ"}}, "fit.weighting"),
        (
            SMALL | {"fit": {}, "sweep": {"directions": [0, 45], "curvatures": [0, 0.01]}},
            "file.yaml: A fit needs at least 3 curvatures besides 0",
        ),
        (
            SMALL | {"fit": {}, "sweep": {"directions": [0, 9], "curvatures": [0, 0.1, 0.2, 0.3]}},
            "only 2 of the sweep's 2 directions",
        ),
        (SMALL | {"sweep": {"directions": [0, 180], "curvatures": [0]}}, "[0, 180)"),
        (SMALL | {"sweep": {"directions": [30, 0], "curvatures": [0]}}, "0 follows 30"),
        (SMALL | {"sweep": {"directions": [0], "curvatures": [0.001]}}, "must be 0"),
        (SMALL | {"sweep": {"directions": [0], "curvatures": {"stop": 1}}}, "exactly the keys"),
        (SMALL | {"solver": {"toleranse": 1}}, "Did you mean 'tolerance'"),
        (SMALL | {"mesh": {"along": "1 MPa"}}, "mesh.along: '1 MPa' is not a value in mm"),
        (
            SMALL | {"mesh": {"across": True}},
            "file.yaml: mesh.across: True is not a number: write a plain number, without a unit.",
        ),
        (SMALL | {"solver": {"time_limit": "1 mm"}}, "solver.time_limit: '1 mm' is not a value in"),
        (
            SMALL | {"contact": {"enabled": "yes"}},
            "file.yaml: contact option enabled is 'yes': give True or False.",
        ),
        (SMALL | {"contact": {"activation": 0.95}}, "contact activation is 0.95 gap, but must lie"),
        (SMALL | {"mesh": {"along": -1}}, "mesh option along is -1 mm"),
        (SMALL | {"mesh": {"across": 3}}, "even number"),
        ([1, 2], "holds no experiment"),
    ],
)
def test_bad_content_is_refused_with_place_and_reason(content: Any, expected: str) -> None:
    assert expected in message_of(content)


def test_every_mistake_is_told_at_once() -> None:
    lines = message_of(changed(gap=-1, scale_height=0)).splitlines()
    assert [line.split(": ")[1] for line in lines] == [
        "patterns.tiles.gap",
        "patterns.tiles.scale_height",
    ]


@pytest.mark.parametrize(
    ("content", "error"),
    [
        (changed(family="IH94"), TilingError),
        (changed(family="hexagon"), TilingError),
        (changed(gap=20), PatternError),
        (SMALL | {"sweep": {"directions": [0], "curvatures": [0, 0.25]}}, UnitRangeError),
        (SMALL | {"shape": [{"curvature": 0.3}]}, UnitRangeError),
    ],
)
def test_patterns_that_cannot_be_built_are_named(content: Any, error: type[Exception]) -> None:
    with pytest.raises(error, match=r"patterns\.tiles: "):
        build_plan(parse_experiment(content, "file.yaml"))


def test_opening_does_not_fold() -> None:
    sweep = {"sides": ["opening"], "directions": [0], "curvatures": [0, 0.3]}
    assert parse_experiment(SMALL | {"sweep": sweep}, "file.yaml").build_patterns()


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("patterns: {a: {family: IH76}, a: {family: IH20}}", "line 1: the key 'a' is given twice"),
        ("patterns: [", "not readable YAML"),
        ("", "holds no experiment"),
    ],
)
def test_files_that_are_no_experiment(tmp_path: Path, text: str, expected: str) -> None:
    path = tmp_path / "experiment.yaml"
    path.write_text(text)
    with pytest.raises(ConfigError) as caught:
        load_experiment(path)
    assert str(path) in str(caught.value)
    assert expected in str(caught.value)


def test_missing_file(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="cannot be read"):
        load_experiment(tmp_path / "nothing.yaml")


def test_pattern_block_offers_every_parameter_of_pattern() -> None:
    parameters = set(inspect.signature(Pattern).parameters) - {"tiling", "name"}
    shapes = {"named", "family", "parameters", "edges", "tiles", "lattice", "symmetrize"}
    assert set(PatternBlock.model_fields) == parameters | shapes


def test_a_name_stands_for_its_shape() -> None:
    """The resolved experiment holds family and curves, whatever becomes of the catalog."""
    text = (
        "patterns: {bent: {named: chevron, gap: 0.5 mm}}\nsweep: {directions: [0], curvatures: [0]}"
    )
    experiment = parse_experiment(yaml.safe_load(text), "file.yaml")
    block = experiment.patterns["bent"]
    assert (block.named, block.family, block.gap) == (None, "IH64", 0.5)
    pattern = experiment.build_patterns()["bent"]
    assert pattern == named_pattern("chevron", gap=0.5).with_(name="bent")
    content = json.loads(experiment.model_dump_json(exclude_none=True))
    assert parse_experiment(content, "copy") == experiment


def test_family_with_parameters_and_edges() -> None:
    block = {"family": "IH64", "parameters": [-0.2], "edges": {"b": [[0, 0], [0.5, "0.1"]]}}
    pattern = parse_experiment(SMALL | {"patterns": {"v": block}}, "f").build_patterns()["v"]
    assert pattern.tiling.parameters == (-0.2,)
    assert pattern.tiling.edges["b"].tolist() == [[0.0, 0.0], [0.5, 0.1]]


def test_option_blocks_take_units_and_know_what_they_mean() -> None:
    content = SHELL | {"mesh": {"along": "0.05 cm"}, "solver": {"max_iterations": 7}}
    experiment = parse_experiment(content, "file.yaml")
    assert experiment.mesh == MeshOptions(along=0.5)
    assert experiment.solver == SolverOptions(max_iterations=7)
    for options in (MeshOptions, SolverOptions):
        fields = option_fields(options)
        usual = [field.name for field in fields if field.name != "time_limit"]
        assert usual == list(options().to_config())
        assert all(field.meaning for field in fields)
    assert {f.name: f.unit for f in option_fields(MeshOptions)}["along"] == "mm"


def test_field_list_tells_default_unit_and_bounds() -> None:
    lines = {line.split()[0]: line for line in describe_experiment(ExperimentFile).splitlines()}
    assert lines["patterns.NAME.gap"].split()[1:5] == ["mm", "0.4", ">=", f"{LENGTHS[0]:g}"]
    assert "PETG" in lines["patterns.NAME.scale_material"]
    assert "mm-1" in lines["sweep.curvatures"]
    assert "mm2" in lines["patterns.NAME.tile_area"]
    assert lines["mesh.along"].split()[1] == "mm"
    assert lines["shape.samples.direction"].split()[1:7] == ["degree", "0", ">=", "0", "<", "180"]


def test_field_list_has_every_field_that_a_file_may_set() -> None:
    """Of blocks and of options of lower floors alike, with a meaning; bounds are those checked."""
    lines = {line.split()[0]: line for line in describe_experiment(ExperimentFile).splitlines()}
    classes = [MeshOptions, ContactOptions, SubstrateOptions, ScaleOptions, SolverOptions]
    for block, options in zip(
        ("mesh", "contact", "substrate", "scales", "solver"), classes, strict=True
    ):
        fields = option_fields(options)
        assert {f"{block}.{field.name}" for field in fields} <= set(lines)
        for field in fields:
            assert field.meaning
            assert field.bounds in lines[f"{block}.{field.name}"]
            assert field.bounds or field.choices or isinstance(field.default, bool)
    for name in ExperimentFile.model_fields:
        assert len(lines[name].split()) > 1
    assert lines["mesh.scale_layers"].split()[1:6] == ["7", ">=", "1", "<=", "64"]
    with pytest.raises(BadInputError, match="64"):
        MeshOptions(scale_layers=65)


def test_names_are_told_from_the_list_they_are_checked_with() -> None:
    lines = {line.split()[0]: line for line in describe_experiment(ExperimentFile).splitlines()}
    for place, names in {
        "figures": FIGURES,
        "sweep.sides": ("closing", "opening"),
        "scales.model": SCALE_MODELS,
        "substrate.element": SUBSTRATE_ELEMENTS,
        "fit.weighting": ("relative", "absolute"),
    }.items():
        assert all(name in lines[place] for name in names)
    with pytest.raises(ConfigError, match=r"no figure 'polr'\. Did you mean 'polar'"):
        parse_experiment(SMALL | {"figures": ["polr"]}, "file.yaml")

"""Experiment files as people write them: units, names, one value for several; and bounds."""

from __future__ import annotations

from typing import Any

import pytest

from flexscale.errors import PatternError
from flexscale.patterns.material import PETG, TPU, NeoHookean, warn_of_soft_scales
from flexscale.patterns.pattern import Pattern
from flexscale.steps.experiment import parse_experiment
from flexscale.steps.plan import build_plan
from flexscale.tilings import Tiling
from tests.steps.experiment_samples import FITTED, SHELL, SMALL, changed, message_of


@pytest.mark.parametrize(
    ("key", "given", "value"),
    [
        ("gap", "400 \N{MICRO SIGN}m", 0.4),
        ("gap", "400 \N{GREEK SMALL LETTER MU}m", 0.4),
        ("gap", "\N{FULLWIDTH DIGIT FOUR}e-1 mm", 0.4),
        ("scale_material", {"young_modulus": "2020 N/mm\N{SUPERSCRIPT TWO}"}, 2020.0),
        ("scale_material", {"young_modulus": "2020 N/mm2"}, 2020.0),
        ("tile_area", "1 cm\N{SUPERSCRIPT TWO}", 100.0),
    ],
)
def test_units_as_keyboards_and_books_write_them(key: str, given: Any, value: float) -> None:
    block = parse_experiment(changed(**{key: given}), "file.yaml").patterns["tiles"]
    found = getattr(block, key)
    assert (found.young_modulus if key == "scale_material" else found) == value


def test_a_curvature_with_raised_signs() -> None:
    sweep = {"directions": 0, "curvatures": [0, "0.01 mm\N{SUPERSCRIPT MINUS}\N{SUPERSCRIPT ONE}"]}
    assert parse_experiment(SMALL | {"sweep": sweep}, "f").sweep.curvatures == (0.0, 0.01)


def test_one_value_is_a_series_of_one() -> None:
    content = SMALL | {
        "sweep": {"directions": "45 deg", "curvatures": 0, "sides": "closing"},
        "tangent": {"directions": 0},
        "figures": "tangent",
    }
    experiment = parse_experiment(content, "file.yaml")
    assert experiment.sweep.directions == (45.0,)
    assert experiment.sweep.sides == ("closing",)
    assert experiment.figures == ("tangent",)
    said = message_of(SMALL | {"sweep": {"directions": 0, "curvatures": 0, "sides": "shut"}})
    assert "sweep.sides.0: Input should be 'closing' or 'opening', not 'shut'." in said


def test_constants_left_out_are_those_of_the_default_material() -> None:
    content = changed(
        substrate_material={"young_modulus": 12}, scale_material={"poisson_ratio": 0.4}
    )
    pattern = parse_experiment(content, "f").build_patterns()["tiles"]
    assert pattern.substrate_material == NeoHookean(12.0, TPU.poisson_ratio)
    assert pattern.scale_material == NeoHookean(PETG.young_modulus, 0.4)


@pytest.mark.parametrize("name", ["4.8.8", "a+b", "x" * 100, "3", "a-b_c"])
def test_names_that_files_and_python_take(name: str) -> None:
    content = {"patterns": {name: {"family": "IH76"}}, "tangent": {}}
    assert all(name in job.id for job in build_plan(parse_experiment(content, "f")))
    assert Pattern(Tiling("IH76"), name=name).name == name


@pytest.mark.parametrize(
    "name", ["-a", ".a", "a b", "a/b", "caf\N{LATIN SMALL LETTER E WITH ACUTE}", "x" * 230, "{a}"]
)
def test_names_that_neither_takes(name: str) -> None:
    assert "becomes a folder" in message_of({"patterns": {name: {"family": "IH76"}}})
    with pytest.raises(PatternError, match="becomes a folder"):
        Pattern(Tiling("IH76"), name=name)


def test_names_equal_but_for_case() -> None:
    content = {"patterns": {"Bent": {"family": "IH76"}, "bent": {"family": "IH20"}}}
    assert "'Bent' and 'bent' would share their files" in message_of(content)


def test_scales_softer_than_the_sheet_are_told(caplog: pytest.LogCaptureFixture) -> None:
    warn_of_soft_scales.cache_clear()
    content = changed(scale_material={"young_modulus": 2.02})
    for _ in range(2):
        build_plan(parse_experiment(content, "file.yaml"))
    assert [record.getMessage() for record in caplog.records] == [
        "The scales (2.02 MPa) are softer than the substrate (26 MPa): were GPa meant?"
    ]


def outlined(*corners: list[float], length: float = 60, width: float = 30) -> dict[str, Any]:
    """A block of a sheet of scales with an outline."""
    sizes = {"length": length, "width": width, "curvatures": [0]}
    return sizes | {"outline": list(corners)}


MANY = [0] * 20_000
TINY = changed(tile_area=1, gap=0.1)
OUT_OF_BOUNDS: dict[str, tuple[dict[str, Any], str]] = {
    "soft": (changed(scale_material={"young_modulus": 1e-12}), "greater than or equal to 0.001"),
    "auxetic": (changed(scale_material={"poisson_ratio": -0.999999}), "or equal to -0.95"),
    "tiny tiles": (changed(tile_area=1e-8), "tile area is 1e-08 mm²"),
    "a gap of an atom": (changed(gap=1e-6), "between 0.001 mm and 10000 mm"),
    "huge elements": (SHELL | {"mesh": {"scale_size": 1e6}}, "scale_size is 1000000 mm"),
    "fine scales": (SHELL | {"mesh": {"scale_size": 0.0018}}, "tets, more than"),
    "fine gaps": (SHELL | {"mesh": {"along": 0.002}}, "triangles, more than"),
    "a tangent of nothing": (SMALL | {"tangent": {"directions": []}}, "tangent.directions"),
    "many directions": (SMALL | {"tangent": {"directions": MANY}}, "at most 10000 values"),
    "a fine sheet": (FITTED | {"sheet": {"size": 1e-6}}, "between 0.001 mm and 10000 mm"),
    "a fine sheet, still": (FITTED | {"sheet": {"size": 0.01}}, "more than 300000"),
    "a fine disc": (FITTED | {"rig": {"mandrel": {}, "size": 0.1}}, "more than 300000"),
    "a fine strip": (FITTED | {"rig": {"stage": {}, "size": 0.1}}, "more than 300000"),
    "a large sheet": (
        TINY | {"native_sheet": {"length": 9000, "width": 9000, "curvatures": [0]}},
        "GB of memory, of which",
    ),
    "a large sheet of another outline": (
        TINY
        | {
            "native_sheet": {
                "length": 9000,
                "width": 9000,
                "curvatures": [0],
                "outline": [[0, 0], [9000, 0], [9000, 9000], [0, 9000]],
            }
        },
        "GB of memory, of which",
    ),
    "a sheet that crosses itself": (
        SMALL | {"native_sheet": outlined([0, 0], [60, 30], [60, 0], [0, 30])},
        "does not go around a sheet once (Self-intersection[30 15] mm)",
    ),
    "a sheet in parts": (
        SMALL
        | {
            "native_sheet": outlined(
                [0, 0], [60, 0], [60, 30], [40, 30], [40, 0.2], [20, 0.2], [20, 30], [0, 30]
            )
        },
        "parts that no joint connects",
    ),
    "a sheet without an end": (
        SMALL | {"native_sheet": outlined([0, 0], [60, 15], [0, 30])},
        "no edge at x = 60 mm",
    ),
    "a sheet of another length": (
        SMALL | {"native_sheet": outlined([0, 0], [50, 0], [50, 30], [0, 30])},
        "give the length and width that it has",
    ),
    "a sheet smaller than a scale": (
        SMALL | {"native_sheet": outlined([0, 0], [1, 0], [1, 1], [0, 1], length=1, width=1)},
        "cuts all scales of the pattern to slivers",
    ),
    "a sheet of no outline": (SMALL | {"native_sheet": outlined()}, "a list of 3 to"),
    "a pattern at no place": (
        SMALL | {"native_sheet": {"offset": [float("nan"), 0]}},
        "native_sheet.offset",
    ),
    "a pattern far away": (SMALL | {"native_sheet": {"offset": ["20 m", 0]}}, "and 10000 mm"),
    "a large disc": (
        TINY | {"native_rig": {"mandrel": {"radius": 5000}}},
        "about 7.85e+07 scales and would take about",
    ),
    "a sheet of a shell": (SHELL | {"native_sheet": {}}, "of scales on joints, not of"),
    "an endless range": (
        SMALL | {"tangent": {"directions": {"start": 0, "stop": 1, "step": float("nan")}}},
        "step > 0",
    ),
    "a range of huge numbers": (
        SMALL | {"tangent": {"directions": {"start": 0, "stop": 10**400, "step": 1}}},
        "step > 0",
    ),
    "no options": (SMALL | {"mesh": 3}, "mapping of options"),
}


@pytest.mark.parametrize("case", OUT_OF_BOUNDS)
def test_what_cannot_be_computed_is_refused_when_planned(case: str) -> None:
    content, words = OUT_OF_BOUNDS[case]
    assert words in message_of(content)


def test_mistakes_are_told_up_to_a_number_and_cut_to_lines() -> None:
    curvatures = ["x" * 5000] * 500
    lines = message_of(SMALL | {"sweep": {"directions": [0], "curvatures": curvatures}}).split("\n")
    assert len(lines) == 21
    assert lines[-1] == "file.yaml: and 481 more mistakes."
    assert max(map(len, lines)) < 400

"""`flexscale fabricate`: which pattern and shape it takes, what it says, what it leaves."""

from __future__ import annotations

import inspect
import json
import re
from pathlib import Path

import pytest

import flexscale as fs
from flexscale.cli import fabricate as command
from flexscale.fabricate import Disc, Grooves, Printer, Rectangle
from flexscale.patterns import Pattern
from tests.cli.test_cli import call

SMALL = ("--size", "40x30")


@pytest.fixture(autouse=True)
def empty_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)


def left() -> list[str]:
    return sorted(path.name for path in Path().iterdir())


def record() -> dict:
    (path,) = Path().glob("*.json")
    content: dict = json.loads(path.read_text())
    return content


def test_paths_on_stdout_and_figures_on_stderr(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(monkeypatch, "fabricate", "hexagon", *SMALL) == 0
    said = capsys.readouterr()
    assert sorted(said.out.split()) == left()
    assert len(left()) == 6
    assert re.search(r"^print size +52 x 30 x 6 mm, 60 layers$", said.err, re.MULTILINE)
    assert record()["pattern"]["name"] == "hexagon"


def test_an_earlier_sheet_is_not_written_over_before_it_is_made(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("square-rectangle-40x30.3mf").write_text("earlier")
    with monkeypatch.context() as context:
        context.setattr("flexscale.cli.fabricate_sheet.printable_sheet", lambda *_: 1 / 0)
        assert call(context, "fabricate", "square", *SMALL) == 2
    assert "40x30.3mf is there already" in capsys.readouterr().err
    assert left() == ["square-rectangle-40x30.3mf"]
    assert call(monkeypatch, "fabricate", "square", *SMALL, "--force", "--quiet") == 0
    assert len(left()) == 6
    assert Path("square-rectangle-40x30.3mf").read_bytes() != b"earlier"


@pytest.mark.parametrize(
    ("given", "word"),
    [
        (("--center", "1e300", "0"), "center"),
        (("--pin", "1e300"), "pin"),
        (("--shape", "disc", "--size", "0.3", "--hub", "0"), "mm"),
        (("--size", "9" * 3000), "size"),
        (("--size", "nanx30"), "length"),
        (("--direction", "1e300"), "direction"),
        (("--center", "0", "-1e300"), "center"),
        (("--pattern", "x" * 3000), "--pattern"),
        (("--shape", "disc", "--size", "1e-9", "--hub", "1e-10"), "radius"),
    ],
)
def test_numbers_far_off_are_one_sentence(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    given: tuple[str, ...],
    word: str,
) -> None:
    assert call(monkeypatch, "fabricate", "square", *given) == 2
    said = capsys.readouterr().err
    assert word in said
    assert len(said) < 400
    assert left() == []


def test_json_on_stdout_is_the_record(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    given = ("fabricate", "square", "--shape", "disc", "--size", "20", "--hub", "0", "--json", "-q")
    assert call(monkeypatch, *given) == 0
    said = capsys.readouterr()
    assert said.err == ""
    assert json.loads(said.out) == record()
    assert record()["options"]["shape"] == {"shape": "disc", "radius": 20.0, "hub": None}


def test_options_reach_the_sheet(monkeypatch: pytest.MonkeyPatch) -> None:
    options = ["--direction", "-30", "--center", "-3", "4", "--border", "whole", "--gap", "0.5"]
    options += ["--groove-depth", "0.3", "--nozzle", "0.3", "--pin", "2", "--tile-area", "80"]
    assert (
        call(monkeypatch, "fabricate", "IH07", "--parameters", "0.1", "-0.2", *SMALL, *options) == 0
    )
    told = record()
    assert told["options"]["layout"]["direction"] == -30.0
    assert told["options"]["layout"]["center"] == [-3.0, 4.0]
    assert told["options"]["grooves"]["depth"] == 0.3
    assert told["options"]["printer"]["smallest_wall"] == 0.3
    assert told["options"]["shape"]["pin"] == 2.0
    assert told["figures"]["cut_scales"] == 0 < told["figures"]["scales_left_out"]
    wanted = Pattern(fs.Tiling("IH07", [0.1, -0.2]), gap=0.5, tile_area=80.0)
    assert Pattern.from_config(told["pattern"]) == wanted


def test_a_pattern_of_an_experiment_file(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("two.yaml").write_text(
        "patterns: {one: {named: square}, other: {family: IH20, gap: 0.5}}\n"
        "native: shell\nmesh: {along: 0.7}\n"
    )
    assert call(monkeypatch, "fabricate", "two.yaml", *SMALL) == 2
    assert "two.yaml has 2 patterns: choose by --pattern: one, other." in capsys.readouterr().err
    assert call(monkeypatch, "fabricate", "two.yaml", "--pattern", "othr", *SMALL) == 2
    assert "Did you mean 'other'" in capsys.readouterr().err
    assert call(monkeypatch, "fabricate", "two.yaml", "--pattern", "other", *SMALL) == 0
    assert record()["figures"]["gap_mm"] == 0.5


REFUSED = [
    (("hexagn",), "There is no pattern named 'hexagn'. Did you mean 'hexagon'?"),
    (("nowhere.yaml",), "nowhere.yaml cannot be read"),
    (("square", "--gap", "0.3"), "narrower than the nozzle of 0.4 mm"),
    (("square", "--groove-depth", "0.6"), "The grooves are 0.6 mm deep, but the substrate is 0.4"),
    (("square", "--size", "5x5"), "holds no whole scale of pattern 'square'"),
    (("square", "--size", "100"), "--size '100' is no size of a rectangle: write LENGTHxWIDTH"),
    (("square", "--size", "axb"), "--size 'axb' is no size of a rectangle"),
    (("square", "--shape", "disc", "--size", "9x9"), "--size '9x9' is no size of a disc"),
    (("square", "--shape", "disc", "--pin-clearance", "1"), "A disc has no --pin-clearance"),
    (("square", "--hub", "5"), "A rectangle has no --hub"),
    (("square", "--parameters", "0.1"), "shape a tiling family, such as IH07"),
    (("square", "--pattern", "one"), "--pattern chooses from an experiment file"),
    (("square", "--out", "nowhere"), "There is no folder nowhere"),
    (("square", "--size=-5x10"), "sheet length is -5 mm, but must be positive"),
]


@pytest.mark.parametrize(("given", "said"), REFUSED, ids=[" ".join(given) for given, _ in REFUSED])
def test_bad_input_is_one_sentence_and_leaves_nothing(
    given: tuple[str, ...],
    said: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert call(monkeypatch, "fabricate", *given) == 2
    message = capsys.readouterr().err
    assert said in message
    assert message.count("\n") == 1
    assert left() == []


def test_help_tells_the_defaults_there_are() -> None:
    """Help is instant because it does not load the classes whose defaults it names."""
    told = {
        name: option.__metadata__[0].help
        for name, option in inspect.get_annotations(command.fabricate, eval_str=True).items()
        if hasattr(option, "__metadata__")
    }
    pattern = inspect.signature(Pattern).parameters
    defaults = {
        **{f"groove_{name}": getattr(Grooves(), name) for name in ("width", "pitch", "depth")},
        **{name: getattr(Printer(), name) for name in ("layer_height", "nozzle")},
        **{name: pattern[name].default for name in ("gap", "tile_area", "scale_height")},
        "substrate_thickness": pattern["substrate_thickness"].default,
        "pin": Rectangle().pin,
        "pin_clearance": Rectangle().clearance,
        "barrel_wall": Rectangle().barrel_wall,
        "hub": Disc().hub,
    }
    for name, value in defaults.items():
        assert f"({value:g})" in told[name]
    assert "(100x50)" in told["size"]
    assert (Rectangle().length, Rectangle().width, Disc().radius) == (100.0, 50.0, 100.0)

"""`flexscale tiling`: the list, what a picture is made of, and what is said about bad input."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from flexscale.cli.tiling import join_numbers
from flexscale.cli.tiling_gallery import generic_tiling
from flexscale.cli.tiling_input import read_edges, read_parameters, with_ends
from flexscale.cli.tiling_picture import picture_of, picture_of_fault
from flexscale.errors import ConfigError, TilingError
from flexscale.plotting.tiling_edges import tick_marks
from flexscale.tilings import Family, Tiling, families
from flexscale.tilings.drawn_symmetry import drawn_symmetry
from tests.cli.test_cli import call
from tests.sampling import every

ALL = pytest.mark.parametrize("family", every(6, families()), ids=lambda family: family.name)


@pytest.fixture(autouse=True)
def empty_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)


def files() -> list[str]:
    return sorted(path.name for path in Path().iterdir())


def test_list_as_json(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    assert call(monkeypatch, "tiling", "list", "--json") == 0
    said = capsys.readouterr()
    rows = {row["family"]: row for row in json.loads(said.out)}
    assert said.err == ""
    assert list(rows) == [f"IH{number:02}" for number in range(1, 94)]
    assert sum(row["needs_marking"] for row in rows.values()) == 12
    assert all(len(row["parameter_names"]) == row["n_parameters"] for row in rows.values())
    assert rows["IH07"] == {
        "family": "IH07",
        "name": "IH07",
        "net": [3, 3, 3, 3, 3, 3],
        "symbol": "[a+ b+ c+ d+ e+ f+ ; f+ c+ b+ e+ d+ a+]",
        "stabiliser": "c1",
        "group": "p3",
        "drawn_group": "p6m",
        "n_parameters": 2,
        "parameter_names": ["vertex 1 outward", "vertex 1 sideways"],
        "edge_classes": {"a": "J", "b": "J", "d": "J"},
        "edges": ["a", "b", "b", "d", "d", "a"],
        "aspects": 3,
        "cell_scales": 3,
        "primitive_cell_scales": 1,
        "needs_marking": False,
    }


def test_list_as_a_table(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(monkeypatch, "tiling", "list") == 0
    said = capsys.readouterr()
    lines = said.out.splitlines()
    assert len(lines) == 94
    assert lines[19].split()[0] == "IH19"
    assert "needed" in lines[19]
    column = lines[0].index("edges")
    assert lines[7][column:].startswith("a:J b:J d:J")
    assert "U symmetric" in said.err


def test_draw_writes_a_picture_and_prints_its_path(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(monkeypatch, "tiling", "draw", "IH07") == 0
    assert capsys.readouterr().out == "IH07.png\n"
    Path("folder").mkdir()
    assert call(monkeypatch, "tiling", "draw", "IH10", "--out", "folder", "--cells", 1) == 0
    assert call(monkeypatch, "tiling", "draw", "IH10", "--out", "folder/x.svg") == 0
    assert capsys.readouterr().out == "folder/IH10.png\nfolder/x.svg\n"
    assert "<svg" in Path("folder/x.svg").read_text()
    assert files() == ["IH07.png", "folder"]
    before = Path("IH07.png").read_bytes()
    assert call(monkeypatch, "tiling", "draw", "IH07", "--parameters", "0.2,0.1") == 2
    assert "IH07.png is there already: name another place" in capsys.readouterr().err
    assert Path("IH07.png").read_bytes() == before
    assert call(monkeypatch, "tiling", "draw", "IH07", "--parameters", "0.2,0.1", "--force") == 0
    assert Path("IH07.png").read_bytes() != before


def test_numbers_after_the_option_need_no_commas(monkeypatch: pytest.MonkeyPatch) -> None:
    draw = ("tiling", "draw", "--out")
    assert call(monkeypatch, *draw, "1.svg", "--parameters", "-0.1", "0.2", "IH07") == 0
    assert call(monkeypatch, *draw, "2.svg", "IH07", "--parameters=-0.1,0.2") == 0
    assert Path("1.svg").read_bytes() == Path("2.svg").read_bytes()
    arguments = ["--parameters", "-1", "2,3", "--cells", "4", "5"]
    assert join_numbers(arguments, "--parameters") == ["--parameters", "-1,2,3", *arguments[3:]]


def test_parameters_as_text() -> None:
    assert read_parameters(None) is None
    assert read_parameters("0.1, -2e-1 3") == [0.1, -0.2, 3.0]
    with pytest.raises(ConfigError, match="'x' is none"):
        read_parameters("0.1,x")


def test_curves_from_text_and_file() -> None:
    kinds = {"a": "J"}
    expected = [(0.0, 0.0), (0.3, 0.2), (0.6, -0.1), (1.0, 0.0)]
    Path("named.csv").write_text("x,y\n# comment\n0.3, 0.2\n\n0.6,-0.1\n")
    Path("plain.txt").write_text("0 0\n0.3 0.2\n0.6 -0.1\n1 0\n")
    for given in ("0.3:0.2,0.6:-0.1", "0:0 0.3:0.2 0.6:-0.1 1:0", "named.csv", "plain.txt"):
        assert read_edges([f"a={given}"], kinds)["a"].tolist() == [list(p) for p in expected]


@pytest.mark.parametrize(
    ("kind", "points", "expected"),
    [
        ("J", [(0.3, 0.1)], [(0, 0), (0.3, 0.1), (1, 0)]),
        ("S", [(0.3, 0.1)], [(0, 0), (0.3, 0.1), (0.5, 0)]),
        ("S", [(0.3, 0.1), (0.7, -0.1)], [(0, 0), (0.3, 0.1), (0.7, -0.1), (1, 0)]),
        ("U", [(0.3, 0.1)], [(0, 0), (0.3, 0.1), (0.5, 0.1)]),
        ("U", [(0.5, 0.2)], [(0, 0), (0.5, 0.2)]),
        ("U", [(0, 0), (0.5, 0.2), (1, 0)], [(0, 0), (0.5, 0.2), (1, 0)]),
    ],
)
def test_ends_and_halves(
    kind: str, points: list[tuple[float, float]], expected: list[tuple[float, float]]
) -> None:
    np.testing.assert_array_equal(with_ends(np.array(points), kind), expected)


@ALL
def test_ticks_point_to_where_the_curve_goes(family: Family) -> None:
    """A curve with one corner above the first third of its edge has its corners over the ticks."""
    curved = {letter: kind for letter, kind in family.curve_kinds().items() if kind != "I"}
    height = 0.02
    spike = [(0.0, 0.0), (1.0 / 3.0, height)]
    curves = {
        letter: [*spike, (0.5 if kind in "SU" else 1.0, 0.0)] for letter, kind in curved.items()
    }
    straight = picture_of(Tiling(family.name)).edges
    for edge, bent in zip(
        straight, picture_of(Tiling(family.name, edges=curves)).edges, strict=True
    ):
        length = np.linalg.norm(edge.points[1] - edge.points[0])
        tips = [
            foot + height * length * (tip - foot) / np.linalg.norm(tip - foot)
            for foot, tip in tick_marks(edge)
        ]
        along = edge.points[1] - edge.points[0]
        off = (bent.points - edge.points[0]) @ np.array([-along[1], along[0]]) / length
        corners = bent.points[np.abs(off) > 0.5 * height * length]
        assert len(corners) == len(tips) == {"J": 1, "U": 2, "S": 2, "I": 0}[edge.kind]
        for corner in corners:
            assert min(np.linalg.norm(corner - tip) for tip in tips) < 1e-9


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["ih07"], "'ih07' does not exist.*Did you mean 'IH07'"),
        (["IH07", "--parameters", "0.1"], "IH07 has 2 free shape parameter.*but 1 were given"),
        (["IH07", "--parameters", "0.1,b"], "'b' is none"),
        (["IH07", "--edge", "c=0.5:0.1"], "no edge class 'c'"),
        (["IH07", "--edge", "a"], "gives no curve"),
        (["IH07", "--edge", "a=0.5:0.1:3"], "'0.5:0.1:3' is no point"),
        (["IH07", "--edge", "a=none.csv"], "none.csv cannot be read"),
        (["IH07", "--edge", "a=nan:0.1"], "finite"),
        (["IH07", "--edge", "a=0.5:0.1", "--edge", "a=0.5:0.2"], "'a' twice"),
        (["IH07", "--out", "x.jpg"], "must end in .png, .svg or .pdf"),
        (["IH07", "--out", "none/x.png"], "There is no folder none"),
        (["IH07", "--cells", "0"], "greater than or equal to 1"),
    ],
)
def test_bad_input_draws_nothing(
    arguments: list[str],
    sentence: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert call(monkeypatch, "tiling", "draw", *arguments) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert re.search(sentence, said.err)
    assert files() == []


def test_bad_lines_of_a_file() -> None:
    Path("bad.csv").write_text("x,y\n0.3,0.1\n0.4\n")
    with pytest.raises(ConfigError, match=r"Line 3 of bad\.csv is no point x,y: '0\.4'"):
        read_edges(["a=bad.csv"], {"a": "J"})
    Path("empty.csv").write_text("x,y\n")
    with pytest.raises(ConfigError, match=r"empty\.csv has no points"):
        read_edges(["a=empty.csv"], {"a": "J"})


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["IH07", "--parameters", "0.1", "1.5"], "IH07 with parameters (0.1, 1.5) gives no tile"),
        (["IH76", "--edge", "a=0.5:0.2"], "must stay straight"),
        (["IH64", "--edge", "b=0.2:0.1,0.8:0.2"], "must go into itself"),
        (["IH10", "--edge", "a=0.2:0.1,0.2:0.1"], "twice"),
    ],
)
def test_what_is_no_tile_is_drawn_all_the_same(
    arguments: list[str],
    sentence: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert call(monkeypatch, "tiling", "draw", *arguments) == 2
    said = capsys.readouterr()
    assert said.out == f"{arguments[0]}.png\n"
    assert sentence in said.err
    assert len(said.err.splitlines()) == 1
    assert files() == [f"{arguments[0]}.png"]


def fault_of(
    family: str, parameters: list[float] | None, edges: dict[str, np.ndarray]
) -> tuple[set[int], np.ndarray]:
    """Edges at fault, and where the outline meets itself."""
    with pytest.raises(TilingError) as caught:
        Tiling(family, parameters, edges)
    picture = picture_of_fault(family, parameters, edges, caught.value)
    assert picture is not None
    assert str(caught.value).split()[0] in picture.remarks[0]
    return {k for k, edge in enumerate(picture.edges) if edge.wrong}, picture.crossings


def test_edges_at_fault() -> None:
    # A square with four turned copies of one S edge, each of which crosses the one before.
    hook = np.array([(0.0, 0.0), (-0.3, 0.2), (0.5, 0.0)])
    wrong, crossings = fault_of("IH62", None, {"a": hook})
    assert wrong == {0, 1, 2, 3}
    assert len(crossings) > 0
    turned = crossings @ np.array([(0.0, 1.0), (-1.0, 0.0)])
    apart = np.linalg.norm(turned[:, None] - crossings[None], axis=2)
    assert apart.min(axis=1).max() < 1e-12
    skew = np.array([(0.0, 0.0), (0.3, 0.1), (1.0, 0.0)])
    assert fault_of("IH64", None, {"b": skew})[0] == {1, 3}
    assert len(fault_of("IH64", None, {"b": skew})[1]) == 0


def test_every_outline_that_is_no_tile_has_edges_at_fault() -> None:
    rng = np.random.default_rng(11)
    faults = 0
    for family in families():
        parameters = rng.uniform(-2.0, 2.0, family.n_parameters).tolist()
        try:
            Tiling(family.name, parameters)
        except TilingError:
            assert fault_of(family.name, parameters, {})[0]
            faults += 1
    assert faults > 30


@ALL
def test_gallery_shows_the_group_of_the_type(family: Family) -> None:
    tiling = generic_tiling(family)
    drawn = drawn_symmetry(tiling.tiles, tiling.lattice)
    shown = (drawn.group, drawn.n_primitive_cells) == (family.group, 1)
    assert shown == (not family.needs_marking)


@pytest.mark.slow
def test_gallery_is_one_small_file(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(monkeypatch, "tiling", "gallery") == 0
    assert capsys.readouterr().out == "tilings.png\n"
    assert 100_000 < Path("tilings.png").stat().st_size < 700_000


def test_parameter_names(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(monkeypatch, "tiling", "draw", "IH01", "--parameter-names") == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[:2] == ["1  stretch", "2  shear"]
    assert len(lines) == 4
    assert call(monkeypatch, "tiling", "draw", "IH76", "--parameter-names") == 0
    said = capsys.readouterr()
    assert said.out == ""
    assert "IH76 has no free shape parameters" in said.err
    assert files() == []


def test_named_patterns_in_one_file(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(monkeypatch, "tiling", "gallery", "--named") == 0
    assert capsys.readouterr().out == "patterns.png\n"
    assert files() == ["patterns.png"]
    for command in (["--named"], ["--out", "patterns.png"]):
        assert call(monkeypatch, "tiling", "gallery", *command) == 2
        assert "patterns.png is there already" in capsys.readouterr().err


def test_a_named_pattern_is_drawn_with_its_own_shape(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    drawn = []
    monkeypatch.setattr("flexscale.cli.tiling_draw.picture_of", drawn.append)
    monkeypatch.setattr("flexscale.cli.tiling_draw.tiling_figure", lambda *_: None)
    monkeypatch.setattr("flexscale.cli.tiling_draw.write_picture", lambda *_, **__: None)
    assert call(monkeypatch, "tiling", "draw", "pinwheel3") == 0
    assert call(monkeypatch, "tiling", "draw", "arrowhead", "--parameters", "0", "0") == 0
    assert capsys.readouterr().out == "pinwheel3.png\narrowhead.png\n"
    assert drawn[0].family == "IH10"
    assert "a" in drawn[0].edges
    assert drawn[1].parameters == (0.0, 0.0)  # what is given goes before the catalog


@pytest.mark.parametrize("typed", ["IH7", "7", "ih07", "IH007"])
def test_a_number_written_otherwise_is_recognized(
    typed: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(monkeypatch, "tiling", "draw", typed) == 2
    assert "Did you mean 'IH07'?" in capsys.readouterr().err

"""Saving figures, and the runner that draws figure scripts from a registry."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr

from flexscale.errors import BadInputError, ConfigError, UnknownNameError
from flexscale.findings import Evidence, Finding
from flexscale.plotting import polar, save_figure
from flexscale.plotting.figure_scripts import Need, find_scripts
from flexscale.plotting.figures import draw_figure
from flexscale.plotting.index_page import write_index
from tests.plotting.plotting_data import flat_cell, two_regime_sweep, with_failures

PAPER_FIGURES = Path(__file__).resolve().parents[2] / "paper_figures"

SCRIPT = """
from flexscale.plotting import (polar)
from flexscale.plotting.figure_scripts import (Need)
NEEDS = {"sweep": Need("sweep", "flexscale run square.yaml", {"pattern": "squares"})}
CAPTION = "A <test> figure."
PAPER_SAYS = "Stiffer & stiffer."
def draw(inputs):
    return polar(inputs["sweep"])
def findings(inputs):
    return [f"largest {float(inputs['sweep']['moment'].max()):.3g} N"]
"""


@dataclass
class FakeEntry:
    """What a registry says about a dataset."""

    kind: str
    digest: str
    dataset: xr.Dataset
    row: dict[str, Any] = field(default_factory=dict)
    folder: Path = Path("results/local/sweep")

    @property
    def id(self) -> str:
        return f"{self.kind}:{self.digest}"

    @property
    def content_digest(self) -> str:
        return self.digest * 8


class FakeRegistry:
    """Registry in memory that counts how many datasets were opened."""

    root = Path("results")

    def __init__(self, *entries: FakeEntry) -> None:
        self.entries = entries
        self.n_loaded = 0

    def __iter__(self) -> Iterator[FakeEntry]:
        return iter(self.entries)

    def get(self, identifier: str) -> FakeEntry:
        return next(entry for entry in self.entries if entry.id == identifier)

    def load(self, entry: FakeEntry) -> xr.Dataset:
        self.n_loaded += 1
        return entry.dataset


def square_entry(digest: str = "aaaa", dataset: xr.Dataset | None = None) -> FakeEntry:
    row = {"family": "IH76", "pattern": "squares"}
    return FakeEntry("sweep", digest, two_regime_sweep(4) if dataset is None else dataset, row)


@pytest.fixture
def script_folder(tmp_path: Path) -> Path:
    folder = tmp_path / "scripts"
    folder.mkdir()
    (folder / "fig99_test.py").write_text(SCRIPT)
    return folder


def test_equal_data_gives_equal_bytes(tmp_path: Path) -> None:
    paths = [
        save_figure(polar(two_regime_sweep(4)), tmp_path / name, "p", sources=["sweep:1"])
        for name in ("one", "two")
    ]
    for ending in ("pdf", "png", "json"):
        assert paths[0][ending].read_bytes() == paths[1][ending].read_bytes()
    assert sorted(path.name for path in (tmp_path / "one").iterdir()) == [
        "p.json",
        "p.pdf",
        "p.png",
    ]
    assert json.loads(paths[0]["json"].read_text())["sources"] == [{"id": "sweep:1"}]
    assert b"/Type /Font" in paths[0]["pdf"].read_bytes()


def test_the_users_own_style_changes_nothing(tmp_path: Path) -> None:
    def draw(stem: str) -> bytes:
        figure = polar(two_regime_sweep(4))
        return save_figure(figure, tmp_path, stem, sources=[])["png"].read_bytes()

    expected = draw("ours")
    with mpl.rc_context({"font.size": 20, "savefig.dpi": 40, "lines.linestyle": ":"}):
        assert draw("theirs") == expected
        assert mpl.rcParams["font.size"] == 20


def test_a_stem_with_a_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadInputError, match=r"\.\./p"):
        save_figure(polar(two_regime_sweep(4)), tmp_path, "../p", sources=[])
    assert not list(tmp_path.iterdir())


def test_facts_are_plain_data_or_refused_before_any_file(tmp_path: Path) -> None:
    figure = polar(two_regime_sweep(4))
    with pytest.raises(ConfigError, match=r"facts\.when is a object"):
        save_figure(figure, tmp_path / "new", "p", sources=[], facts={"when": object()})
    assert not list(tmp_path.iterdir())
    facts = {"n": np.int64(3), "values": np.array([0.5, np.nan]), "worst": float("inf")}
    told = save_figure(figure, tmp_path, "p", sources=[], facts=facts)["json"].read_text()
    assert json.loads(told, parse_constant=pytest.fail) == {
        "figure": "p",
        "sources": [],
        "n": 3,
        "values": [0.5, None],
        "worst": None,
    }


def test_a_figure_is_drawn_once_and_again_when_its_data_change(
    script_folder: Path, tmp_path: Path
) -> None:
    (script,) = find_scripts(script_folder, ["fig99"])
    out = tmp_path / "figures"
    registry = FakeRegistry(square_entry())
    first = draw_figure(script, registry, out)
    assert first.outcome == "drawn"
    assert first.sources == ("sweep:aaaa",)
    content = json.loads(first.paths["json"].read_text())
    assert content["sources"][0]["content_digest"] == "aaaa" * 8
    again = draw_figure(script, registry, out)
    assert again.outcome == "reused"
    assert again.we_find == first.we_find
    largest = float(two_regime_sweep(4)["moment"].max())
    assert first.we_find == (f"largest {largest:.3g} N",)
    assert registry.n_loaded == 1
    assert draw_figure(script, FakeRegistry(square_entry("bbbb")), out).outcome == "drawn"
    first.paths["pdf"].unlink()
    assert draw_figure(script, FakeRegistry(square_entry("bbbb")), out).outcome == "drawn"


def test_a_changed_script_or_damaged_json_means_drawing_again(
    script_folder: Path, tmp_path: Path
) -> None:
    registry = FakeRegistry(square_entry())
    draw_figure(find_scripts(script_folder)[0], registry, tmp_path)
    (tmp_path / "fig99_test.json").write_text("{")
    assert draw_figure(find_scripts(script_folder)[0], registry, tmp_path).outcome == "drawn"
    (script_folder / "fig99_test.py").write_text(SCRIPT + "# changed\n")
    assert draw_figure(find_scripts(script_folder)[0], registry, tmp_path).outcome == "drawn"


def test_missing_data_name_the_command_and_write_nothing(
    script_folder: Path, tmp_path: Path
) -> None:
    (script,) = find_scripts(script_folder)
    out = tmp_path / "figures"
    report = draw_figure(script, FakeRegistry(), out)
    assert report.outcome == "missing"
    assert "sweep squares" in report.message
    assert "flexscale run square.yaml" in report.message
    assert not out.exists()


def test_several_fitting_datasets_are_not_chosen_from_silently(
    script_folder: Path, tmp_path: Path
) -> None:
    (script,) = find_scripts(script_folder)
    registry = FakeRegistry(square_entry("aaaa"), square_entry("bbbb"))
    report = draw_figure(script, registry, tmp_path)
    assert report.outcome == "missing"
    assert "sweep:aaaa, sweep:bbbb" in report.message
    chosen = draw_figure(script, registry, tmp_path, use={"sweep": "sweep:bbbb"})
    assert chosen.sources == ("sweep:bbbb",)


def test_shipped_datasets_come_before_ones_own(script_folder: Path, tmp_path: Path) -> None:
    (script,) = find_scripts(script_folder)
    shipped = square_entry("bbbb")
    shipped.row["source"] = "reference"
    report = draw_figure(script, FakeRegistry(square_entry("aaaa"), shipped), tmp_path)
    assert report.sources == ("sweep:bbbb",)


def test_what_is_not_the_papers_is_only_drawn_when_asked_for(
    script_folder: Path, tmp_path: Path
) -> None:
    (script,) = find_scripts(script_folder)
    registry = FakeRegistry(square_entry("aaaa"))
    report = draw_figure(script, registry, tmp_path, paper=[])
    assert report.outcome == "missing"
    assert "sweep:aaaa: not the paper's; --use sweep=ID draws it" in report.message
    assert "flexscale run square.yaml" in report.message
    assert draw_figure(script, registry, tmp_path, {"sweep": "sweep:aaaa"}, []).sources


def test_an_optional_dataset_is_drawn_where_there_is_one(
    script_folder: Path, tmp_path: Path
) -> None:
    (script,) = find_scripts(script_folder)
    need = Need("sweep", "flexscale run other.yaml", {"pattern": "other"}, optional=True)
    script.module.NEEDS["other"] = need
    report = draw_figure(script, FakeRegistry(square_entry("aaaa")), tmp_path)
    assert report.sources == ("sweep:aaaa",)
    other = square_entry("bbbb")
    other.row["pattern"] = "other"
    report = draw_figure(script, FakeRegistry(square_entry("aaaa"), other), tmp_path)
    assert report.outcome == "drawn", "anew, with what is there now"
    assert set(report.sources) == {"sweep:aaaa", "sweep:bbbb"}


def test_unknown_figures_and_incomplete_scripts_are_refused(script_folder: Path) -> None:
    with pytest.raises(UnknownNameError, match="fig99_test"):
        find_scripts(script_folder, ["fig98_test"])
    (script_folder / "fig01_bad.py").write_text("CAPTION = ''\n")
    with pytest.raises(BadInputError, match=r"fig01_bad.*NEEDS, PAPER_SAYS, draw, findings"):
        find_scripts(script_folder)


def test_index_lists_drawn_and_missing_figures(script_folder: Path, tmp_path: Path) -> None:
    (script,) = find_scripts(script_folder)
    reports = [
        draw_figure(script, FakeRegistry(square_entry()), tmp_path),
        draw_figure(script, FakeRegistry(), tmp_path),
    ]
    page = write_index(reports, tmp_path).read_text()
    assert page.count("A &lt;test&gt; figure.") >= 2
    assert 'src="fig99_test.png"' in page
    assert "sweep:aaaa" in page
    assert "flexscale run square.yaml" in page
    assert "Stiffer &amp; stiffer." in page
    assert f"<li>{reports[0].we_find[0]}</li>" in page
    assert '<a href="#fig99_test"><img src="fig99_test.png"' in page, "a thumbnail"
    assert "Fig. 9: forces measured" in page


def test_index_shows_findings_with_the_reason_of_those_that_disagree(tmp_path: Path) -> None:
    shows = Finding("a", "It is <soft>.", "x < 2", (Evidence("mine", True, "1 < 2"),), why="Odd.")
    lacks = Finding("b", "It is stiff.", "x > 2", (Evidence("mine", False, "1"),), why="Too soft.")
    page = write_index([], tmp_path, [shows.to_dict(), lacks.to_dict()]).read_text()
    assert '<td class="agrees"><b>agrees</b></td><td>It is &lt;soft&gt;.</td>' in page
    assert '<td class="missing"><b>disagrees</b></td><td>It is stiff.<p><b>Why:</b> Too' in page
    assert "Odd." not in page, "reasons belong to what disagrees"
    assert "yes · mine: 1 &lt; 2" in page
    assert "0 of 1 patterns" in page
    assert 'id="findings"' not in write_index([], tmp_path).read_text()


def test_figure_7_draws_all_patterns_with_failures_visible(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("flexscale.plotting.figures.native_of", lambda folder: folder.name)
    squares = with_failures(two_regime_sweep(4), [("closing", 3, 10)])
    entries = []
    (script,) = find_scripts(PAPER_FIGURES, ["fig7"])
    assert [s.stem for s in find_scripts(PAPER_FIGURES, ["FIG007"])] == [script.stem]
    for name, family in script.module.PATTERNS.items():
        row = {"family": family, "pattern": name}
        sweep = squares if name == "square" else two_regime_sweep(6)
        entries += [
            FakeEntry("sweep", name, two_regime_sweep(6), row, Path("shell")),
            FakeEntry("sweep", f"{name}-printed", sweep, row, Path("joints")),
            FakeEntry("cell", name, flat_cell(4 if name == "square" else 6), row, Path("shell")),
        ]
    inputs = {
        f"{e.row['pattern']}_{'printed' if e.folder.name == 'joints' else e.kind}": e.dataset
        for e in entries
    }
    figure = script.module.draw(inputs)
    n_columns = 5
    assert len(figure.axes) == n_columns * len(script.module.PATTERNS)
    row = list(script.module.PATTERNS).index("square")
    last = figure.axes[n_columns * (row + 1) - 1]
    curve = next(line for line in last.get_lines() if line.get_label() == "0.025")
    expected = squares["moment"].sel(side="closing").isel(curvature=10).values
    np.testing.assert_array_equal(curve.get_ydata()[:-1], expected)
    assert "0.025 mm⁻¹" in last.get_title()
    assert f"{np.nanmax(expected):.3g} N" in last.get_title()
    assert any(line.get_label() == "_unconverged" for line in last.get_lines())
    report = draw_figure(script, FakeRegistry(*entries), tmp_path)
    assert report.outcome == "drawn"
    assert set(report.sources) == {entry.id for entry in entries}
    assert "joints, square: at 0.0025 mm-1" in report.we_find[2 * row]
    assert "at 0.0225 mm-1" in report.we_find[2 * row], "the last curvature with all samples"

"""Figures and findings of the paper do not depend on what else a user has run."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest
import xarray as xr

from flexscale.cli import main
from flexscale.datasets.entry import Entry
from flexscale.datasets.identity import Recipe
from flexscale.datasets.registry import Registry, open_registry
from flexscale.datasets.store import Store
from flexscale.errors import MissingDataError
from flexscale.findings import all_findings
from flexscale.plotting.figure_scripts import find_scripts
from flexscale.plotting.figures import draw_figure
from flexscale.steps.paper import paper_datasets

ROOT = Path(__file__).parents[2]
SHIPPED = ROOT / "results" / "reference"


def publish(root: Path, kind: str, dataset: xr.Dataset, pattern: str) -> Entry:
    named = dataset.assign_coords(pattern=dataset["pattern"].copy(data=pattern))
    recipe = Recipe(kind, 1, {"pattern": pattern, "own": True, "native": "shell"})
    return Store(root).publish(named, kind, recipe)


def own_experiment(root: Path) -> None:
    """Two patterns, one named as a shipped one, with tangents and sweeps of two directions."""
    shipped = open_registry(ROOT / "results").find(source="reference", pattern="hexagon")
    for pattern in ("hexagon", "mine"):
        for kind in ("cell", "tangent", "sweep"):
            (entry,) = shipped.find(kind=kind, native="shell")
            dataset = open_registry(ROOT / "results").load(entry)
            if kind == "sweep":
                dataset = dataset.sel(direction=[0.0, 90.0])
            publish(root, kind, dataset, pattern)


@pytest.fixture(scope="module")
def mixed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("mixed")
    (root / "reference").symlink_to(SHIPPED)
    own_experiment(root)
    return root


def shipped_alone(root: Path) -> Registry:
    (root / "reference").symlink_to(SHIPPED)
    return open_registry(root)


def test_findings_are_the_same_beside_an_experiment_of_ones_own(
    mixed: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Three patterns are enough to see it, and spare the time of the other nine."""
    three = ("hexagon", "square", "pentagon")
    expected = all_findings(_only(shipped_alone(tmp_path), (*three, "mine")))
    registry = open_registry(mixed)
    assert len(registry.find(source="local")) == 6
    assert all_findings(paper_datasets(_only(registry, (*three, "mine")))) == expected


def _only(registry: Registry, patterns: Sequence[str]) -> Registry:
    return registry.only(entry for entry in registry if entry.row["pattern"] in patterns)


def test_figures_choose_the_same_datasets_beside_an_experiment_of_ones_own(
    mixed: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Drawing is left out: what becomes of a figure follows from the ids it is drawn from."""
    monkeypatch.setattr("flexscale.plotting.figures._made_from", lambda script, sources: "x")
    monkeypatch.setattr("flexscale.plotting.figures._current_facts", lambda *_: {"we_find": []})
    alone, beside = shipped_alone(tmp_path), open_registry(mixed)
    for script in find_scripts(ROOT / "paper_figures"):
        reports = [
            draw_figure(script, registry, tmp_path, paper=paper_datasets(registry))
            for registry in (alone, beside)
        ]
        assert reports[0].sources
        assert reports[0] == reports[1]


def test_own_experiments_alone_are_no_paper(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    own_experiment(tmp_path)
    monkeypatch.setattr(sys, "argv", ["flexscale", "data", "findings", "--results", str(tmp_path)])
    with pytest.raises(SystemExit) as caught:
        main.main()
    assert caught.value.code == 4
    assert "flexscale run workflows/named_patterns.yaml" in capsys.readouterr().err
    with pytest.raises(MissingDataError, match="Findings need 6 or more directions"):
        all_findings(open_registry(tmp_path))


def test_without_shipped_ones_the_recipes_of_the_papers_experiments_count(tmp_path: Path) -> None:
    (shipped,) = open_registry(ROOT / "results").find(
        source="reference", kind="cell", pattern="square"
    )
    shutil.copytree(shipped.folder, tmp_path / "local" / shipped.row["path"])
    dataset = open_registry(ROOT / "results").load(shipped)
    own = publish(tmp_path, "cell", dataset, "square")
    registry = open_registry(tmp_path)
    assert {entry.id for entry in registry} == {own.id, shipped.id}
    assert [entry.id for entry in paper_datasets(registry)] == [shipped.id]

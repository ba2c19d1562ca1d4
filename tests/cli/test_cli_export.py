"""`flexscale export`: what it writes, and what it refuses with exit code 2."""

from __future__ import annotations

from pathlib import Path

import pytest

import flexscale as fs
from flexscale.exchange.formats import FORMATS
from tests.cli.test_cli import call


@pytest.fixture
def folder(tmp_path: Path, shipped_results: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "results").symlink_to(shipped_results, target_is_directory=True)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def identifier(results: Path, kind: str) -> str:
    return next(iter(fs.open_registry(results).find(kind=kind, pattern="brick"))).id


@pytest.mark.parametrize("to", FORMATS)
def test_each_format_is_written(
    to: str, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    dataset = identifier(folder / "results", "fit")
    assert call(monkeypatch, "export", dataset, "--to", to) == 0
    name = capsys.readouterr().out.strip()
    assert name == f"fit_IH17_brick_{dataset[4:]}_{to}{FORMATS[to].suffix}"
    assert (folder / name).stat().st_size > 500
    assert call(monkeypatch, "export", dataset, "--to", to) == 2
    assert "is there already" in capsys.readouterr().err
    assert call(monkeypatch, "export", dataset, "--to", to, "--force", "--output", name) == 0
    assert {path.name for path in folder.iterdir()} == {name, "results"}


@pytest.mark.parametrize(
    ("kind", "to", "said"),
    [
        ("fit", "abacus", "Did you mean 'abaqus'"),
        ("tangent", "hylc", "stiffness at rest alone"),
        ("sweep", "abaqus", "fit the sweep first"),
        ("cell", "table-csv", "has neither stiffness nor law"),
    ],
)
def test_refusals_are_one_sentence(
    kind: str,
    to: str,
    said: str,
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    dataset = identifier(folder / "results", kind)
    assert call(monkeypatch, "export", dataset, "--to", to) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert said in told.err
    assert told.err.count("\n") == 1
    assert [path.name for path in folder.iterdir()] == ["results"]


def test_an_unknown_dataset_is_refused(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(monkeypatch, "export", "fit:000000000000", "--to", "hylc") != 0
    assert "fit:000000000000" in capsys.readouterr().err

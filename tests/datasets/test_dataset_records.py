"""record.json is held against one model, against data.nc, and against what this version knows."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from flexscale.datasets.audit import check_results
from flexscale.datasets.entry import Entry
from flexscale.datasets.registry import open_registry
from flexscale.datasets.schema import SCHEMAS
from flexscale.datasets.store import Store
from flexscale.errors import IntegrityError, SchemaError
from tests.datasets.dataset_samples import cell, recipe
from tests.datasets.results_samples import edit_record, forget_catalog, one_sweep


@pytest.fixture(scope="module")
def sample(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results folder to copy: a sweep to be damaged, and a cell that must stay in use."""
    root = tmp_path_factory.mktemp("sample")
    one_sweep(root)
    Store(root).publish(cell(), "cell", recipe())
    return root


@pytest.fixture
def results(sample: Path, tmp_path: Path) -> Path:
    shutil.copytree(sample, tmp_path / "results")
    return tmp_path / "results"


@pytest.fixture
def entry(results: Path) -> Entry:
    return open_registry(results).find(kind="sweep").one()


def setting(*keys: str | int, to: Any) -> Callable[[dict[str, Any]], None]:
    """Change of one value of a record."""

    def change(record: Any) -> None:
        for key in keys[:-1]:
            record = record[key]
        record[keys[-1]] = to

    return change


def problems(results: Path) -> list[str]:
    return [item.message for item in check_results(results) if item.level == "problem"]


MALFORMED = {
    "list for dict": (setting("sizes", to=[1]), "sizes: "),
    "unknown kind": (setting("kind", to="swep"), "kind: there is no such kind"),
    "kind that is a path": (setting("kind", to="../../x"), "kind: "),
    "pattern that is a path": (setting("scalars", "pattern", to="../x"), "pattern is no name"),
    "family with escape codes": (setting("scalars", "family", to="\x1b[2J"), "family is no name"),
    "step with escape codes": (setting("recipe", "step", to="\x1b[2J"), "recipe.step: "),
    "no family": (lambda record: record["scalars"].pop("family"), "it lacks"),
    "no recipe": (lambda record: record.pop("recipe"), "recipe: "),
    "something more": (setting("more", to=1), "more: "),
    "negative samples": (setting("samples", to=-1), "samples: "),
    "more failed than there are": (setting("failed", to=19), "19 of 18 samples failed"),
    "samples as text": (setting("samples", to="18"), "samples: "),
    "gap as text": (setting("scalars", "gap", to="abc"), "gap is no scalar"),
    "unknown scalar": (setting("scalars", "more", to=1.0), "more is no scalar"),
    "digest that is none": (setting("content_digest", to="abc"), "content_digest: "),
    "input that is none": (setting("inputs", to=[{"id": "x"}]), "inputs.0"),
    "time that is none": (setting("environment", "created", to="yesterday"), "created: "),
    "schema of another kind": (setting("schema", to="tangent/99"), "cannot follow the schema"),
    "schema without version": (setting("schema", to="sweep"), "cannot follow the schema"),
    "no seconds": (setting("run", to={"wall_seconds": None}), "run.wall_seconds: "),
    "negative seconds": (setting("run", to={"wall_seconds": -1}), "run.wall_seconds: "),
}


@pytest.mark.parametrize("name", MALFORMED)
def test_a_malformed_record_is_named_and_stops_nothing(
    results: Path, entry: Entry, name: str
) -> None:
    change, words = MALFORMED[name]
    edit_record(entry.folder, change)
    _named_and_left_out(results, entry, words)


TEXTS = {
    "nested too deep": b'{"run": ' + b"[" * 100_000 + b"]" * 100_000 + b"}",
    "nested deep": b'{"run": ' + b"[" * 200 + b"]" * 200 + b"}",
    "not UTF-8": b'{"kind": "\xff\xfe"}',
    "not JSON": b"kind: sweep",
    "long number": b'{"kind": ' + b"9" * 5000 + b"}",
    "no number": b'{"kind": NaN}',
    "text": b'"sweep"',
    "list": b"[1, 2]",
    "empty": b"",
}


@pytest.mark.parametrize("name", TEXTS)
def test_what_is_no_record_at_all_is_named_and_stops_nothing(
    results: Path, entry: Entry, name: str
) -> None:
    (entry.folder / "record.json").write_bytes(TEXTS[name])
    forget_catalog(entry.folder)
    _named_and_left_out(results, entry, "is damaged")


def _named_and_left_out(results: Path, entry: Entry, words: str) -> None:
    registry = open_registry(results)
    assert [item.kind for item in registry] == ["cell"], "what is sound stays in use"
    assert len(registry.damaged) == 1
    for sentence in (*registry.damaged, *problems(results)):
        assert str(entry.folder / "record.json") in sentence
        assert words in sentence
        assert len(sentence) < 600
    with pytest.raises(IntegrityError, match="is damaged"):
        registry.load(entry)
    Store(results).publish(cell(gap=0.5), "cell", recipe(gap=0.5))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (setting("samples", to=17), "samples 17, data.nc says 18"),
        (setting("failed", to=3), "failed 3, data.nc says 0"),
        (setting("scalars", "gap", to=0.5), "scalars {'gap': 0.5}, data.nc says {'gap': 0.4}"),
        (setting("scalars", "mesh_size", to=0.5), "data.nc says {'mesh_size': 'nothing'}"),
        (setting("sizes", "curvature", to=4), "data.nc says {'curvature': 3}"),
        (setting("recipe", "version", to=2), "recipe {'version': 2}"),
        (setting("code", "commit", to="abc"), "code {'commit': 'abc'}"),
        (setting("inputs", to=[{"id": "cell:" + "0" * 12, "content_digest": "0" * 64}]), "inputs"),
    ],
)
def test_labels_that_data_contradict_are_found(
    results: Path, entry: Entry, change: Callable[[dict[str, Any]], object], words: str
) -> None:
    edit_record(entry.folder, change)
    assert len(problems(results)) == 1
    assert words in problems(results)[0]
    with pytest.raises(IntegrityError, match="says"):
        open_registry(results).load(entry)


def test_a_newer_schema_is_refused_by_name(results: Path, entry: Entry) -> None:
    known = SCHEMAS["sweep"].name
    edit_record(entry.folder, setting("schema", to="sweep/9"))
    registry = open_registry(results)
    assert [item.kind for item in registry] == ["cell"]
    told = f"made by a newer FlexScale: schema sweep/9; this one knows {known}"
    assert told in registry.damaged[0]
    with pytest.raises(SchemaError, match=told):
        registry.load(entry)
    with pytest.raises(SchemaError, match=told):
        Store(results).lookup("sweep", recipe())


def test_an_older_schema_is_refused_by_name(results: Path, entry: Entry, monkeypatch) -> None:
    newer = {**SCHEMAS, "sweep": replace(SCHEMAS["sweep"], version=9)}
    monkeypatch.setattr("flexscale.datasets.record.SCHEMAS", newer)
    with pytest.raises(SchemaError, match="made by an older FlexScale: schema sweep/1"):
        open_registry(results).load(entry)


def test_a_record_of_another_folder_is_named(results: Path, entry: Entry) -> None:
    wrong = entry.folder.parents[1] / "octagon"
    entry.folder.parent.rename(wrong)
    told = open_registry(results).damaged
    assert len(told) == 1
    assert "belongs to sweep/IH20/hexagon/" in told[0]


def test_every_shipped_record_is_sound() -> None:
    registry = open_registry(Path(__file__).parents[2] / "results")
    shipped = registry.find(source="reference")
    assert len(shipped) > 50
    assert not [told for told in registry.damaged if "reference" in told]
    for entry in shipped:
        record = registry.record(entry)
        assert json.loads(json.dumps(record)) == record

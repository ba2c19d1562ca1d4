"""Queries, and the catalog as a cache that may be lost, stale or damaged."""

from __future__ import annotations

import json
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
import xarray as xr

from flexscale.cli import main
from flexscale.cli.data import _criterion
from flexscale.datasets.catalog import CATALOG_FILE
from flexscale.datasets.registry import Registry, between, open_registry
from flexscale.datasets.store import Store
from flexscale.errors import BadInputError, MissingDataError, UnitRangeError, UnknownNameError
from tests.datasets.dataset_samples import cell, recipe, sweep


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three sweeps and a cell; do not change it."""
    root = tmp_path_factory.mktemp("results")
    store = Store(root)
    store.publish(cell(), "cell", recipe())
    store.publish(sweep(), "sweep", recipe())
    store.publish(sweep(gap=0.5, failed=True), "sweep", recipe(gap=0.5))
    store.publish(sweep(family="IH76", pattern="square"), "sweep", recipe(family="IH76"))
    return root


@pytest.fixture
def registry(root: Path) -> Registry:
    return open_registry(root)


def test_no_criteria_mean_everything_sorted(registry: Registry) -> None:
    kinds = [(entry.kind, entry.row["family"]) for entry in registry.find()]
    assert kinds == [("cell", "IH20"), ("sweep", "IH20"), ("sweep", "IH20"), ("sweep", "IH76")]


def test_find_by_value_list_range_and_status(registry: Registry) -> None:
    assert len(registry.find(kind="sweep", family="IH20")) == 2
    assert len(registry.find(pattern=["hexagon", "square"])) == 4
    assert len(registry.find(kind="sweep", gap=0.5)) == 1
    assert len(registry.find(kind="sweep", gap=between(0.3, 0.5, "mm"))) == 3
    assert len(registry.find(kind="sweep", gap=between(0.41, 0.49, "mm"))) == 0
    assert len(registry.find(kind="sweep", status="complete")) == 2
    assert len(registry.find(kind="sweep").find(gap=0.5).find(family="IH76")) == 0
    assert len(registry.find(kind="tangent")) == 0, "a known kind without datasets is no error"


def test_selections_do_not_change(registry: Registry) -> None:
    everything = registry.find()
    everything.find(kind="cell")
    assert len(everything) == 4
    assert everything[1:3].table().shape[0] == 2


@pytest.mark.parametrize(
    ("criteria", "words"),
    [
        ({"patern": "square"}, "Did you mean 'pattern'"),
        ({"pattern": "hexagonn"}, "Did you mean 'hexagon'"),
        ({"kind": "swep"}, "Did you mean 'sweep'"),
        ({"status": "done"}, "Known: 'complete', 'unconverged'"),
    ],
)
def test_unknown_names_get_suggestions(registry: Registry, criteria, words: str) -> None:
    with pytest.raises(UnknownNameError, match=words):
        registry.find(**criteria)


def test_ranges_are_checked(registry: Registry) -> None:
    with pytest.raises(UnitRangeError, match="gap is in mm; a range in cm"):
        registry.find(gap=between(0.03, 0.05, "cm"))
    with pytest.raises(UnitRangeError, match="pattern is text"):
        registry.find(pattern=between(0, 1, "mm"))
    with pytest.raises(UnitRangeError, match="lower to its upper"):
        between(0.5, 0.3, "mm")
    with pytest.raises(UnitRangeError, match="gap must be a number in mm"):
        registry.find(gap="0.4")


def test_one_loads_the_only_dataset_or_lists_candidates(registry: Registry) -> None:
    assert isinstance(registry.one(kind="sweep", pattern="square"), xr.Dataset)
    with pytest.raises(MissingDataError, match="2 datasets") as caught:
        registry.one(kind="sweep", pattern="hexagon")
    assert "gap=0.4" in str(caught.value)
    assert "gap=0.5" in str(caught.value)
    with pytest.raises(MissingDataError, match="No dataset meets"):
        registry.one(kind="tangent")


@pytest.fixture
def alike(tmp_path: Path) -> Registry:
    """Sweeps that the catalog does not tell apart, of recipes that differ."""
    store = Store(tmp_path)
    for directions, across in (([0, 90], 2), ([0, 90], 4), (list(range(0, 180, 15)), 4)):
        parameters = {"directions": directions, "mesh": {"across": across}}
        store.publish(sweep(), "sweep", recipe(**parameters, contact={"enabled": across == 4}))
    return open_registry(tmp_path)


def test_candidates_are_told_apart_by_what_was_computed(alike: Registry) -> None:
    with pytest.raises(MissingDataError) as caught:
        alike.one(kind="sweep")
    told = str(caught.value)
    assert told.count("mesh.across=4") == 2
    assert told.count("directions=[0, 90]") == 2
    assert "directions=12 values from 0 to 165" in told
    assert "contact.enabled=False, directions=[0, 90], mesh.across=2" in told
    assert "commit" not in told
    assert f'registry.load("{alike.find()[0].id}")' in told


def test_parameters_of_recipes_can_be_asked_for(alike: Registry) -> None:
    assert len(alike.find(directions=[0, 90])) == 2
    assert len(alike.find(directions=(0.0, 90.0 + 1e-12))) == 2
    assert len(alike.find(**{"mesh.across": 4})) == 2
    assert len(alike.find(kind="sweep", directions=[0, 90], **{"mesh.across": 4})) == 1
    assert len(alike.find(directions=range(0, 180, 15))) == 1
    assert len(alike.find(**{"contact.enabled": True})) == 2
    assert not alike.find(**{"contact.enabled": 1}), "a switch is no number"
    assert not alike.find(directions=[0])
    with pytest.raises(UnknownNameError, match="Did you mean 'directions'"):
        alike.find(directoins=[0, 90])
    assert not alike.find(**{"mesh.across": 10**400})
    with pytest.raises(UnitRangeError, match=r"mesh.across is a parameter .* by value, not by a"):
        alike.find(**{"mesh.across": between(2, 4, "1")})


def test_recipes_damaged_since_are_left_out(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    store = Store(tmp_path)
    entry = store.publish(sweep(), "sweep", recipe())
    registry = open_registry(tmp_path)
    (entry.folder / "record.json").write_text('{"sizes": [1]}')
    with pytest.raises(UnknownNameError, match="have these recipes"):
        registry.find(directions=[0, 90])
    assert "left out" in caplog.text


def test_the_command_line_asks_for_the_same(
    alike: Registry, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def listed(*criteria: str) -> int:
        arguments = ["flexscale", "data", "list", *criteria, "--json", "--results"]
        monkeypatch.setattr(sys, "argv", [*arguments, str(alike.root)])
        with pytest.raises(SystemExit):
            main.main()
        return len(json.loads(capsys.readouterr().out))

    assert listed("source=local", "directions=0,90", "mesh.across=4") == 1
    assert listed("contact.enabled=true") == 2
    assert listed("pattern=hexagon,hexagon") == 3
    assert _criterion("pattern=488,4.8") == ("pattern", ["488", "4.8"])
    assert _criterion("gap=0.4") == ("gap", 0.4)


def test_short_ids(registry: Registry) -> None:
    entry = registry.find(kind="cell").one()
    assert registry.get(entry.id) == entry
    assert registry.get(entry.id[:9]) == entry
    square = registry.find(pattern="square").one()
    assert registry.load(square.recipe_digest[:8])["pattern"] == "square"
    with pytest.raises(MissingDataError, match="not unique"):
        registry.get(entry.recipe_digest[:8])  # a sweep of the same recipe shares the digits
    with pytest.raises(MissingDataError, match="no dataset 'sweep:zzzz'"):
        registry.get("sweep:zzzz")
    with pytest.raises(MissingDataError, match="no dataset ''"):
        registry.get("")


def test_tables_have_units_in_their_header(registry: Registry) -> None:
    table = registry.table()
    assert table.loc[registry.find(kind="cell").one().id, "gap [mm]"] == 0.4
    assert "tile_area [mm2]" not in table.columns, "empty columns are left out"


def test_the_registry_shows_itself(registry: Registry) -> None:
    lines = repr(registry).splitlines()
    assert "4 datasets" in lines[0]
    assert lines[-1].split() == ["sweep", "IH76", "1", "0"]
    assert "<td>IH20</td><td>2</td><td>1</td>" in registry._repr_html_()


def test_an_empty_folder_is_fine_until_one_asks_for_something(tmp_path: Path) -> None:
    registry = open_registry(tmp_path / "nothing")
    assert len(registry.find()) == 0
    with pytest.raises(MissingDataError, match="no dataset yet"):
        registry.find(pattern="hexagon")
    assert not (tmp_path / "nothing").exists()


@pytest.mark.parametrize("use", [open_registry, Store])
def test_a_layer_is_no_results_folder(
    root: Path, use: Callable[[Path], object], monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(BadInputError, match=f"Give the folder around it, {root}.$"):
        use(root / "local")
    monkeypatch.chdir(root / "local")
    with pytest.raises(BadInputError, match=f"Give the folder around it, {root}.$"):
        use(Path("."))
    monkeypatch.chdir(root)
    use(Path("."))


def test_a_layer_without_a_catalog_is_seen_too(tmp_path: Path) -> None:
    store = Store(tmp_path / "results")
    store.publish(cell(), "cell", recipe())
    (store.local / CATALOG_FILE).unlink()
    with pytest.raises(BadInputError, match="one layer of a results folder"):
        open_registry(store.local)


def test_the_registry_answers_for_its_selections(registry: Registry) -> None:
    assert list(registry.table(kind="cell").index) == [registry.find(kind="cell").one().id]
    assert list(registry.to_tree(kind="sweep", pattern="square").children) == ["IH76"]
    assert registry.stack("gap", kind="sweep", pattern="hexagon").sizes["gap"] == 2


@pytest.fixture
def layered(tmp_path: Path) -> Path:
    """A hexagon in the reference; locally the same again, and one of another gap."""
    shipped = Store(tmp_path / "shipped").publish(sweep(), "sweep", recipe())
    target = tmp_path / "results" / "reference" / shipped.row["path"]
    shutil.copytree(shipped.folder, target)
    store = Store(tmp_path / "results")
    shutil.copytree(shipped.folder, store.local / shipped.row["path"])
    store.publish(sweep(gap=0.5), "sweep", recipe(gap=0.5))
    return store.root


def test_source_says_which_collection_is_meant(layered: Path) -> None:
    registry = open_registry(layered)
    with pytest.raises(MissingDataError, match="2 datasets"):
        registry.one(kind="sweep", pattern="hexagon")
    assert registry.one(kind="sweep", pattern="hexagon", source="reference")["gap"] == 0.4
    assert len(registry.find(source="local")) == 2
    assert len(registry.find(kind="sweep").find(source="reference")) == 1
    assert len(registry.find(source=["local", "reference"])) == 3
    assert [entry.source for entry in registry] == ["local", "local"], "local before reference"
    assert set(registry.table()["source"]) == {"local"}
    with pytest.raises(UnknownNameError, match="Did you mean 'reference'"):
        registry.find(source="referenec")


def test_other_criteria_are_those_of_the_copy_that_is_meant(layered: Path) -> None:
    path = layered / "local" / CATALOG_FILE
    mine = open_registry(layered).find(source="local", gap=0.4).one()
    path.write_text(path.read_text().replace(f",{mine.row['commit']},", ",abcdef0,"))
    registry = open_registry(layered)
    for first, second in (("local", "abcdef0"), ("reference", mine.row["commit"])):
        for criteria in ({"source": first, "commit": second}, {"commit": second, "source": first}):
            assert registry.find(gap=0.4, **criteria).one().source == first
    assert not registry.find(source="reference", commit="abcdef0")


def test_an_empty_source_is_no_error(registry: Registry) -> None:
    assert len(registry.find(source="reference")) == 0

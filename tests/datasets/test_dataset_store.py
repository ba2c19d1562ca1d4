"""Publishing and loading: verified, reproducible, one clear sentence when damaged."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from flexscale.datasets.audit import check_results
from flexscale.datasets.export import describe_text, export
from flexscale.datasets.identity import Recipe
from flexscale.datasets.kinds.tangent import build_tangent_dataset
from flexscale.datasets.registry import open_registry
from flexscale.datasets.store import Entry, Store
from flexscale.errors import (
    BadInputError,
    ConfigError,
    DatasetError,
    IntegrityError,
    NonReproducibleError,
    SchemaError,
)
from tests.datasets.dataset_samples import SCALARS, cell, recipe, sweep


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store(tmp_path / "results")


def publish(store: Store, **changes: object) -> Entry:
    return store.publish(sweep(**changes), "sweep", recipe())  # type: ignore[arg-type]


def files_below(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


def test_a_published_dataset_comes_back_identical(store: Store) -> None:
    original = sweep(failed=True)
    entry = store.publish(original, "sweep", recipe(), record={"seconds": 1.5, "memory": np.nan})
    loaded = store.load(entry)
    xr.testing.assert_identical(loaded.drop_attrs(deep=False), original.drop_attrs(deep=False))
    assert loaded.attrs["flexscale_recipe_digest"] == entry.recipe_digest
    assert json.loads(loaded.attrs["flexscale_config"]) == {"pattern": {"gap": 0.4}, "names": None}
    record = store.record(entry)
    assert record["run"] == {"seconds": 1.5, "memory": None}
    assert (entry.row["samples"], entry.row["failed"]) == (18, 1)
    assert entry.folder == store.local / "sweep" / "IH20" / "hexagon" / entry.recipe_digest[:12]


def test_meshes_without_scales_come_back_too(store: Store) -> None:
    bare = cell().isel(tet=[], tet_corner=slice(None))
    entry = store.publish(bare, "cell", recipe())
    assert store.load(entry).sizes["tet"] == 0


def test_a_sheet_can_be_drawn_without_keeping_its_file_open(store: Store) -> None:
    entry = publish(store)
    loaded = store.load(entry)
    (entry.folder / "data.nc").unlink()
    assert np.isfinite(loaded["moment"]).all()


def test_nothing_but_the_dataset_stays_behind(store: Store) -> None:
    entry = publish(store)
    here = entry.folder.relative_to(store.local)
    assert files_below(store.local) == sorted(
        [".lock", "catalog.csv", f"{here}/data.nc", f"{here}/record.json"]
    )


def test_lookup_finds_what_was_published_and_only_that(store: Store) -> None:
    assert store.lookup("sweep", recipe()) is None
    assert not store.root.exists(), "asking must not create folders"
    entry = publish(store)
    assert store.lookup("sweep", recipe()) == entry
    assert store.lookup("sweep", recipe(gap=0.5)) is None
    assert store.lookup("cell", recipe()) is None


def test_content_of_inputs_is_part_of_the_identity(store: Store) -> None:
    first = store.publish(cell(), "cell", recipe(across=2))
    other = store.publish(cell(gap=0.5), "cell", recipe(across=4))
    made = store.publish(sweep(), "sweep", recipe(), [first])
    assert store.lookup("sweep", recipe(), [first]) == made
    assert store.lookup("sweep", recipe(), [other]) is None
    assert store.lookup("sweep", recipe()) is None
    assert json.loads(store.load(made).attrs["flexscale_inputs"]) == [first.id]


def test_reference_results_are_found_and_local_ones_come_first(store: Store) -> None:
    entry = publish(store)
    store.local.rename(store.reference)
    found = store.lookup("sweep", recipe())
    assert found is not None
    assert found.folder == store.reference / entry.row["path"]
    again = publish(store)
    assert store.lookup("sweep", recipe()) == again
    registry = open_registry(store.root)
    assert [item.folder for item in registry] == [again.folder]


def test_equal_content_again_is_accepted_and_changes_nothing(store: Store) -> None:
    entry = publish(store)
    before = (entry.folder / "record.json").read_bytes()
    assert publish(store) == entry
    assert (entry.folder / "record.json").read_bytes() == before


def test_other_numbers_for_the_same_recipe_are_refused(store: Store) -> None:
    entry = publish(store)
    before = files_below(store.local)
    with pytest.raises(NonReproducibleError, match=r"moment differs by at most .* N\."):
        publish(store, factor=1.5)
    assert files_below(store.local) == before
    np.testing.assert_array_equal(store.load(entry)["moment"], sweep()["moment"])


def test_an_invalid_dataset_leaves_nothing(store: Store) -> None:
    broken = sweep()
    broken["moment"].attrs["units"] = "kN"
    with pytest.raises(SchemaError, match="kN"):
        store.publish(broken, "sweep", recipe())
    with pytest.raises(SchemaError, match="letters, digits"):
        store.publish(sweep(pattern="../../escape"), "sweep", recipe())
    assert not store.root.exists()


def test_a_failing_write_leaves_nothing(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    def disk_full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(xr.Dataset, "to_netcdf", disk_full)
    with pytest.raises(DatasetError, match=r"cannot be written: No space left on device\. Check"):
        publish(store)
    assert files_below(store.root) == ["local/.lock"]


@pytest.mark.parametrize(
    "error", [RuntimeError("NetCDF: HDF error"), PermissionError(13, "Permission denied")]
)
def test_a_full_disk_is_named_where_the_library_does_not(
    store: Store, monkeypatch: pytest.MonkeyPatch, error: Exception
) -> None:
    def disk_full(*_: object, **__: object) -> None:
        raise error

    def refuse(path: Path, data: bytes) -> int:
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr(xr.Dataset, "to_netcdf", disk_full)
    with pytest.raises(DatasetError, match=r"cannot be written: .*(HDF|denied)"):
        publish(store)
    monkeypatch.setattr(Path, "write_bytes", refuse)
    with pytest.raises(DatasetError, match=r"cannot be written: No space left on device\. Check"):
        publish(store)


def truncated(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-100])


def one_bit_flipped(path: Path) -> None:
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)


def emptied(path: Path) -> None:
    path.write_bytes(b"")


def replaced_by_a_folder(path: Path) -> None:
    path.unlink()
    path.mkdir()


@pytest.mark.parametrize("name", ["data.nc", "record.json"])
@pytest.mark.parametrize(
    "damage", [truncated, one_bit_flipped, emptied, replaced_by_a_folder, Path.unlink]
)
def test_damage_is_one_clear_sentence_everywhere(store: Store, damage, name: str) -> None:
    entry = publish(store)
    damage(entry.folder / name)
    if name == "record.json" and damage is one_bit_flipped:
        # A flip may hit free text of the record; then the digests still protect the data.
        (entry.folder / name).write_bytes(b"{" + (entry.folder / name).read_bytes())
    for action in (
        lambda: store.load(entry),
        lambda: store.lookup("sweep", recipe()),
        lambda: publish(store),
    ):
        with pytest.raises(IntegrityError) as caught:
            action()
        text = str(caught.value)
        assert name in text
        assert "\n" not in text
        assert str(entry.folder) in text
    problems = [item for item in check_results(store.root) if item.level == "problem"]
    assert [item.subject for item in problems] == [entry.row["path"]]


def test_a_dataset_in_the_wrong_folder_is_noticed(store: Store) -> None:
    entry = publish(store)
    moved = entry.folder.with_name("0" * 12)
    entry.folder.rename(moved)
    registry = open_registry(store.root)
    assert len(registry) == 0
    assert "belongs to" in registry.damaged[0]


def test_check_finds_a_dataset_made_to_look_right(store: Store) -> None:
    """Someone edits numbers and puts the new file digest into the record."""
    entry = publish(store)
    other = Store(store.root.parent / "other")
    forged = publish(other, factor=2.0)
    record = store.record(entry)
    record["file_sha256"] = other.record(forged)["file_sha256"]
    (entry.folder / "data.nc").write_bytes((forged.folder / "data.nc").read_bytes())
    (entry.folder / "record.json").write_text(json.dumps(record))
    problems = [item.message for item in check_results(store.root) if item.level == "problem"]
    assert len(problems) == 1
    assert "recorded digest" in problems[0]


def test_check_reports_stale_inputs_and_unfinished_work(store: Store) -> None:
    source = store.publish(cell(), "cell", recipe())
    store.publish(sweep(failed=True), "sweep", recipe(), [source])
    store.checkpoint(recipe(gap=0.5)).append("closing 0", {"moment": 1.0})
    levels = {(item.level, item.message[:10]) for item in check_results(store.root)}
    assert {level for level, _ in levels} <= {"ok", "note"}
    assert ("note", "Unfinished") in levels
    assert ("note", "1 of 18 sa") in levels
    for path in source.folder.iterdir():
        path.unlink()
    source.folder.rmdir()
    store.publish(cell(gap=0.41), "cell", recipe())
    problems = [item.message for item in check_results(store.root) if item.level == "problem"]
    assert problems == [f"It is stale: its input {source.id} has other content now."]


def test_unreadable_results_folder_gives_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "results").write_text("a file, not a folder")
    with pytest.raises(DatasetError, match=r"cannot be written: Not a directory\."):
        Store(tmp_path / "results").publish(sweep(), "sweep", recipe())
    assert len(open_registry(tmp_path / "results")) == 0


def test_publishing_clears_the_checkpoint(store: Store) -> None:
    checkpoint = store.checkpoint(recipe())
    checkpoint.append("closing 0", {"moment": 1.0})
    publish(store)
    assert store.checkpoint(recipe()).load("closing 0") == []
    assert not checkpoint.folder.exists()


def test_samples_left_by_a_kill_after_publishing_are_cleared(store: Store) -> None:
    publish(store)
    checkpoint = store.checkpoint(recipe())
    checkpoint.append("closing 0", {"moment": 1.0})
    store.lookup("sweep", recipe(gap=0.5))
    assert checkpoint.folder.exists()
    store.lookup("sweep", recipe())
    assert not checkpoint.folder.exists()


def test_the_csv_of_a_tangent_holds_both_matrices(store: Store, tmp_path: Path) -> None:
    matrix = np.array([[4.0, 1.0, 0.5], [1.0, 3.0, 0.25], [0.5, 0.25, 2.0]])
    dataset = build_tangent_dataset(
        matrix, 10.0 * matrix, [0.0, 30.0], scalars=SCALARS, config={"name": "x"}
    )
    entry = store.publish(dataset, "tangent", Recipe("tangent", 1, {}))
    table = pd.read_csv(export(entry, tmp_path, "csv"))
    assert list(table["direction [degree]"]) == [0.0, 30.0]
    components = ("xx", "yy", "xy")
    for name, unit, expected in (
        ("matrix", "N mm", matrix),
        ("in_plane", "N mm-1", 10.0 * matrix),
    ):
        read = [[table[f"{name}_{a}_{b} [{unit}]"] for b in components] for a in components]
        np.testing.assert_array_equal(np.array(read)[..., 0], expected)
        np.testing.assert_array_equal(np.array(read)[..., 1], expected)
    assert table["stiffness [N mm]"][0] == 4.0


def test_export_and_description(store: Store, tmp_path: Path) -> None:
    entry = publish(store)
    copy = export(entry, tmp_path)
    assert copy.read_bytes() == (entry.folder / "data.nc").read_bytes()
    table = export(entry, tmp_path, "csv").read_text().splitlines()
    assert len(table) == 1 + 18
    assert "moment [N]" in table[0]
    assert "stretch_xx" in table[0]
    copy.write_text("mine")
    with pytest.raises(BadInputError, match="is there already"):
        export(entry, tmp_path)
    assert copy.read_text() == "mine"
    assert export(entry, tmp_path, replace=True) == copy
    assert copy.read_bytes() == (entry.folder / "data.nc").read_bytes()
    with pytest.raises(ConfigError, match="no folder"):
        export(entry, tmp_path / "nowhere")
    with pytest.raises(ConfigError, match="Did you mean 'csv'"):
        export(entry, tmp_path, "cvs")
    text = describe_text(entry)
    assert entry.id in text
    assert "curvature [mm-1]  (curvature 3)" in text

"""Lineage, differences and trees."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from flexscale.datasets.registry import open_registry
from flexscale.datasets.store import Store
from tests.datasets.dataset_samples import cell, recipe, sweep


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store(tmp_path)


def test_lineage_lists_inputs_before_results(store: Store) -> None:
    source = store.publish(cell(), "cell", recipe(across=2))
    made = store.publish(sweep(), "sweep", recipe(), [source])
    table = open_registry(store.root).lineage(made.id)
    assert list(table.index) == [source.id, made.id]
    assert table.loc[made.id, "inputs"] == source.id
    shutil.rmtree(source.folder)
    table = open_registry(store.root).lineage(made.id)
    assert table.loc[source.id, "created"] == "not here"


def test_diff_names_recipe_keys_and_largest_differences(store: Store) -> None:
    first = store.publish(sweep(), "sweep", recipe(mesh={"across": 2}))
    second = store.publish(sweep(gap=0.5, factor=3.0), "sweep", recipe(mesh={"across": 4}))
    table = open_registry(store.root).diff(first.id, second.id).set_index("what")
    assert sorted(table.index) == ["gap", "moment", "parameters.mesh.across"]
    assert tuple(table.loc["parameters.mesh.across", ["first", "second"]]) == (2, 4)
    moment = float(sweep()["moment"].max())
    assert table.loc["moment", "largest"] == pytest.approx(2.0 * moment, rel=1e-12)
    assert table.loc["moment", "unit"] == "N"
    assert table.loc["gap", "largest"] == pytest.approx(0.1)
    assert open_registry(store.root).diff(first.id, first.id).empty


def test_trees_follow_family_and_pattern(store: Store) -> None:
    store.publish(sweep(family="IH76", pattern="square"), "sweep", recipe(a=1))
    pair = [store.publish(sweep(gap=gap), "sweep", recipe(gap=gap)) for gap in (0.4, 0.5)]
    tree = open_registry(store.root).find(kind="sweep").to_tree()
    assert tree["/IH76/square/moment"].attrs["units"] == "N"
    for entry, gap in zip(pair, (0.4, 0.5), strict=True):
        assert tree[f"/IH20/hexagon/sweep_{entry.folder.name}/gap"] == gap

"""Stacking datasets along a property: equal axes only, and nothing filled or left out."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from flexscale.datasets.kinds.sweep import build_sweep_dataset
from flexscale.datasets.registry import Registry, open_registry
from flexscale.datasets.store import Store
from flexscale.errors import MissingDataError, SchemaError, UnknownNameError
from tests.datasets.dataset_samples import SCALARS, cell, recipe, sweep, sweep_arrays


@pytest.fixture
def registry(tmp_path: Path) -> Registry:
    """Three sweeps on equal axes, one on others, one more of the hexagon, and a cell."""
    store = Store(tmp_path)
    for pattern, factor in (("hexagon", 1.0), ("brick", 2.0), ("square", 3.0)):
        store.publish(sweep(pattern=pattern, factor=factor), "sweep", recipe(pattern=pattern))
    directions, curvatures = np.array([0.0, 45.0, 90.0]), np.array([0.0, 0.01, 0.03])
    arrays = sweep_arrays((2, 3, 3), curvatures)
    odd = build_sweep_dataset(
        ["closing", "opening"],
        directions,
        curvatures,
        arrays,
        scalars={**SCALARS, "pattern": "odd"},
        config={},
    )
    store.publish(odd, "sweep", recipe(pattern="odd"))
    store.publish(sweep(gap=0.5), "sweep", recipe(pattern="hexagon", gap=0.5))
    store.publish(cell(), "cell", recipe())
    return open_registry(tmp_path)


def test_values_are_those_of_each_dataset_under_its_name(registry: Registry) -> None:
    stacked = registry.find(kind="sweep", pattern=["hexagon", "brick", "square"], gap=0.4).stack(
        "pattern"
    )
    assert sorted(stacked["pattern"].values) == ["brick", "hexagon", "square"]
    for pattern, factor in (("hexagon", 1.0), ("brick", 2.0), ("square", 3.0)):
        one = stacked.sel(pattern=pattern)
        np.testing.assert_array_equal(one["moment"].values, sweep(factor=factor)["moment"].values)
        assert registry.get(str(one["dataset_id"].values)).row["pattern"] == pattern
    assert stacked["moment"].dims == ("pattern", "side", "direction", "curvature")
    assert stacked["moment"].attrs["units"] == "N"
    assert stacked["status"].dtype == np.int8, "filling would have made it a float"
    assert stacked["gap"].dims == ("pattern",)
    assert stacked["direction_rad"].dims == ("direction",)


def test_other_properties_are_axes_too(registry: Registry) -> None:
    stacked = registry.find(kind="sweep", pattern="hexagon").stack("gap")
    assert sorted(stacked["gap"].values) == [0.4, 0.5]
    assert list(stacked["pattern"].values) == ["hexagon", "hexagon"]


def test_an_odd_grid_is_named_and_not_merged(registry: Registry) -> None:
    odd = registry.find(pattern="odd").one()
    with pytest.raises(SchemaError, match=f"{odd.id} .*curvature|curvature.* {odd.id}"):
        registry.find(kind="sweep", gap=0.4).stack("pattern")


def test_kinds_doubles_and_nothing_are_refused(registry: Registry) -> None:
    with pytest.raises(SchemaError, match=r"sweep:\w+ is no cell"):
        registry.find(pattern="hexagon", gap=0.4).stack("pattern")
    with pytest.raises(MissingDataError, match="Several datasets have pattern 'hexagon'"):
        registry.find(kind="sweep", pattern=["hexagon", "brick"]).stack("pattern")
    with pytest.raises(MissingDataError, match="no dataset to stack"):
        registry.find(kind="fit").stack("pattern")
    with pytest.raises(UnknownNameError, match="Did you mean 'pattern'"):
        registry.find(kind="sweep").stack("patterns")

"""Digests depend on what is meant, and on nothing else."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

from flexscale.datasets.identity import Recipe, canonical_json, content_digest
from flexscale.errors import ConfigError

numbers = st.floats(allow_nan=False, allow_infinity=False) | st.integers(-(2**60), 2**60)
leaves = numbers | st.text() | st.booleans() | st.none()
nested = st.recursive(
    leaves,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=4),
    max_leaves=20,
)


@given(nested)
def test_canonical_json_keeps_the_data(value: Any) -> None:
    assert json.loads(canonical_json(value)) == value


@given(st.dictionaries(st.text(), nested, min_size=2, max_size=6))
def test_order_of_keys_does_not_matter(parameters: dict[str, Any]) -> None:
    turned = dict(reversed(parameters.items()))
    assert Recipe("sweep", 1, parameters).digest() == Recipe("sweep", 1, turned).digest()


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_the_type_of_a_number_does_not_matter(number: float) -> None:
    assert canonical_json([number]) == canonical_json(np.array([number]))
    assert canonical_json(np.float64(number)) == canonical_json(number)
    if number.is_integer() and abs(number) < 2**53:
        assert canonical_json(int(number)) == canonical_json(number)


@given(st.floats(-1e6, 1e6), st.floats(-1e6, 1e6))
def test_different_numbers_have_different_digests(a: float, b: float) -> None:
    same = Recipe("s", 1, {"gap": a}).digest() == Recipe("s", 1, {"gap": b}).digest()
    assert same == (a == b)


@given(st.lists(st.text(min_size=1), min_size=2, max_size=4, unique=True))
def test_inputs_count_by_content_not_by_order(digests: list[str]) -> None:
    recipe = Recipe("sweep", 1, {})
    assert recipe.digest(digests) == recipe.digest(reversed(digests))
    assert recipe.digest(digests) != recipe.digest(digests[1:])


def test_a_recipe_survives_its_dict_and_its_version_counts() -> None:
    recipe = Recipe("sweep", 2, {"directions": np.array([0.0, 22.5]), "name": None})
    assert (
        Recipe.from_dict(json.loads(canonical_json(recipe.to_dict()))).digest() == recipe.digest()
    )
    assert Recipe("sweep", 3, recipe.parameters).digest() != recipe.digest()


@pytest.mark.parametrize("bad", [float("nan"), float("inf"), {1: 2}, object(), {"a": {2}}])
def test_what_has_no_canonical_form_is_refused_by_name(bad: Any) -> None:
    with pytest.raises(ConfigError, match=r"parameters\.mesh"):
        Recipe("sweep", 1, {"mesh": bad}).digest()


arrays = st.lists(st.floats(width=64), min_size=1, max_size=8).map(np.array)


def dataset(values: np.ndarray, **attrs: str) -> xr.Dataset:
    return xr.Dataset(
        {"moment": ("sample", values, {"units": "N", **attrs})}, coords={"name": "hexagon"}
    )


@given(arrays)
def test_content_ignores_byte_order_layout_and_other_attributes(values: np.ndarray) -> None:
    digest = content_digest(dataset(values))
    assert content_digest(dataset(values.astype(">f8"))) == digest
    assert content_digest(dataset(np.repeat(values, 2)[::2], comment="text")) == digest
    assert content_digest(dataset(values).assign_coords(name=np.array("hexagon", object))) == digest


@given(arrays, st.data())
def test_content_sees_every_value_and_the_units(values: np.ndarray, data: st.DataObject) -> None:
    digest = content_digest(dataset(values))
    index = data.draw(st.integers(0, values.size - 1))
    changed = values.copy()
    changed[index] = data.draw(st.floats(width=64))
    equal = np.array_equal(changed, values, equal_nan=True)
    assert (content_digest(dataset(changed)) == digest) == equal
    assert content_digest(dataset(values, units="kN")) != digest
    assert content_digest(dataset(values).rename(moment="force")) != digest
    assert content_digest(dataset(values).rename(sample="point")) != digest

"""Values that nobody should give, and changes of values that were right."""

from __future__ import annotations

import datetime
import decimal
import fractions
import math
import random
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr


def _nested(levels: int) -> list[Any]:
    found: list[Any] = []
    for _ in range(levels):
        found = [found]
    return found


def _endless() -> list[Any]:
    found: list[Any] = []
    found.append(found)
    return found


NUMBERS: list[Any] = [
    math.nan, math.inf, -math.inf, 0, 0.0, -0.0, -1, -0.4, 1e300, -1e300, 1e-300, 5e-324, 1e-12,
    1e12, 10**400, -(10**400), 0.5, 1, 2, 3, 17, 180, 360, 1e6, 2**63, 1e5, 1e-5,
]  # fmt: skip
OTHERS: list[Any] = [
    None, True, False, "", "0.4", "0.4 mm", "closing", "nan", "IH76", "x" * 5000, "é\0\x1b[31m",
    b"0.4", 1 + 2j, decimal.Decimal("0.4"), fractions.Fraction(2, 5), object(), int, len, ...,
    datetime.date(2020, 1, 1), Path("nowhere"), [], {}, (), set(), [math.nan], [0, math.inf],
    [1, "a"], ["closing"], ["closing", "closing"], [None], [True], [[1, 2], [3]], [[]], [[[1.0]]],
    [0, 0], [1, 0], {"a": 1}, {0: 1}, {1.5, 2.5}, range(0), range(3), range(10**12),
    iter([1.0, 2.0]), np.array(0.4), np.array("0.4"), np.array(math.nan), np.float32(0.4),
    np.int8(3), np.bool_(True), np.array([]), np.array([0.1, math.nan]), np.array([1j]),
    np.array(["closing"]), np.array([None]), np.array([10**400], dtype=object), np.zeros((2, 2)),
    np.zeros((2, 3, 4)), np.eye(2), np.eye(3), np.ma.masked, np.ma.array([1.0, 2.0], mask=[0, 1]),
    np.array(["2020-01-01"], dtype="datetime64[D]"), np.zeros(2, dtype=[("a", float)]),
    np.linspace(0.0, 1.0, 7), xr.DataArray(0.4), xr.DataArray([0.0, 0.4]), xr.Dataset(),
    _nested(5), _nested(200), _endless(), [0.1] * 200_000,
]  # fmt: skip


def has_infinity_or_nan(value: Any) -> bool:
    """Whether there is a number in a value that is not finite; datasets do not count."""
    if isinstance(value, xr.Dataset):
        return False
    if isinstance(value, dict):
        return any(map(has_infinity_or_nan, value.values()))
    if isinstance(value, list | tuple) and len(value) < 1000:
        return any(item is not value and has_infinity_or_nan(item) for item in value)
    try:
        array = np.asarray(value)
    except (TypeError, ValueError, OverflowError, RecursionError):
        return False
    return array.dtype.kind == "f" and not np.isfinite(array).all()


def mutated(value: Any, chance: random.Random) -> Any:
    """Something else in the place of a value: anything, or the value changed somewhere."""
    if isinstance(value, xr.Dataset) and chance.random() < 0.8:
        return changed_dataset(value, chance)
    draw = chance.random()
    if draw < 0.3:
        return chance.choice(NUMBERS)
    if draw < 0.55:
        return chance.choice(OTHERS)
    return _changed(value, chance)


def _changed(value: Any, chance: random.Random) -> Any:
    if isinstance(value, bool) or value is None:
        return chance.choice([*NUMBERS, *OTHERS])
    if isinstance(value, int | float):
        factors = [0.0, -1.0, 1e-9, 1e-3, 0.3, 0.999, 1.001, 3.0, 1e3, 1e9, math.nan, math.inf]
        return chance.choice([value * chance.choice(factors), [value], (value, value), str(value)])
    if isinstance(value, str):
        changes = [value[:-1], value + "x", value.upper(), [value], "", value * 100, value + "\n"]
        return chance.choice(changes)
    if isinstance(value, dict) and value:
        changed = dict(value)
        key = chance.choice(list(value))
        if chance.random() < 0.5:
            changed[key] = mutated(value[key], chance)
        else:
            changed[chance.choice(["", "z", 3, None, "a", (1, 2)])] = changed.pop(key)
        return changed
    if isinstance(value, np.ndarray):
        return _changed(value.tolist(), chance)
    if isinstance(value, list | tuple) and value:
        items = list(value)
        place = chance.randrange(len(items))
        how = chance.randrange(6)
        if how == 0:
            del items[place]
        elif how == 1:
            items.insert(place, items[place])
        elif how == 2:
            items.reverse()
        elif how == 3:
            return items[place]
        else:
            items[place] = mutated(items[place], chance)
        return items if chance.random() < 0.7 else tuple(items)
    return chance.choice([*NUMBERS, *OTHERS])


def changed_dataset(dataset: xr.Dataset, chance: random.Random) -> Any:
    """A dataset with something removed, renamed, of another type, selected, or emptied."""
    name = chance.choice(sorted(map(str, dataset.variables)))
    how = chance.randrange(8)
    if how == 0:
        return dataset.drop_vars(name)
    if how == 1:
        return dataset.rename({name: f"{name}_"})
    if how == 2:
        return dataset.assign({name: dataset[name].astype(str)})
    if how == 3 and dataset.dims:
        dim = chance.choice(sorted(map(str, dataset.dims)))
        return dataset.isel({dim: chance.choice([0, slice(0, 0), slice(0, 1), [0], [0, 0]])})
    if how == 4 and dataset[name].dtype.kind == "f":
        return dataset.assign({name: dataset[name] * chance.choice([math.nan, -1.0, 0.0, 1e9])})
    if how == 5:
        changed = dataset.copy()
        changed.attrs["flexscale_config"] = chance.choice(["{", "[]", 3, "{}", None])
        return changed
    if how == 6:
        return dataset[name]
    return dataset.transpose(*reversed(list(dataset.dims)))

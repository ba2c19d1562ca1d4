"""Random damage to a results folder, by somebody who signs what they changed."""

from __future__ import annotations

import json
import random
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from tests.datasets.results_samples import forget_catalog, sign

#: Values that have no place in most places.
ODD: tuple[Any, ...] = (
    *(None, True, -1, 0, 1e308, -1e-300, 10**30, 2**63, "", "abc", "../../x", "a/b", "..", "."),
    *("\x1b[2J\x1b]0;x\x07", "‮gnp", "\ud800", "\x00", "é", "x" * 5000, "9" * 300, [1], []),
    *({}, {"a": 1}, [[[[]]]], ["\x1b[31m"], "sweep/99", "tangent/1", "nan", 1.5, "2026-13-45"),
)
#: Texts that no JSON writer makes.
ODD_TEXTS = ("NaN", "Infinity", "1e999", "9" * 5000, "[" * 100_000, '{"a":' * 100_000, "tru", '"\\')


def mutate(folder: Path, rng: random.Random) -> str:
    """Change one thing in a dataset's folder; says what."""
    way = rng.choice((_record_value, _record_value, _record_text, _bytes, _attribute, _array))
    told = way(folder, rng)
    forget_catalog(folder)
    return f"{way.__name__}: {told}"


def _places(data: Any) -> list[tuple[Any, Any]]:
    """(container, key) of every value of nested data."""
    found: list[tuple[Any, Any]] = []
    items = data.items() if isinstance(data, dict) else enumerate(data)
    for key, value in items:
        found.append((data, key))
        if isinstance(value, dict | list):
            found += _places(value)
    return found


def _record_value(folder: Path, rng: random.Random) -> str:
    record = json.loads((folder / "record.json").read_text())
    inside, key = rng.choice(_places(record))
    if rng.random() < 0.2:
        del inside[key]
        told = f"without {key}"
    else:
        inside[key] = rng.choice(ODD)
        told = f"{key} = {inside[key]!r:.40}"
    if rng.random() < 0.1:
        record[rng.choice(("new", "schema", "kind"))] = rng.choice(ODD)
    (folder / "record.json").write_text(json.dumps(record))
    return told


def _record_text(folder: Path, rng: random.Random) -> str:
    path = folder / "record.json"
    content = path.read_bytes()
    start = rng.randrange(len(content))
    odd = rng.choice(ODD_TEXTS).encode()
    length = rng.choice((0, 1, 5, 100))
    if rng.random() < 0.5:
        odd = bytes(rng.randrange(256) for _ in range(rng.randrange(1, 4)))
    path.write_bytes(content[:start] + odd + content[start + length :])
    return f"{odd[:20]!r} at {start}"


def _bytes(folder: Path, rng: random.Random) -> str:
    path = folder / "data.nc"
    content = bytearray(path.read_bytes())
    places = [rng.randrange(len(content)) for _ in range(rng.choice((1, 1, 3, 20)))]
    for place in places:
        content[place] = rng.choice((0, 255, content[place] ^ (1 << rng.randrange(8))))
    if rng.random() < 0.1:
        del content[rng.randrange(len(content)) :]
    path.write_bytes(content)
    sign(folder)
    return f"at {places[:3]}"


def _attribute(folder: Path, rng: random.Random) -> str:
    with h5py.File(folder / "data.nc", "r+") as file:
        item = file[rng.choice([*file, "/"])]
        names = [*item.attrs, "scale_factor", "add_offset", "_FillValue", "missing_value", "units"]
        names += ["coordinates", "calendar", "dtype", "flag_values", "_Unsigned", "valid_min"]
        name = rng.choice(names)
        value = rng.choice((*ODD, "days since 2000-01-01", "seconds since 0", np.zeros(3), b"\xff"))
        told = f"{item.name} {name} = {value!r:.40}"
        try:
            item.attrs[name] = value
        except (TypeError, ValueError, OSError, RuntimeError, OverflowError):
            item.attrs.pop(name, None)
    sign(folder)
    return told


def _array(folder: Path, rng: random.Random) -> str:
    with h5py.File(folder / "data.nc", "r+") as file:
        name = rng.choice(list(file))
        array = file[name]
        if rng.random() < 0.3:
            del file[name]
            told = f"without {name}"
        elif array.dtype.kind == "O":
            array[...] = rng.choice([odd for odd in ODD if type(odd) is str and odd.isascii()])
            told = f"text in {name}"
        else:
            array[...] = rng.choice((np.nan, -1, 0, 99, 1e30)) if array.dtype.kind == "f" else 99
            told = f"values of {name}"
    sign(folder)
    return told

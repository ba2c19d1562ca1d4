"""What recipes say of datasets, by dotted names ("mesh.across"): to ask for, and to tell apart.

The catalog does not hold recipes; these functions read record.json of the datasets in question.
"""

from __future__ import annotations

import logging
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from flexscale.datasets.entry import Entry
from flexscale.datasets.record import read_record
from flexscale.errors import DatasetError, UnknownNameError, suggest

logger = logging.getLogger(__name__)

#: relative distance within which two numbers count as the same value
SAME = 1e-9
_ABSENT = object()


def parameters_of(entry: Entry) -> dict[str, Any]:
    """Parameters of a dataset's recipe by dotted name; lists stay whole."""
    return dict(leaves(read_record(entry.folder)["recipe"]["parameters"]))


def leaves(value: Any, key: str = "") -> Iterator[tuple[str, Any]]:
    """Leaves of nested data with dotted keys; lists stay whole."""
    if isinstance(value, Mapping):
        for name, item in value.items():
            yield from leaves(item, f"{key}.{name}" if key else str(name))
    else:
        yield key, value


#: The native model that is meant where nobody says which.
USUAL_MODEL = "joints"


def native_of(folder: Path) -> str:
    """The native model in the recipe of a dataset's folder; "" if it names none, or cannot be
    read."""
    try:
        return str(read_record(folder)["recipe"]["parameters"].get("native", ""))
    except DatasetError:
        return ""


def with_parameter(entries: Iterable[Entry], name: str, wanted: Any) -> list[Entry]:
    """Datasets whose recipe has the value `wanted`; for a list of values, just these values.

    Raises
    ------
    UnknownNameError : none of their recipes has a parameter of this name.
    """
    known: set[str] = set()
    found, asked = [], list(entries)
    for entry in asked:
        try:
            parameters = parameters_of(entry)
        except DatasetError as error:  # damaged since the catalog was written
            logger.warning("left out: %s", error)
            continue
        known |= parameters.keys()
        if name in parameters and is_same(parameters[name], wanted):
            found.append(entry)
    if asked and name not in known:
        raise UnknownNameError(
            f"Datasets have no property {name!r}, and neither have these recipes. "
            f"{suggest(name, known, limit=60)}"
        )
    return found


def is_same(stored: Any, wanted: Any) -> bool:
    """Equality of JSON-able data in which numbers may be rounded in their last digits."""
    if hasattr(wanted, "tolist"):  # a numpy number or array
        wanted = wanted.tolist()
    if isinstance(stored, list):
        wanted = list(wanted) if isinstance(wanted, list | tuple | range) else [wanted]
        return len(stored) == len(wanted) and all(map(is_same, stored, wanted))
    if isinstance(stored, bool) or isinstance(wanted, bool):
        return stored is wanted
    if not isinstance(stored, int | float) or not isinstance(wanted, int | float):
        return bool(stored == wanted)
    if isinstance(stored, int) and isinstance(wanted, int):
        return stored == wanted
    try:
        return abs(stored - wanted) <= SAME * max(abs(stored), abs(wanted))
    except OverflowError:  # an integer beyond all floats
        return False


def differing_parameters(entries: Sequence[Entry]) -> list[dict[str, Any]]:
    """For each dataset the parameters in which they differ, as short texts by dotted name.

    Recipes that cannot be read tell nothing.
    """
    recipes = []
    for entry in entries:
        try:
            recipes.append(parameters_of(entry))
        except DatasetError:
            recipes.append({})
    names = sorted({name for recipe in recipes for name in recipe})
    differing = [
        name
        for name in names
        if any(recipe.get(name, _ABSENT) != recipes[0].get(name, _ABSENT) for recipe in recipes)
    ]
    return [
        {name: short(recipe[name]) if name in recipe else "absent" for name in differing}
        for recipe in recipes
    ]


def short(value: Any) -> str:
    """A value in a line; of long lists their number and ends."""
    if isinstance(value, list) and len(value) > 6:
        return f"{len(value)} values from {short(value[0])} to {short(value[-1])}"
    text = f"{value:.10g}" if isinstance(value, float) else str(value)
    return text if len(text) <= 60 else f"{text[:56]} …"

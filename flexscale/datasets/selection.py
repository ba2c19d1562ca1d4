"""Choices of datasets by what the catalog knows."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, overload

from flexscale.checks import checked, text
from flexscale.datasets.entry import COLUMNS, LOCAL, PROPERTIES, REFERENCE, Entry
from flexscale.datasets.recipe_values import (
    SAME,
    USUAL_MODEL,
    differing_parameters,
    native_of,
    with_parameter,
)
from flexscale.datasets.schema import SCHEMAS
from flexscale.errors import MissingDataError, UnitRangeError, UnknownNameError, suggest
from flexscale.units import require_finite

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

#: Columns that tell when and by which code a dataset was made, not what it is.
_OF_THE_RUN = {"created", "commit", "dirty", "version", "sizes"}


@dataclass(frozen=True)
class Between:
    """Closed range of a numeric column, made by `between`."""

    low: float
    high: float
    unit: str


@checked(unit=text)
def between(low: float, high: float, unit: str) -> Between:
    """Range for `find`: ``gap=between(0.3, 0.5, "mm")``, both ends included."""
    low = require_finite(low, "lower end of a range", unit)
    high = require_finite(high, "upper end of a range", unit)
    if low > high:
        raise UnitRangeError(
            f"A range goes from its lower to its upper end, not from {low:g} to {high:g} {unit}."
        )
    return Between(low, high, unit)


class Selection(Sequence[Entry]):
    """Immutable, sorted choice of datasets; chainable.

    Parameters
    ----------
    entries : the choice.
    universe : all datasets of all layers of the registry; values are checked against them.
    """

    def __init__(self, entries: Iterable[Entry], universe: tuple[Entry, ...]) -> None:
        self._entries = tuple(entries)
        self._universe = universe

    @overload
    def __getitem__(self, index: int) -> Entry: ...
    @overload
    def __getitem__(self, index: slice) -> Selection: ...
    def __getitem__(self, index: int | slice) -> Entry | Selection:
        if isinstance(index, slice):
            return Selection(self._entries[index], self._universe)
        return self._entries[index]

    def __len__(self) -> int:
        return len(self._entries)

    def find(self, **criteria: Any) -> Selection:
        """Those that also meet all criteria.

        Parameters
        ----------
        criteria : by property: a value, a list of allowed values, or `between`. For a dataset
            that lies in both layers, `source` says which copy is meant. Other names are those
            of parameters of the recipe, such as directions=[0, 90] or **{"mesh.across": 2};
            for these the records of the datasets left are read, and a list is the one value.

        Raises
        ------
        UnknownNameError : no such property or parameter, or a value that no dataset of the
            registry has.
        """
        entries: Iterable[Entry] = self._entries
        if "source" in criteria:  # first: the other criteria are those of the copy that is meant
            ids = {entry.id for entry in entries}
            copies = [entry for entry in self._universe if entry.id in ids]
            entries = self._filtered(copies, "source", criteria["source"])
        for column, wanted in criteria.items():
            if column in PROPERTIES and column != "source":
                entries = self._filtered(entries, column, wanted)
        for name in sorted(criteria.keys() - PROPERTIES.keys()):
            self._require_parameter_like(name)
            if isinstance(criteria[name], Between):
                raise UnitRangeError(
                    f"{name} is a parameter of recipes, which are asked for by value, not by a "
                    "range: write the value."
                )
            entries = with_parameter(entries, name, criteria[name])
        return Selection(entries, self._universe)

    def _require_parameter_like(self, name: str) -> None:
        """Names close to that of a property are typing mistakes, not parameters."""
        close = difflib.get_close_matches(name, PROPERTIES, n=1, cutoff=0.8)
        if close or not self._entries:
            raise UnknownNameError(
                f"Datasets have no property {name!r}. {suggest(name, PROPERTIES, limit=40)}"
            )

    def _filtered(self, entries: Iterable[Entry], column: str, wanted: Any) -> list[Entry]:
        kind, unit = PROPERTIES[column]
        if isinstance(wanted, Between):
            if kind is str or wanted.unit != (unit or "1"):
                raise UnitRangeError(
                    f"{column} is {'text' if kind is str else 'in ' + (unit or '1')}; "
                    f"a range in {wanted.unit} does not apply to it."
                )
            low, high = wanted.low - SAME * abs(wanted.low), wanted.high + SAME * abs(wanted.high)
            return [
                entry
                for entry in entries
                if entry.row[column] is not None and low <= entry.row[column] <= high
            ]
        several = isinstance(wanted, list | tuple | set | frozenset)
        values = list(wanted) if several else [wanted]
        if kind is str:
            allowed = {str(value) for value in values}
            self._require_known(column, allowed)
            return [entry for entry in entries if entry.row[column] in allowed]
        numbers = [require_finite(value, column, unit) for value in values]
        return [
            entry
            for entry in entries
            if entry.row[column] is not None
            and any(abs(entry.row[column] - number) <= SAME * abs(number) for number in numbers)
        ]

    def _require_known(self, column: str, allowed: Iterable[str]) -> None:
        known = {entry.row[column] for entry in self._universe}
        if column == "kind":
            known |= set(SCHEMAS)
        if column == "source":
            known |= {LOCAL, REFERENCE}
        for value in sorted(allowed):
            if value in known:
                continue
            if not self._universe:
                raise MissingDataError(f"There is no dataset yet, so none with {column} {value!r}.")
            raise UnknownNameError(f"No dataset has {column} {value!r}. {suggest(value, known)}")

    def one(self) -> Entry:
        """The only dataset of the choice; of several native models, that of the default one.

        Raises
        ------
        MissingDataError : there is none, or several; then they are listed with what differs.
        """
        if len(self._entries) == 1:
            return self._entries[0]
        usual = self._of_usual_model()
        if len(usual) == 1:
            return usual[0]
        if not self._entries:
            raise MissingDataError("No dataset meets all criteria; loosen them, or compute it.")
        raise MissingDataError(self._choices())

    def _of_usual_model(self) -> list[Entry]:
        """Those of the default native model, where the choice is between models."""
        models = {entry.id: native_of(entry.folder) for entry in self._entries}
        if len(set(models.values())) < 2:
            return []
        return [entry for entry in self._entries if models[entry.id] == USUAL_MODEL]

    def _choices(self) -> str:
        """What tells the datasets of the choice apart, to be added to the criteria."""
        shown, columns = self._entries[:10], self.differing()
        # Commits and dates tell apart when, not what.
        told = [name for name in columns if name not in _OF_THE_RUN] or columns
        parameters = [
            # A pattern's name stands for its edges and materials.
            {n: text for n, text in item.items() if "pattern" not in told or n[:8] != "pattern."}
            for item in differing_parameters(shown)
        ]
        lines = [f"{len(self)} datasets meet the criteria; add one that tells them apart:"]
        lines += [
            f"  {_described(entry, told, more)}"
            for entry, more in zip(shown, parameters, strict=True)
        ]
        if len(self) > 10:
            lines.append(f"  … and {len(self) - 10} more")
        lines.append(f'or take one by its id: registry.load("{shown[0].id}")')
        return "\n".join(lines)

    def differing(self) -> list[str]:
        """Columns in which the datasets of the choice differ, digests and paths apart."""
        skipped = {"id", "recipe_digest", "content_digest", "path", "file_bytes"}
        return [
            column
            for column in PROPERTIES
            if column not in skipped and len({entry.row[column] for entry in self._entries}) > 1
        ]

    def rows(self) -> list[dict[str, Any]]:
        """Catalog rows as plain dicts (JSON-able), without opening a file."""
        return [dict(entry.row) for entry in self._entries]

    def table(self) -> pd.DataFrame:
        """One row a dataset, indexed by id, units in the header; empty columns left out."""
        import pandas as pd

        frame = pd.DataFrame(self.rows(), columns=list(PROPERTIES)).set_index("id")
        frame = frame.dropna(axis="columns", how="all").drop(
            columns=["recipe_digest", "content_digest", "path"], errors="ignore"
        )
        units = {name: f"{name} [{unit}]" for name, (_, unit) in COLUMNS.items() if unit}
        return frame.rename(columns=units)

    def to_tree(self) -> xr.DataTree:
        """The datasets, loaded, as a tree /family/pattern."""
        from flexscale.datasets.compare import to_tree

        return to_tree(self)

    def stack(self, along: str = "pattern") -> xr.Dataset:
        """The datasets, loaded, side by side on the new axis `along`; nothing is filled in.

        Raises
        ------
        SchemaError, MissingDataError, UnknownNameError : they do not fit together; see
            `flexscale.datasets.stack`.
        """
        from flexscale.datasets.stack import stack

        return stack(self, along)

    def __repr__(self) -> str:
        return f"{len(self)} datasets\n{self.table().to_string(max_rows=20)}" if self else "nothing"

    def _repr_html_(self) -> str:
        html: str = self.table().to_html(max_rows=20)
        return html


def _described(entry: Entry, columns: Iterable[str], parameters: Mapping[str, str]) -> str:
    row: Mapping[str, Any] = entry.row
    facts = {name: str(row[name]) for name in columns if row[name] not in (None, "")}
    listed = [f"{name}={text}" for name, text in (facts | dict(parameters)).items()]
    more = f", … ({len(listed) - 8} more)" if len(listed) > 8 else ""
    return f"{entry.id}  {', '.join(listed[:8])}{more}"


def by_short_id(entries: Sequence[Entry], identifier: str) -> Entry:
    """The entry whose id starts with `identifier` ("sweep:3f9c", or "3f9c").

    Raises
    ------
    MissingDataError : none or several do.
    """
    kind, _, digest = identifier.rpartition(":")
    found = [
        entry
        for entry in entries
        if digest and entry.recipe_digest.startswith(digest) and kind in ("", entry.kind)
    ]
    if len(found) == 1:
        return found[0]
    if found:
        listed = ", ".join(entry.id for entry in found[:10])
        raise MissingDataError(f"{identifier!r} is not unique: {listed}.")
    ids = [entry.id for entry in entries]
    close = difflib.get_close_matches(identifier, ids, n=3)
    hint = f"Did you mean {' or '.join(close)}? " if close else ""
    raise MissingDataError(
        f"There is no dataset {identifier!r}. {hint}List them with: flexscale data list"
    )

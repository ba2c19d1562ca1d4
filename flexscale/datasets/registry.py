"""Questions to the results folder: find, one, table, load."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexscale.datasets.store import Entry, Store

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


@dataclass(frozen=True)
class Between:
    """Closed range of a numeric column, made by `between`."""

    low: float
    high: float
    unit: str


def between(low: float, high: float, unit: str) -> Between:
    """Range for `find`: ``gap=between(0.3, 0.5, "mm")``, both ends included."""
    raise NotImplementedError


def open_registry(root: str | Path = "results") -> Registry:
    """The datasets below `root`, local ones over reference ones; an empty folder is fine."""
    return Registry(Store(root))


class Selection(Sequence[Entry]):
    """Immutable, sorted choice of datasets; chainable."""

    def find(self, **criteria: Any) -> Selection:
        """Those that also meet the criteria (a value, a list of values, or `between`)."""
        raise NotImplementedError

    def one(self) -> Entry:
        """The only one; MissingDataError for none, UnknownNameError listing several."""
        raise NotImplementedError

    def table(self) -> pd.DataFrame:
        """One row a dataset, units in the header."""
        raise NotImplementedError


class Registry:
    """All datasets of a results folder. `find` reads no file."""

    def __init__(self, store: Store) -> None:
        self.store = store

    def __iter__(self) -> Iterator[Entry]:
        raise NotImplementedError

    def find(self, **criteria: Any) -> Selection:
        """Datasets by kind, family, pattern, status, gap, …; none given means all."""
        raise NotImplementedError

    def one(self, **criteria: Any) -> xr.Dataset:
        """The only dataset that meets the criteria, loaded; else an error with the candidates."""
        raise NotImplementedError

    def table(self) -> pd.DataFrame:
        """All datasets as a table."""
        raise NotImplementedError

    def get(self, identifier: str) -> Entry:
        """Entry by id; the digest may be shortened while unique ("sweep:3f9c")."""
        raise NotImplementedError

    def load(self, dataset: str | Entry) -> xr.Dataset:
        """Dataset by id or entry."""
        raise NotImplementedError

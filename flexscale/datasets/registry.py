"""Questions to the results folder: find, one, table, load."""

from __future__ import annotations

import copy
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexscale import checks
from flexscale.checks import checked
from flexscale.datasets.catalog import read_catalog, results_folder, update_catalog
from flexscale.datasets.entry import LOCAL, REFERENCE, Entry
from flexscale.datasets.record import read_record
from flexscale.datasets.selection import Between, Selection, between, by_short_id

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

__all__ = ["Between", "Entry", "Registry", "Selection", "between", "open_registry"]


@checked(root=checks.path)
def open_registry(root: str | Path = "results") -> Registry:
    """The datasets below `root`, as they are now; a missing or empty folder is fine.

    Parameters
    ----------
    root : results folder with the layers `local` and `reference`; of a dataset in both, the local
        one counts.

    Raises
    ------
    BadInputError : `root` is itself such a layer; the message names the folder to give.
    """
    return Registry(root)


class Registry:
    """All datasets of a results folder at the moment of opening. `find` opens no file."""

    def __init__(self, root: str | Path = "results") -> None:
        self.root = results_folder(root)
        found: dict[tuple[str, str], Entry] = {}
        everywhere: list[Entry] = []
        damaged: list[str] = []
        for name in (REFERENCE, LOCAL):
            catalog = read_catalog(self.root / name)
            found.update({(entry.kind, entry.recipe_digest): entry for entry in catalog.entries})
            everywhere.extend(catalog.entries)
            damaged.extend(catalog.damaged)
        self._entries = tuple(sorted(found.values(), key=_order))
        self._everywhere = tuple(sorted(everywhere, key=_order))
        #: sentences on folders that cannot be read
        self.damaged: tuple[str, ...] = tuple(damaged)

    def __iter__(self) -> Iterator[Entry]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)

    def find(self, **criteria: Any) -> Selection:
        """Datasets by source, kind, family, pattern, status, gap, …; none given means all.

        A criterion is a value, a list of allowed values, or `between(low, high, unit)`. `source`
        is "reference" for what is shipped with the code, "local" for what was computed here;
        `status` is "complete" when every sample converged, else "unconverged".

        Raises
        ------
        UnknownNameError : unknown property or value, with close matches.
        """
        return Selection(self._entries, self._everywhere).find(**criteria)

    def only(self, entries: Iterable[Entry]) -> Registry:
        """The same registry as if it held nothing but these datasets."""
        chosen = copy.copy(self)
        chosen._entries = chosen._everywhere = tuple(sorted(entries, key=_order))
        return chosen

    def one(self, **criteria: Any) -> xr.Dataset:
        """The only dataset that meets the criteria, loaded; else an error with the candidates."""
        return self.load(self.find(**criteria).one())

    def table(self, **criteria: Any) -> pd.DataFrame:
        """Datasets that meet the criteria of `find`, all without any, as a table."""
        return self.find(**criteria).table()

    def to_tree(self, **criteria: Any) -> xr.DataTree:
        """Datasets that meet the criteria of `find`, loaded, as a tree /family/pattern."""
        return self.find(**criteria).to_tree()

    def stack(self, along: str = "pattern", **criteria: Any) -> xr.Dataset:
        """Datasets that meet the criteria of `find`, loaded, on a new axis: `Selection.stack`."""
        return self.find(**criteria).stack(along)

    def get(self, identifier: str) -> Entry:
        """Entry by id; the digest may be shortened while unique ("sweep:3f9c")."""
        return by_short_id(self._entries, checks.text(identifier, "identifier"))

    def _entry(self, dataset: str | Entry) -> Entry:
        return dataset if isinstance(dataset, Entry) else self.get(dataset)

    def load(self, dataset: str | Entry) -> xr.Dataset:
        """Dataset by id or entry, verified, in memory; no file stays open."""
        from flexscale.datasets.files import load_entry

        return load_entry(self._entry(dataset))

    def record(self, dataset: str | Entry) -> dict[str, Any]:
        """Contents of record.json: recipe, digests, inputs, code, environment and "run"."""
        return read_record(self._entry(dataset).folder)

    def lineage(self, dataset: str | Entry) -> pd.DataFrame:
        """The dataset and all it was made from, with steps, versions and commits."""
        from flexscale.datasets.compare import lineage

        return lineage(self._entry(dataset), {item.id: item for item in self._entries})

    def diff(self, first: str | Entry, second: str | Entry) -> pd.DataFrame:
        """Recipe keys and variables in which two datasets differ, and by how much."""
        from flexscale.datasets.compare import difference

        return difference(self._entry(first), self._entry(second))

    def reindex(self) -> Registry:
        """Rebuild local/catalog.csv from the folders and return the registry opened anew."""
        if (self.root / "local").is_dir():
            update_catalog(self.root / "local", rebuild=True)
        return Registry(self.root)

    def counts(self) -> list[tuple[str, str, int, int]]:
        """(kind, family, datasets, of these with unconverged samples), sorted."""
        total = Counter((entry.kind, entry.row["family"]) for entry in self._entries)
        failed = Counter(
            (entry.kind, entry.row["family"]) for entry in self._entries if entry.row["failed"]
        )
        return [(*key, total[key], failed[key]) for key in sorted(total)]

    def __repr__(self) -> str:
        lines = [f"Registry {self.root}: {len(self)} datasets"]
        if self._entries:
            lines.append(f"  {'kind':<10}{'family':<10}{'datasets':>9}{'unconverged':>13}")
        for kind, family, number, failed in self.counts():
            lines.append(f"  {kind:<10}{family:<10}{number:>9}{failed:>13}")
        lines += [f"  damaged: {sentence}" for sentence in self.damaged]
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        rows = "".join(
            "<tr>" + "".join(f"<td>{cell}</td>" for cell in line) + "</tr>"
            for line in self.counts()
        )
        header = "<tr><th>kind</th><th>family</th><th>datasets</th><th>unconverged</th></tr>"
        return (
            f"<p>{len(self)} datasets, {len(self.damaged)} damaged</p><table>{header}{rows}</table>"
        )


def _order(entry: Entry) -> tuple[str, ...]:
    row = entry.row
    return (entry.kind, row["family"], row["pattern"], entry.recipe_digest)

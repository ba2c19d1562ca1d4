"""Draw the paper's figures from stored datasets: find what a script needs, draw, write, report.

A figure script (`paper_figures/figNN_<topic>.py`) has three names:

NEEDS : dict from input name to `Need`, the datasets it draws and the command that makes each;
CAPTION : one or two sentences for the page that lists all figures;
draw(inputs) : gets the datasets by input name, returns a matplotlib Figure.
"""

from __future__ import annotations

import hashlib
import importlib.util
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any, Protocol

import xarray as xr

from flexscale.errors import BadInputError, MissingDataError, UnknownNameError, suggest
from flexscale.plotting.saving import save_figure

ENDINGS = ("pdf", "png", "json")


class StoredDataset(Protocol):
    """What the registry knows about a dataset without opening it."""

    kind: str
    content_digest: str
    row: Mapping[str, Any]

    @property
    def id(self) -> str: ...


class Registry(Protocol):
    """The part of the dataset registry that figures use."""

    def __iter__(self) -> Any: ...

    def get(self, identifier: str) -> Any: ...

    def load(self, dataset: Any) -> xr.Dataset: ...


@dataclass(frozen=True)
class Need:
    """One dataset a figure draws.

    Parameters
    ----------
    kind : dataset kind, for instance "sweep".
    command : what the user types to make it.
    where : values its catalog row must have, for instance {"pattern": "hexagon"}.
    """

    kind: str
    command: str
    where: Mapping[str, str] = field(default_factory=dict)

    def __str__(self) -> str:
        return " ".join([self.kind, *self.where.values()])


@dataclass(frozen=True)
class FigureScript:
    """A loaded figure script; `stem` is its file name without ending."""

    stem: str
    path: Path
    module: ModuleType

    @property
    def needs(self) -> dict[str, Need]:
        return dict(self.module.NEEDS)

    @property
    def caption(self) -> str:
        return str(self.module.CAPTION)


@dataclass(frozen=True)
class FigureReport:
    """What became of one figure.

    outcome : "drawn", "reused" (nothing it depends on has changed) or "missing" (a dataset is
    not there, or several fit; `message` says which, and the command that helps);
    paths : files by ending, empty when missing; sources : ids of the datasets drawn.
    """

    stem: str
    caption: str
    outcome: str
    message: str = ""
    paths: Mapping[str, Path] = field(default_factory=dict)
    sources: tuple[str, ...] = ()


def find_scripts(folder: Path, names: Sequence[str] = ()) -> list[FigureScript]:
    """Figure scripts of a folder by name, sorted; all when no name is given.

    Parameters
    ----------
    names : file stems, or the part before the first underscore ("fig07").

    Raises
    ------
    UnknownNameError : no script has that name.
    BadInputError : a script lacks NEEDS, CAPTION or draw.
    """
    paths = sorted(path for path in folder.glob("fig*.py"))
    chosen = []
    for name in names:
        fitting = [path for path in paths if name in (path.stem, path.stem.split("_")[0])]
        if not fitting:
            known = [path.stem for path in paths]
            raise UnknownNameError(f"There is no figure '{name}'. {suggest(name, known)}")
        chosen += fitting
    return [_load(path) for path in dict.fromkeys(chosen if names else paths)]


def draw_figure(
    script: FigureScript, registry: Registry, out: Path, use: Mapping[str, str] | None = None
) -> FigureReport:
    """Draw one figure into a folder, unless it is already there and up to date.

    Parameters
    ----------
    script : from `find_scripts`.
    registry : `flexscale.datasets.registry.Registry`.
    out : folder for `stem`.pdf, .png and .json.
    use : dataset id by input name, where the registry holds several that fit.
    """
    try:
        entries = {
            name: _resolve(name, need, registry, use or {}) for name, need in script.needs.items()
        }
    except MissingDataError as error:
        return FigureReport(script.stem, script.caption, "missing", str(error))
    sources = [
        {"input": name, "id": entry.id, "content_digest": entry.content_digest}
        for name, entry in entries.items()
    ]
    ids = tuple(str(source["id"]) for source in sources)
    paths = {ending: out / f"{script.stem}.{ending}" for ending in ENDINGS}
    digest = _made_from(script, sources)
    if _is_current(paths, digest):
        return FigureReport(script.stem, script.caption, "reused", "", paths, ids)
    figure = script.module.draw({name: registry.load(entry) for name, entry in entries.items()})
    facts = {"caption": script.caption, "made_from": digest}
    paths = save_figure(figure, out, script.stem, sources=sources, facts=facts)
    return FigureReport(script.stem, script.caption, "drawn", "", paths, ids)


def _resolve(name: str, need: Need, registry: Registry, use: Mapping[str, str]) -> Any:
    if name in use:
        return registry.get(use[name])
    fitting = [entry for entry in registry if _fits(entry, need)]
    if len(fitting) == 1:
        return fitting[0]
    if not fitting:
        raise MissingDataError(f"No {need} among the results; make it with: {need.command}")
    ids = ", ".join(sorted(entry.id for entry in fitting))
    raise MissingDataError(f"Several datasets are a {need}: {ids}; say which with {name}=ID.")


def _fits(entry: StoredDataset, need: Need) -> bool:
    return entry.kind == need.kind and all(
        str(entry.row.get(key)) == str(value) for key, value in need.where.items()
    )


def _load(path: Path) -> FigureScript:
    spec = importlib.util.spec_from_file_location(f"flexscale_figure_{path.stem}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    missing = [name for name in ("NEEDS", "CAPTION", "draw") if not hasattr(module, name)]
    if missing:
        raise BadInputError(f"The figure script {path.name} does not define {', '.join(missing)}.")
    return FigureScript(path.stem, path, module)


def _made_from(script: FigureScript, sources: Iterable[Mapping[str, str]]) -> str:
    """Digest of all a figure depends on: its script, the plotting package, its datasets."""
    digest = hashlib.sha256()
    package = Path(__file__).parent
    for path in [script.path, *sorted([*package.glob("*.py"), *package.glob("*.mplstyle")])]:
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    digest.update(json.dumps(list(sources), sort_keys=True).encode())
    return digest.hexdigest()


def _is_current(paths: Mapping[str, Path], digest: str) -> bool:
    if not all(path.is_file() for path in paths.values()):
        return False
    try:
        content = json.loads(paths["json"].read_text(encoding="utf-8"))
    except ValueError:
        return False
    return isinstance(content, dict) and content.get("made_from") == digest

"""Draw the paper's figures from stored datasets: find what a script needs, draw, write, report."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

import xarray as xr

from flexscale.datasets.recipe_values import native_of
from flexscale.errors import MissingDataError
from flexscale.plotting.figure_scripts import FigureScript, Need
from flexscale.plotting.saving import save_figure

ENDINGS = ("pdf", "png", "json")


class StoredDataset(Protocol):
    """What the registry knows about a dataset without opening it."""

    kind: str
    content_digest: str
    folder: Path
    row: Mapping[str, Any]

    @property
    def id(self) -> str: ...


class Registry(Protocol):
    """The part of the dataset registry that figures use."""

    root: Path

    def __iter__(self) -> Any: ...

    def get(self, identifier: str) -> Any: ...

    def load(self, dataset: Any) -> xr.Dataset: ...


@dataclass(frozen=True)
class FigureReport:
    """What became of one figure.

    outcome : "drawn", "reused" (nothing it depends on has changed) or "missing" (a dataset is
    not there, or several fit; `message` says which, and the command that helps);
    paths : files by ending, empty when missing; sources : ids of the datasets drawn;
    paper_says, we_find : the paper's statement, and sentences computed from the datasets.
    """

    stem: str
    caption: str
    paper_says: str
    outcome: str
    message: str = ""
    paths: Mapping[str, Path] = field(default_factory=dict)
    sources: tuple[str, ...] = ()
    we_find: tuple[str, ...] = ()


def draw_figure(
    script: FigureScript,
    registry: Registry,
    out: Path,
    use: Mapping[str, str] | None = None,
    paper: Iterable[Any] | None = None,
) -> FigureReport:
    """Draw one figure into a folder, unless it is already there and up to date.

    Parameters
    ----------
    script : from `find_scripts`.
    registry : `flexscale.datasets.registry.Registry`.
    out : folder for `stem`.pdf, .png and .json.
    use : dataset id by input name; without, the only one that fits, or the only shipped one.
    paper : the datasets to choose from, if not all of the registry.
    """
    about = (script.stem, script.caption, script.paper_says)
    try:
        found = {
            name: _resolve(name, need, registry, registry if paper is None else paper, use or {})
            for name, need in script.needs.items()
        }
    except MissingDataError as error:
        return FigureReport(*about, "missing", str(error))
    entries = {name: entry for name, entry in found.items() if entry is not None}
    sources = [
        {"input": name, "id": entry.id, "content_digest": entry.content_digest}
        for name, entry in entries.items()
    ]
    ids = tuple(str(source["id"]) for source in sources)
    paths = {ending: out / f"{script.stem}.{ending}" for ending in ENDINGS}
    digest = _made_from(script, sources)
    known = _current_facts(paths, digest)
    if known is not None:
        return FigureReport(*about, "reused", "", paths, ids, tuple(known["we_find"]))
    inputs = {name: registry.load(entry) for name, entry in entries.items()}
    we_find = [str(sentence) for sentence in script.module.findings(inputs)]
    facts = {
        "caption": script.caption,
        "paper_says": script.paper_says,
        "we_find": we_find,
        "made_from": digest,
    }
    figure = script.module.draw(inputs)
    paths = save_figure(figure, out, script.stem, sources=sources, facts=facts)
    return FigureReport(*about, "drawn", "", paths, ids, tuple(we_find))


def _resolve(
    name: str, need: Need, registry: Registry, paper: Iterable[Any], use: Mapping[str, str]
) -> Any:
    """What meets a need; None where it is optional and nothing does."""
    if name in use:
        return registry.get(use[name])
    fitting = [entry for entry in paper if _fits(entry, need)]
    # Beside what a user has run, figures of the paper show the datasets that come with the code.
    shipped = [entry for entry in fitting if entry.row.get("source") == "reference"]
    if len(shipped) == 1 or len(fitting) == 1:
        return shipped[0] if shipped else fitting[0]
    if fitting:
        ids = ", ".join(sorted(entry.id for entry in fitting))
        raise MissingDataError(f"Several datasets are a {need}: {ids}; say which with {name}=ID.")
    if need.optional:
        return None
    others = sorted(entry.id for entry in registry if _fits(entry, need))
    hint = (
        f" ({', '.join(others[:5])}: not the paper's; --use {name}=ID draws it)" if others else ""
    )
    raise MissingDataError(f"No {need} among the results{hint}; make it with: {need.command}")


def _fits(entry: StoredDataset, need: Need) -> bool:
    alike = entry.kind == need.kind and all(
        str(entry.row.get(key)) == str(value) for key, value in need.where.items()
    )
    return alike and need.native in ("", native_of(entry.folder))


def _made_from(script: FigureScript, sources: Iterable[Mapping[str, str]]) -> str:
    """Digest of all a figure depends on: its script, what draws and measures, its datasets."""
    digest = hashlib.sha256()
    plotting = Path(__file__).parent
    code = [*plotting.glob("*.py"), *plotting.glob("*.mplstyle")]
    code += (plotting.parent / "findings").glob("*.py")
    for path in [script.path, *sorted(code)]:
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    digest.update(json.dumps(list(sources), sort_keys=True).encode())
    return digest.hexdigest()


def _current_facts(paths: Mapping[str, Path], digest: str) -> dict[str, Any] | None:
    """The figure's JSON if the figure is there and made from just this; else None."""
    if not all(path.is_file() for path in paths.values()):
        return None
    try:
        content = json.loads(paths["json"].read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return None
    current = isinstance(content, dict) and content.get("made_from") == digest
    return dict(content) if current else None

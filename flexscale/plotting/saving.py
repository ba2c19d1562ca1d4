"""Write a figure as PDF, PNG and JSON, byte for byte the same for the same data."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from flexscale.checks import checked, instance, path, text
from flexscale.datasets.identity import plain
from flexscale.errors import BadInputError, shown
from flexscale.plotting.style import flexscale_style

# Dates and program versions would make equal figures differ.
_METADATA: dict[str, dict[str, Any]] = {
    "pdf": {"CreationDate": None, "Producer": None, "Creator": None},
    "png": {"Software": None},
}


def _several(value: Any, label: str) -> Any:
    """Check of a list of sources."""
    if not isinstance(value, list | tuple):
        raise BadInputError(f"{label} must be a list, not {shown(value)}.")
    return value


def _mapping(value: Any, label: str) -> Any:
    """Check of facts."""
    if not isinstance(value, Mapping):
        raise BadInputError(f"{label} must be a dict, not {shown(value)}.")
    return value


@checked(
    figure=instance("matplotlib.figure:Figure", "draw one with fs.plot"),
    folder=path,
    stem=text,
    sources=_several,
    facts=_mapping,
)
def save_figure(
    figure: Figure,
    folder: str | Path,
    stem: str,
    *,
    sources: Sequence[str | Mapping[str, Any]],
    facts: Mapping[str, Any] | None = None,
) -> dict[str, Path]:
    """Write `stem`.pdf, `stem`.png and `stem`.json into a folder, which is made if missing.

    Parameters
    ----------
    figure : the figure.
    folder, stem : where to; `stem` is a plain file name without ending.
    sources : the datasets drawn: ids ("sweep:3f9c2e71b0aa") or mappings with id and digests.
    facts : further JSON-able entries, for instance a caption; numbers that are not finite become
        null.

    Returns
    -------
    Paths by ending, "pdf", "png", "json". Files appear whole or not at all; the JSON comes last,
    so that it never describes pictures that are not there.
    """
    if not stem or Path(stem).name != stem:
        raise BadInputError(f"A figure cannot be named '{stem}': give a plain file name.")
    target = Path(folder)
    paths = {ending: target / f"{stem}.{ending}" for ending in ("pdf", "png", "json")}
    listed = [dict(s) if isinstance(s, Mapping) else {"id": s} for s in sources]
    content = {"figure": stem, "sources": listed, **(facts or {})}
    # Before any file: what cannot be stored is refused.
    stored = plain(content, "the figure's facts", null_for_nan=True)
    text_of_facts = json.dumps(stored, indent=2, sort_keys=True, ensure_ascii=False)
    try:
        target.mkdir(parents=True, exist_ok=True)
        with flexscale_style():
            for ending, metadata in _METADATA.items():
                part = _part(paths[ending])
                figure.savefig(part, format=ending, metadata=metadata)
                os.replace(part, paths[ending])
        write_text(paths["json"], text_of_facts)
    except OSError as error:
        raise BadInputError(
            f"The figure cannot be written to {shown(str(target))}: {error.strerror}."
        ) from error
    return paths


def write_text(path: Path, text: str) -> None:
    """Write a text file whole or not at all."""
    part = _part(path)
    part.write_text(text.rstrip("\n") + "\n", encoding="utf-8")
    os.replace(part, path)


def _part(path: Path) -> Path:
    return path.with_name(f".{path.name}.{os.getpid()}.part")

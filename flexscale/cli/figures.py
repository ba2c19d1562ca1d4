"""`flexscale figures`: the paper's figures from stored datasets."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from flexscale.datasets.registry import Registry, open_registry
from flexscale.errors import BadInputError, ConfigError, MissingDataError, UnknownNameError, suggest
from flexscale.findings import all_findings
from flexscale.plotting.figure_scripts import FigureScript, find_scripts
from flexscale.plotting.figures import draw_figure
from flexscale.plotting.index_page import write_index
from flexscale.steps.paper import paper_datasets


def draw_figures(names: Sequence[str], results: Path, out: Path | None, use: Sequence[str]) -> int:
    """Draw figures and the page that shows them; paths go to stdout.

    Parameters
    ----------
    names : figure scripts, all if empty.
    results : results folder.
    out : folder to draw into.
    use : "INPUT=ID" for another dataset than that of the paper.

    Returns
    -------
    0, or 4 when a figure lacks data.

    Raises
    ------
    BadInputError : an unknown figure, or `use` names no input of these figures, one input twice,
        or a dataset of another kind.
    MissingDataError : `use` names a dataset that is not there.
    """
    scripts = find_scripts(scripts_folder(), names)
    registry = open_registry(results)
    chosen = _chosen(use, scripts, registry)
    target = out if out is not None else results / "local" / "figures"
    paper = paper_datasets(registry)
    reports = [draw_figure(script, registry, target, chosen, paper) for script in scripts]
    for report in reports:
        if report.paths:
            print(f"{report.stem}  {report.outcome}", file=sys.stderr)
            sys.stdout.write("".join(f"{path}\n" for path in report.paths.values()))
        else:
            print(f"{report.stem}  missing: {report.message}", file=sys.stderr)
    if any(report.paths for report in reports):
        sys.stdout.write(f"{write_index(reports, target, _findings(paper))}\n")
    missing = any(report.outcome == "missing" for report in reports)
    return MissingDataError.exit_code if missing else 0


def _findings(registry: Registry) -> list[dict[str, Any]]:
    """Findings on what is stored; none, and a sentence on stderr, where it does not suffice."""
    try:
        return [finding.to_dict() for finding in all_findings(registry)]
    except MissingDataError as error:
        print(f"no table of findings: {error}", file=sys.stderr)
        return []


def scripts_folder() -> Path:
    """Folder of the figure scripts: they belong to a checkout, not to the installed package."""
    folder = Path(__file__).resolve().parents[2] / "paper_figures"
    if not folder.is_dir():
        raise BadInputError(
            "The figure scripts are part of a checkout of the repository, and this flexscale is "
            "installed without one: run it from a checkout (make setup)."
        )
    return folder


def _chosen(
    use: Sequence[str], scripts: Sequence[FigureScript], registry: Registry
) -> dict[str, str]:
    """Dataset id by input name; everything that `use` says has an effect, or is refused."""
    kinds = {name: need.kind for script in scripts for name, need in script.needs.items()}
    chosen: dict[str, str] = {}
    for text in use:
        name, equals, identifier = text.partition("=")
        if not equals:
            raise ConfigError(f"--use {text!r} chooses no dataset: write INPUT=ID.")
        if name not in kinds:
            stems = ", ".join(script.stem for script in scripts)
            hint = suggest(name, kinds, limit=40)
            raise UnknownNameError(f"--use: there is no input {name!r} of {stems}. {hint}")
        entry = registry.get(identifier)
        if entry.kind != kinds[name]:
            raise ConfigError(
                f"--use {text}: {name} is a {kinds[name]}, and {entry.id} is a {entry.kind}."
            )
        if chosen.setdefault(name, entry.id) != entry.id:
            raise ConfigError(f"--use chooses {name} twice: {chosen[name]} and {entry.id}.")
    return chosen

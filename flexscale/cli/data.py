"""`flexscale data`: list, show, draw, verify, recompute and export datasets."""

from __future__ import annotations

import json as json_module
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from flexscale.cli.options import Force, Json, Quiet, Results
from flexscale.errors import ConfigError, IntegrityError, NonReproducibleError

if TYPE_CHECKING:
    from flexscale.datasets.registry import Registry

app = typer.Typer(
    help="List, show, draw, verify, recompute and export datasets, and findings on them.",
    no_args_is_help=True,
    rich_markup_mode=None,
)

Identifier = Annotated[str, typer.Argument(help="Id from `data list`; may be shortened.")]


@app.command("list")
def list_(
    criteria: Annotated[
        list[str] | None,
        typer.Argument(help="KEY=VALUE, such as kind=sweep source=reference directions=0,90."),
    ] = None,
    results: Results = Path("results"),
    json: Json = False,
) -> None:
    """List the datasets that meet all criteria."""
    registry = _open(results)
    selection = registry.find(**dict(_criterion(text) for text in criteria or []))
    if json:
        _print_json(selection.rows())
    elif selection:
        columns = ("id", "source", "family", "pattern", "status", "samples", "failed", "created")
        rows = [
            ["" if row[key] is None else str(row[key]) for key in columns]
            for row in selection.rows()
        ]
        _print_columns([list(columns), *rows])
    else:
        print(f"No datasets in {results} meet this.", file=sys.stderr)


@app.command()
def show(dataset: Identifier, results: Results = Path("results"), json: Json = False) -> None:
    """Show what a dataset holds and where it came from."""
    from flexscale.datasets.export import describe, describe_text

    entry = _open(results).get(dataset)
    if json:
        _print_json(describe(entry))
    else:
        sys.stdout.write(describe_text(entry) + "\n")


@app.command()
def check(results: Results = Path("results"), json: Json = False, quiet: Quiet = False) -> None:
    """Verify every file, digest and schema again; exit code 4 if anything is wrong."""
    from flexscale.datasets.audit import check_results

    findings = []
    for finding in check_results(results):
        findings.append(finding)
        if not json and not (quiet and finding.level != "problem"):
            sys.stdout.write(f"{finding.level:<8} {finding.subject}  {finding.message}\n")
    if json:
        _print_json([vars(finding) for finding in findings])
    problems = sum(finding.level == "problem" for finding in findings)
    checked = sum(finding.level == "ok" for finding in findings)
    print(f"{checked} datasets are sound, {problems} problems.", file=sys.stderr)
    if problems:
        raise typer.Exit(IntegrityError.exit_code)


@app.command()
def findings(
    results: Results = Path("results"),
    json: Json = False,
    quiet: Annotated[
        bool, typer.Option("--quiet", "-q", help="Verdicts only, without each pattern's numbers.")
    ] = False,
    native: Annotated[
        str, typer.Option(help="Whose datasets: of the paper's shell, or of joints.")
    ] = "shell",
) -> None:
    """Hold what the paper's Sec. 4.2 says against the datasets, with verdicts and numbers."""
    from flexscale.checks import require_choice
    from flexscale.findings.table import all_findings, findings_text
    from flexscale.steps.paper import paper_datasets

    require_choice(native, "native model", ("shell", "joints"))
    found = all_findings(paper_datasets(_open(results)), native)
    if json:
        _print_json([finding.to_dict() for finding in found])
    else:
        sys.stdout.write(findings_text(found, evidence=not quiet) + "\n")


@app.command()
def export(
    dataset: Identifier,
    to: Annotated[Path, typer.Option(help="Existing folder.")] = Path("."),
    format: Annotated[str, typer.Option(help="nc, or csv for one row a sample.")] = "nc",
    force: Force = False,
    results: Results = Path("results"),
) -> None:
    """Copy a dataset to one verified file and print its path."""
    from flexscale.datasets.export import export as export_entry

    path = export_entry(_open(results).get(dataset), to, format, replace=force)
    sys.stdout.write(f"{path}\n")


@app.command()
def draw(
    dataset: Identifier,
    to: Annotated[Path, typer.Option(help="Existing folder.")] = Path("."),
    format: Annotated[str, typer.Option(help="png, svg or pdf.")] = "png",
    force: Force = False,
    results: Results = Path("results"),
) -> None:
    """Draw a dataset, by the figure that experiments have of its kind, and print the path."""
    from flexscale.datasets.export import file_stem
    from flexscale.plotting.picture_file import require_picture_path, write_picture
    from flexscale.steps.figures import draw_dataset

    registry = _open(results)
    entry = registry.get(dataset)
    path = to / f"{file_stem(entry)}.{format}"
    require_picture_path(path, force)
    write_picture(draw_dataset(entry, registry), path, replace=force)
    sys.stdout.write(f"{path}\n")


@app.command()
def recompute(
    dataset: Identifier,
    cores: Annotated[int, typer.Option(min=1, help="Processes a sweep may use.")] = 1,
    results: Results = Path("results"),
) -> None:
    """Compute a dataset again from its recipe and compare; exit code 4 if numbers have changed."""
    from flexscale.processes import single_threaded

    single_threaded(os.environ)  # as jobs run; before anything below imports numpy
    from flexscale.datasets.identity import SHORT_DIGEST
    from flexscale.steps import recompute as again

    registry = _open(results)
    entry = registry.get(dataset)
    found = again.recompute(entry, registry, cores)
    if found.version != found.stored_version:
        print(
            f"The step has version {found.version} now, the dataset is of {found.stored_version}: "
            "numbers have changed on purpose.",
            file=sys.stderr,
        )
    if found.same:
        verdict = f"same content, digest {entry.content_digest[:SHORT_DIGEST]}"
    else:
        verdict = "same within the solver's tolerance" if found.close else "other numbers"
    sys.stdout.write(f"{entry.id}  {verdict}  {found.seconds:.0f} s\n")
    for name, off in sorted(found.differences.items(), key=lambda item: -item[1]):
        sys.stdout.write(f"  {name:<28} differs by {off:.2g} of its largest value\n")
    if not found.close:
        raise NonReproducibleError(
            f"{entry.id} does not come out of its recipe again: see above, where more than "
            f"{again.TOLERANCE:g} is too much. What made it: flexscale data show {entry.id}."
        )


@app.command()
def reindex(results: Results = Path("results")) -> None:
    """Rebuild the catalog from the dataset folders."""
    registry = _open(results).reindex()
    print(f"{len(registry)} datasets in {results}.", file=sys.stderr)


def _open(results: Path) -> Registry:
    from flexscale.datasets.registry import open_registry

    registry = open_registry(results)
    for sentence in registry.damaged:
        print(f"left out: {sentence}", file=sys.stderr)
    return registry


def _criterion(text: str) -> tuple[str, Any]:
    key, equals, value = text.partition("=")
    if not equals:
        raise ConfigError(f"{text!r} is no criterion: write KEY=VALUE, such as kind=sweep.")
    values = [_value(key, part) for part in value.split(",")]
    return key, values if len(values) > 1 else values[0]


def _value(key: str, text: str) -> Any:
    """A number, a switch of a recipe ("contact.enabled"), or text."""
    from flexscale.datasets.entry import PROPERTIES

    if PROPERTIES.get(key, (float,))[0] is str:  # a pattern may be called 4.8.8
        return text
    if "." in key and text in ("true", "false"):
        return text == "true"
    try:
        return float(text)
    except ValueError:
        return text


def _print_json(content: Any) -> None:
    sys.stdout.write(json_module.dumps(content, indent=1) + "\n")


def _print_columns(rows: list[list[str]]) -> None:
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    for row in rows:
        line = "  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True))
        sys.stdout.write(line.rstrip() + "\n")

"""The `flexscale` command: what it offers, and how errors become exit codes.

Heavy libraries are imported inside the commands: `flexscale --help` is instant.
"""

from __future__ import annotations

import logging
import os
import sys
import traceback
from pathlib import Path
from typing import Annotated

import typer

from flexscale.cli import data, fabricate, tiling
from flexscale.cli.export import HELP as EXPORT_HELP
from flexscale.cli.options import Force, Json, Quiet, Results
from flexscale.cli.printable import printable_streams
from flexscale.cli.terminal import Interrupted, interruptible, show_what_it_can
from flexscale.errors import FlexScaleError
from flexscale.exchange.formats import FORMATS
from flexscale.system_failures import explain

INTERRUPTED = 130

app = typer.Typer(
    name="flexscale",
    help="Bending of flexible scaled sheets, from a scale pattern to its bending dataset.",
    epilog="Exit codes: 0 done, 1 bug, 2 bad input, 3 done but some samples did not converge, "
    "4 data or a part of the system missing, 130 interrupted with finished work kept.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)
app.add_typer(data.app, name="data")
app.add_typer(tiling.app, name="tiling")
app.command("fabricate", cls=tiling.ParametersCommand, help=fabricate.HELP)(fabricate.fabricate)


@app.command()
def run(
    file: Annotated[Path | None, typer.Argument(help="Experiment file, workflows/*.yaml.")] = None,
    cores: Annotated[
        int | None, typer.Option(min=1, help="Processes at once; all cores if not given.")
    ] = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Say what would be done and what is reused.")
    ] = False,
    fields: Annotated[
        bool, typer.Option("--fields", help="List what an experiment file may contain.")
    ] = False,
    results: Results = Path("results"),
    quiet: Quiet = False,
) -> None:
    """Run an experiment file; run again, it resumes."""
    from flexscale.cli.run import list_fields, run_experiment

    if fields:
        sys.stdout.write(list_fields())
        return
    if file is None:
        raise typer.BadParameter("give an experiment file, such as workflows/quickstart.yaml.")
    raise typer.Exit(run_experiment(file, cores, results, dry_run=dry_run, quiet=quiet))


@app.command()
def figures(
    names: Annotated[list[str] | None, typer.Argument(help="Such as fig07; all if none.")] = None,
    results: Results = Path("results"),
    out: Annotated[
        Path | None, typer.Option(help="Folder to draw into; RESULTS/local/figures if not given.")
    ] = None,
    use: Annotated[
        list[str] | None, typer.Option(help="INPUT=ID, to draw another dataset; may be repeated.")
    ] = None,
) -> None:
    """Draw the paper's figures from stored datasets."""
    from flexscale.cli.figures import draw_figures

    raise typer.Exit(draw_figures(names or [], results, out, use or []))


@app.command(help=EXPORT_HELP)
def export(
    dataset: Annotated[
        str, typer.Argument(help="Id of a fit, a gap_model, a tensor_model or a tangent.")
    ],
    to: Annotated[str, typer.Option(help=f"Format: {', '.join(FORMATS)}.")],
    output: Annotated[
        Path | None, typer.Option(help="File to write; named after the dataset if not given.")
    ] = None,
    force: Force = False,
    results: Results = Path("results"),
) -> None:
    from flexscale.cli.export import export_dataset

    export_dataset(dataset, to, output, results, replace=force)


@app.command()
def doctor(
    json: Json = False,
    quiet: Quiet = False,
    fix: Annotated[
        bool,
        typer.Option(
            "--fix",
            help="Bring missing system libraries (apt-get), unpacked if not root.",
        ),
    ] = False,
) -> None:
    """Say what this machine lacks and what fixes it."""
    from flexscale.cli.doctor import examine

    raise typer.Exit(examine(as_json=json, quiet=quiet, fix=fix))


def _version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        sys.stdout.write(f"flexscale {version('flexscale')}\n")
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool,
        typer.Option("--version", help="Print the version.", callback=_version, is_eager=True),
    ] = False,
    verbose: Annotated[
        bool, typer.Option("--verbose", "-v", help="Show what the library logs.")
    ] = False,
) -> None:
    logging.basicConfig(
        level=logging.INFO if verbose else logging.WARNING,
        format="%(levelname)s %(name)s: %(message)s",
        stream=sys.stderr,
    )


def main() -> None:
    """Entry point: run the command, turn errors into one message and their exit code."""
    show_what_it_can()
    # Pictures go to files, whatever window or notebook the user's plots go to.
    os.environ["MPLBACKEND"] = "Agg"
    with printable_streams():
        code = _exit_code()
    sys.exit(code)


def _exit_code() -> int:
    try:
        with interruptible():
            app()
    except SystemExit as end:  # how `app` returns
        return end.code if isinstance(end.code, int) else int(end.code is not None)
    except Interrupted:
        print(
            "flexscale: interrupted; finished work is kept. Go on with the same command.",
            file=sys.stderr,
        )
        return INTERRUPTED
    except Exception as error:
        known = error if isinstance(error, FlexScaleError) else explain(error)
        if known is not None:
            print(f"flexscale: {known}", file=sys.stderr)
            return known.exit_code
        traceback.print_exc()
        print("flexscale: this is a bug; please report it with the lines above.", file=sys.stderr)
        return 1
    return 0

"""`flexscale tiling`: which tiling families there are, and what they look like."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperCommand

from flexscale.cli.options import Force, Json, Quiet

app = typer.Typer(
    help="The 93 families of isohedral tilings: list and draw them.",
    no_args_is_help=True,
    rich_markup_mode=None,
)

_DRAW_HELP = """
Draw one tiling: a patch of tiles with its cell, and one tile with its edge classes.

Lengths are in roots of the tile's area. Parameters are displacements of the vertices in this
unit; --parameter-names tells what each one does. Left out, they are 0, and edges are straight.

--edge gives the curve of one edge class, from (0, 0) to (1, 0) in the frame of the class's first
edge, the tile on the side y > 0. Write CLASS=X:Y,X:Y,… with the points between the two ends, or
CLASS=FILE.csv with one point x,y a line. On edges of kind S and U, points that end at x = 0.5 or
before are the first half, and the other half follows.

A tile that crosses itself, or a curve that its class does not allow, ends with exit code 2; the
picture is drawn all the same, with the edges at fault in red.

\b
  flexscale tiling draw IH07
  flexscale tiling draw IH07 --parameters 0.1 -0.2 --edge a=0.3:0.1,0.6:-0.1
  flexscale tiling draw IH64 --edge b=0.5:0.2 --out chevron.svg
  flexscale tiling draw pinwheel3
"""


class ParametersCommand(TyperCommand):
    """Takes `--parameters 0.1 -0.2` for `--parameters 0.1,-0.2`."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        return super().parse_args(ctx, join_numbers(args, "--parameters"))


@app.command("list")
def list_(json: Json = False, quiet: Quiet = False) -> None:
    """List the families: symbol, group, parameters, edge classes, tiles of a cell."""
    from flexscale.cli.tiling_list import list_families

    list_families(as_json=json, quiet=quiet)


@app.command(cls=ParametersCommand, help=_DRAW_HELP)
def draw(
    family: Annotated[str, typer.Argument(help="IH01 to IH93, or the name of a named pattern.")],
    parameters: Annotated[
        str | None,
        typer.Option(metavar="NUMBER …", help="Free shape parameters, all of them."),
    ] = None,
    edge: Annotated[
        list[str] | None,
        typer.Option(metavar="CLASS=CURVE", help="Curve of an edge class; may be repeated."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(help="File.png, .svg or .pdf, or a folder; FAMILY.png here if not given."),
    ] = None,
    cells: Annotated[
        int | None, typer.Option(min=1, max=12, help="Cells drawn along each lattice vector.")
    ] = None,
    force: Force = False,
    parameter_names: Annotated[
        bool, typer.Option("--parameter-names", help="Only print what each parameter does.")
    ] = False,
) -> None:
    from flexscale.cli.tiling_draw import draw_family, print_parameter_names

    if parameter_names:
        print_parameter_names(family)
    else:
        draw_family(family, parameters, edge or [], out, cells, replace=force)


@app.command()
def gallery(
    named: Annotated[
        bool, typer.Option("--named", help="The twelve named patterns instead.")
    ] = False,
    out: Annotated[
        Path | None, typer.Option(help="File.png, .svg or .pdf; tilings.png here if not given.")
    ] = None,
    force: Force = False,
) -> None:
    """Draw all 93 families in one figure."""
    from flexscale.cli.tiling_gallery import draw_gallery, draw_named_patterns

    if named:
        draw_named_patterns(out or Path("patterns.png"), replace=force)
    else:
        draw_gallery(out or Path("tilings.png"), replace=force)


def join_numbers(arguments: list[str], option: str) -> list[str]:
    """Arguments with the numbers that follow an option joined by commas to one value.

    A negative number would else be taken for another option.
    """
    joined: list[str] = []
    collecting = False
    for argument in arguments:
        if collecting and _is_numbers(argument):
            if joined[-1] == option:
                joined.append(argument)
            else:
                joined[-1] += f",{argument}"
            continue
        joined.append(argument)
        collecting = argument == option or argument.startswith(f"{option}=")
    return joined


def _is_numbers(text: str) -> bool:
    try:
        return bool([float(part) for part in text.split(",") if part])
    except ValueError:
        return False

"""`flexscale tiling`: which tiling families there are."""

from __future__ import annotations

import sys

import typer

from flexscale.cli.options import Json

app = typer.Typer(help="Isohedral tiling families.", no_args_is_help=True, rich_markup_mode=None)


@app.callback()
def _group() -> None:
    """Keep `list` a command of its own although it is the only one."""


@app.command("list")
def list_(json: Json = False) -> None:
    """List the tiling families that patterns can be made of."""
    from flexscale.tilings import Tiling, families

    tilings = [Tiling(family.name) for family in families()]
    if json:
        import json as json_module

        rows = [
            {"family": tiling.family, "name": tiling.pattern_name, "tiles": len(tiling.tiles)}
            for tiling in tilings
        ]
        sys.stdout.write(json_module.dumps(rows, indent=1) + "\n")
        return
    for tiling in tilings:
        sys.stdout.write(f"{tiling.family}  {tiling.pattern_name}\n")

"""`flexscale tiling draw`: one tiling as a picture."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from flexscale.cli.tiling_input import read_edges, read_parameters
from flexscale.cli.tiling_picture import picture_of, picture_of_fault
from flexscale.errors import TilingError
from flexscale.patterns.named import named_patterns
from flexscale.plotting.picture_file import require_picture_path, write_picture
from flexscale.plotting.tiling import tiling as tiling_figure
from flexscale.tilings import Tiling
from flexscale.tilings.families import find_family


def draw_family(
    family: str,
    parameters: str | None,
    edges: Sequence[str],
    out: Path | None,
    cells: int | None,
    *,
    replace: bool = False,
) -> None:
    """Draw a tiling and print the path of the picture.

    Parameters
    ----------
    family : "IH01" to "IH93", or the name of a named pattern, whose shape then is the default.
    parameters : numbers as text; all 0 if not given.
    edges : "CLASS=CURVE".
    out : file or folder; the current folder if not given.
    cells : along each lattice vector.
    replace : whether a file that is there may be written over.

    Raises
    ------
    TilingError : no such tiling. If there is an outline nevertheless, it has been drawn.
    BadInputError : text that cannot be read, or a path that cannot be written.
    """
    path = Path() if out is None else out
    if path.is_dir():
        path = path / f"{family}.png"
    family, shape = _family_and_shape(family)
    kinds = find_family(family).curve_kinds()
    values = read_parameters(parameters) or shape.get("parameters")
    curves = {**shape.get("edges", {}), **read_edges(edges, kinds)}
    require_picture_path(path, replace)
    try:
        picture = picture_of(Tiling(family, values, curves))
    except TilingError as error:
        fault = picture_of_fault(family, values, curves, error)
        if fault is not None:
            write_picture(tiling_figure(fault), path, replace=replace)
            sys.stdout.write(f"{path}\n")
        raise
    write_picture(tiling_figure(picture, cells), path, replace=replace)
    sys.stdout.write(f"{path}\n")


def _family_and_shape(name: str) -> tuple[str, dict[str, Any]]:
    """Family, and what else a named pattern says of its tiling."""
    for entry in named_patterns():
        if entry.name == name:
            return entry.family, entry.shape
    return name, {}


def print_parameter_names(family: str) -> None:
    """One line for each free shape parameter of a family, or of a named pattern's.

    Raises
    ------
    TilingError : there is no such family.
    """
    family, _ = _family_and_shape(family)
    names = Tiling(family).parameter_names
    for number, name in enumerate(names, 1):
        sys.stdout.write(f"{number}  {name}\n")
    if not names:
        print(f"Tiling family {family} has no free shape parameters.", file=sys.stderr)

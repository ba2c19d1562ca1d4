"""`flexscale fabricate`: make a sheet, write its files, tell its figures."""

from __future__ import annotations

import sys
from pathlib import Path

from flexscale.cli.fabricate_input import SheetRequest, requested_pattern, requested_shape
from flexscale.datasets.identity import SHORT_DIGEST
from flexscale.fabricate import Grooves, Layout, Printer, printable_sheet
from flexscale.fabricate.files import require_room, sheet_name, write_sheet
from flexscale.fabricate.report import report_lines
from flexscale.homogenize.native_model import NativeModel
from flexscale.mesh.options import MeshOptions
from flexscale.patterns import Pattern
from flexscale.steps.catalog import STEPS


def make_sheet(
    request: SheetRequest, out: Path, *, as_json: bool, quiet: bool, replace: bool = False
) -> None:
    """Write the files and print their paths, or the record as JSON; figures go to stderr.

    Raises
    ------
    BadInputError : something that was asked for cannot be made or written.
    """
    pattern, mesh = requested_pattern(request)
    shape, layout = requested_shape(request), Layout(**request.layout)
    require_room(out, sheet_name(pattern, shape, layout), replace)
    sheet = printable_sheet(
        pattern,
        shape,
        layout=layout,
        grooves=Grooves(**request.grooves),
        printer=Printer(**request.printer),
    )
    paths = write_sheet(sheet, out, cell_dataset(pattern, mesh), replace=replace)
    if not quiet:
        print("\n".join(report_lines(sheet)), file=sys.stderr)
    if as_json:
        sys.stdout.write(paths[-1].read_text(encoding="utf-8"))
    else:
        sys.stdout.write("".join(f"{path}\n" for path in paths))


def cell_dataset(pattern: Pattern, mesh: MeshOptions) -> dict[str, str]:
    """Id and recipe digest that the pattern's cell has in any results folder, stored or not."""
    step = STEPS["cell"]
    native = NativeModel("shell", mesh=mesh)
    digest = step.recipe(step.parameters(pattern, native, step.block())).digest()
    return {"id": f"cell:{digest[:SHORT_DIGEST]}", "recipe_digest": digest}

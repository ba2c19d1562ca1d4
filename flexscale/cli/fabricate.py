"""`flexscale fabricate`: its options; the work is done in `fabricate_sheet`."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from flexscale.cli.options import Force, Json, Quiet

HELP = """
Make printable solids of a pattern: STL files, a 3MF with both materials, a preview and figures.

PATTERN is a named pattern, a tiling family (with --parameters and --edge as `flexscale tiling draw`
takes them), or an experiment file (with --pattern where it has several). The outlines are those
that are simulated. Lengths in mm.

The substrate lies on the bed, z = 0, and the scales on it, keyed by grooves that run around under
every scale. A rectangle gets a hinge barrel for a pin at both ends, beyond its length; a disc a
hole in the middle. Gaps, grooves, walls and fins narrower than the nozzle end with exit code 2, and
so do files of the same names that are there, unless --force replaces them.

\b
  flexscale fabricate hexagon
  flexscale fabricate square --shape disc --size 100 --hub 8
  flexscale fabricate chevron --size 100x50 --direction 30 --border whole
  flexscale fabricate workflows/quickstart.yaml --pattern hexagon --out prints
"""


class ShapeName(StrEnum):
    """Shapes of a sheet."""

    rectangle = "rectangle"
    disc = "disc"


class BorderName(StrEnum):
    """What becomes of scales that cross the border."""

    cut = "cut"
    whole = "whole"


def _size(what: str) -> Any:
    return typer.Option(help=what, show_default=False)


def fabricate(
    pattern: Annotated[str, typer.Argument(help="Named pattern, family, or experiment file.")],
    shape: Annotated[ShapeName, typer.Option(help="Shape of the sheet.")] = ShapeName.rectangle,
    size: Annotated[
        str | None, _size("LENGTHxWIDTH of a rectangle (100x50), radius of a disc (100).")
    ] = None,
    direction: Annotated[
        float, typer.Option(help="Direction of the pattern, degree, that lies along the length.")
    ] = 0.0,
    center: Annotated[
        tuple[float, float], typer.Option(help="Point of the pattern in the sheet's middle.")
    ] = (0.0, 0.0),
    border: Annotated[
        BorderName, typer.Option(help="Cut scales at the border, or keep only whole ones.")
    ] = BorderName.cut,
    smallest_area: Annotated[
        float | None, _size("Leave out cut pieces below this, mm² (5 % of a tile).")
    ] = None,
    select: Annotated[
        str | None, typer.Option("--pattern", help="Which pattern of an experiment file.")
    ] = None,
    parameters: Annotated[
        str | None, typer.Option(metavar="NUMBER …", help="Shape parameters of a family.")
    ] = None,
    edge: Annotated[
        list[str] | None,
        typer.Option(metavar="CLASS=CURVE", help="Curve of a family's edge class."),
    ] = None,
    tile_area: Annotated[float | None, _size("Mean area of the tiles, mm² (100).")] = None,
    gap: Annotated[float | None, _size("Between scales (0.4).")] = None,
    scale_height: Annotated[float | None, _size("Above the substrate (4).")] = None,
    substrate_thickness: Annotated[float | None, _size("Below the scales (0.4).")] = None,
    groove_width: Annotated[float | None, _size("Of the grooves (0.8).")] = None,
    groove_pitch: Annotated[float | None, _size("From groove to groove (1.6).")] = None,
    groove_depth: Annotated[float | None, _size("Into the substrate (0.2); 0 for none.")] = None,
    groove_margin: Annotated[float | None, _size("Outline to groove (pitch - width).")] = None,
    layer_height: Annotated[float | None, _size("Of the printer (0.1).")] = None,
    nozzle: Annotated[float | None, _size("Diameter of the printer's nozzle (0.4).")] = None,
    smallest_wall: Annotated[float | None, _size("Thinnest wall to print (nozzle).")] = None,
    pin: Annotated[float | None, _size("Diameter of hinge pins (3); 0 for no hinges.")] = None,
    pin_clearance: Annotated[float | None, _size("Hole less pin, in diameter (0.2).")] = None,
    barrel_wall: Annotated[float | None, _size("Around the pin's hole (1.2).")] = None,
    hub: Annotated[float | None, _size("Diameter of a disc's hole (8); 0 for none.")] = None,
    out: Annotated[Path, typer.Option(help="Existing folder to write to.")] = Path("."),
    force: Force = False,
    json: Json = False,
    quiet: Quiet = False,
) -> None:
    from flexscale.cli.fabricate_input import SheetRequest
    from flexscale.cli.fabricate_sheet import make_sheet

    sizes = {
        "tile_area": tile_area,
        "gap": gap,
        "scale_height": scale_height,
        "substrate_thickness": substrate_thickness,
    }
    request = SheetRequest(
        pattern=pattern,
        select=select,
        parameters=parameters,
        edges=tuple(edge or ()),
        sizes=_given(sizes),
        shape=shape.value,
        size=size,
        rectangle=_given({"pin": pin, "clearance": pin_clearance, "barrel_wall": barrel_wall}),
        disc=_given({"hub": hub}),
        layout=_given({"smallest_area": smallest_area})
        | {"direction": direction, "center": center, "border": border.value},
        grooves=_given(
            {
                "width": groove_width,
                "pitch": groove_pitch,
                "depth": groove_depth,
                "margin": groove_margin,
            }
        ),
        printer=_given(
            {"layer_height": layer_height, "nozzle": nozzle, "smallest_wall": smallest_wall}
        ),
    )
    make_sheet(request, out, as_json=json, quiet=quiet, replace=force)


def _given(options: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in options.items() if value is not None}

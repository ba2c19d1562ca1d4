"""`flexscale tiling list`: the families as a table or as JSON."""

from __future__ import annotations

import json
import sys
from typing import Any

from flexscale.tilings import Family, Tiling, families
from flexscale.tilings.drawn_symmetry import drawn_symmetry

_LEGEND = """\
scales      of the lattice's cell, one of each aspect
drawn       group of the bare tiles with parameters 0 and straight edges
primitive   scales of the primitive cell of what is drawn
marking     needed: bare tiles do not tell the type from a more symmetric one
edges       J any curve, U symmetric in its bisector, S symmetric about its middle, I straight
parameters  number of free shape parameters, and what each one does"""


def list_families(*, as_json: bool, quiet: bool) -> None:
    """Print all families on stdout, and what the columns mean on stderr."""
    rows = [_facts(family) for family in families()]
    if as_json:
        sys.stdout.write(json.dumps(rows, indent=1) + "\n")
        return
    table = [_line(row) for row in rows]
    columns = list(table[0])
    lines = [columns, *([line[column] for column in columns] for line in table)]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    for cells in lines:
        text = "  ".join(cell.ljust(width) for cell, width in zip(cells, widths, strict=True))
        sys.stdout.write(text.rstrip() + "\n")
    if not quiet:
        print(_LEGEND, file=sys.stderr)


def _facts(family: Family) -> dict[str, Any]:
    tiling = Tiling(family.name)
    drawn = drawn_symmetry(tiling.tiles, tiling.lattice)
    return {
        "family": family.name,
        "name": tiling.pattern_name,
        "net": list(family.net),
        "symbol": family.symbol,
        "stabiliser": family.stabiliser,
        "group": family.group,
        "drawn_group": drawn.group,
        "n_parameters": family.n_parameters,
        "parameter_names": list(tiling.parameter_names),
        "edge_classes": family.curve_kinds(),
        "edges": [edge.letter for edge in family.edge_classes],
        "aspects": len(tiling.aspects),
        "cell_scales": len(tiling.tiles),
        "primitive_cell_scales": len(tiling.tiles) // drawn.n_primitive_cells,
        "needs_marking": family.needs_marking,
    }


def _line(row: dict[str, Any]) -> dict[str, str]:
    names = f": {', '.join(row['parameter_names'])}" if row["parameter_names"] else ""
    return {
        "family": row["family"],
        "net": ".".join(map(str, row["net"])),
        "symbol": row["symbol"],
        "group": row["group"],
        "drawn": row["drawn_group"],
        "scales": str(row["cell_scales"]),
        "primitive": str(row["primitive_cell_scales"]),
        "marking": "needed" if row["needs_marking"] else "",
        "edges": " ".join(f"{letter}:{kind}" for letter, kind in row["edge_classes"].items()),
        "parameters": f"{row['n_parameters']}{names}",
    }

"""Native sheets of the twelve named patterns in 24 directions: is there a place for each?

    python benchmarks/native_places.py [--output FILE]

Sheets of 60 x 30 mm and of 100 x 50 mm are cut from each pattern in directions every 15 degree,
as native sheets are: the pattern is moved until its border leaves nothing too fine to mesh. Each
cell says how many of the 24 sheets there are; what was refused follows with its reason. Pieces must
add up to the sheet's area. One sheet of each pattern is meshed, coarsely, in each of four
directions: "meshed" tells how many of these meshes close, with a scale on each piece that carries
one.
"""

from __future__ import annotations

import time

import numpy as np
import shapely
from report import heading, output_file, report, table

import flexscale as fs
from flexscale.errors import FlexScaleError
from flexscale.mesh.finite import build_finite_mesh
from flexscale.patterns.clipped import SheetTiles, clip_pattern

SIZES = ((60.0, 30.0), (100.0, 50.0))
DIRECTIONS = np.arange(0.0, 360.0, 15.0)
MESHED = (0.0, 45.0, 90.0, 105.0)
COARSE = fs.MeshOptions(scale_layers=2, scale_size=6, scale_strips=1, across=2)


def area(tiles: SheetTiles) -> float:
    """Of all pieces, mm2."""
    scaled = [tiles.prototiles[copy.prototile].polygon for copy in tiles.copies]
    polygons = [*scaled, *(polygon for polygon, _ in tiles.bare)]
    return float(sum(shapely.Polygon(polygon).area for polygon in polygons))


def built(pattern: fs.Pattern, name: str, refused: list[str]) -> list[str]:
    """One row of the table."""
    start, counts, n_meshed = time.perf_counter(), [], 0
    for length, width in SIZES:
        n_built = 0
        for direction in DIRECTIONS:
            where = f"{name}, {length:g} x {width:g} mm, {direction:g} degree"
            try:
                tiles = clip_pattern(pattern, length, width, float(direction))
                if abs(area(tiles) / (length * width) - 1.0) > 1e-9:
                    refused.append(f"- {where}: pieces cover {area(tiles):.6f} mm2")
                    continue
                n_built += 1
                if (length, width) == SIZES[0] and direction in MESHED:
                    mesh = build_finite_mesh(pattern, tiles, COARSE)  # checks that it closes
                    n_meshed += mesh.n_scales == len(tiles.copies)
            except FlexScaleError as error:
                refused.append(f"- {where}: {error}")
        counts.append(f"{n_built} of {len(DIRECTIONS)}")
    row = [name, *counts, f"{n_meshed} of {len(MESHED)}", f"{time.perf_counter() - start:.0f}"]
    print(*row, sep=", ", flush=True)
    return row


def main() -> None:
    """Print the table, and write it if asked."""
    output = output_file(__doc__)
    refused: list[str] = []
    rows = [
        built(fs.named_pattern(entry.name), entry.name, refused) for entry in fs.named_patterns()
    ]
    head = ["pattern", *(f"{a:g} x {b:g} mm" for a, b in SIZES), "meshed", "s"]
    lines = heading("Places of native sheets", __doc__) + table(head, rows)
    report([*lines, *(refused or ["None was refused."])], output)


if __name__ == "__main__":
    main()

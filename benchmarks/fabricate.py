"""Printable sheets of the twelve named patterns: sound, printable, sliced, and how fast.

    python benchmarks/fabricate.py [--output FILE]

Needs admesh and prusa-slicer (Debian: apt-get install --no-install-recommends admesh prusa-slicer).

First table: `flexscale fabricate NAME` for a rectangle of 100 x 50 mm with hinges and a disc of
100 mm radius with a hub hole, everything else as it is by default, as its own process: time (of
CPU too, for machines that others use) and peak memory of the whole command, preview included.
All checks are made of the STL files: edges that are not shared by exactly two triangles, edges that
pass through a triangle, volume against area times height (of an exact circle for the disc's sheet),
smallest wall above the sheet (of hinge bars too) and of the ribs in it, whether the sheet between
the grooves is at least 0.79 mm wide everywhere, and the smallest distance between scales. admesh
must read every part without fixing anything.

Second table: PrusaSlicer slices every part, and loads both from the 3MF, without repair. Layers of
0.1 mm, nozzle 0.4 mm, 3 perimeters, 15 % gyroid as in the paper; rectangles of 100 x 50 mm, discs
of 30 mm radius only, for time.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from report import output_file, report

import flexscale as fs
from flexscale.fabricate import Disc, Rectangle, printable_sheet
from flexscale.fabricate.walls import is_printable, smallest_wall

sys.path.insert(0, str(Path(__file__).parents[1]))
from tests.fabricate.printable_checks import (
    crosses_itself,
    level,
    n_open_edges,
    read_stl,
    smallest_distance,
    volume_of,
)

PARTS = ("substrate", "scales")
SIZES = {"rectangle": "100x50", "disc": "100"}
SLICED = {"rectangle": "100x50", "disc": "30"}
ABOVE, INSIDE = 2.4, 0.3  # mm, heights of the cuts: through the scales, and through the grooves
SLICER = [
    *("prusa-slicer", "--export-gcode", "--layer-height", "0.1", "--first-layer-height", "0.1"),
    *("--nozzle-diameter", "0.4", "--perimeters", "3", "--fill-pattern", "gyroid"),
    *("--fill-density", "15%", "--bed-shape", "0x0,250x0,250x210,0x210", "--center", "125,105"),
]
# The kernel's own peak of this program: what a process reports to its parent counts from the fork.
COMMAND = """
import re, sys, time
from flexscale.cli.main import (app)
app(sys.argv[1:], standalone_mode=False)
peak = re.search(r"VmHWM:\\s*(\\d+) kB", open("/proc/self/status").read())[1]
print(f"{time.process_time():.1f} {int(peak) / 1024:.0f}", file=sys.stderr)
"""
MADE = (
    "| pattern | shape | scales, whole | cut | removed | open edges | crossings "
    "| volume off, sheet | scales | wall, scales | ribs | sheet ≥ 0.79 mm | gap | admesh "
    "| triangles | s | s of CPU | MB |"
)
CUT = (
    "| pattern | shape | sheet, layers | s | scales, layers | s | 3MF, parts | repaired |\n"
    "|---|---|---|---|---|---|---|---|"
)


def made(name: str, shape: str, size: str, folder: Path) -> tuple[Path, tuple[str, str, str]]:
    """Run the command; path of the JSON; seconds, seconds of CPU, MB."""
    command = [sys.executable, "-c", COMMAND, "fabricate", name, "--shape", shape]
    start = time.perf_counter()
    done = subprocess.run(
        [*command, "--size", size, "--quiet", "--out", str(folder)],
        capture_output=True,
        text=True,
    )
    seconds = time.perf_counter() - start
    if done.returncode:
        raise SystemExit(f"flexscale fabricate {name} --shape {shape} failed: {done.stderr}")
    used, memory = done.stderr.split()
    return Path(done.stdout.split()[-1]), (f"{seconds:.1f}", used, memory)


def stl_of(record: Path, part: str) -> Path:
    """STL file of a part."""
    return record.with_name(f"{record.stem}-{part}.stl")


def nominal_volumes(name: str, record: dict) -> dict[str, float]:
    """Areas times heights, mm³; the sheet's area is that of an exact rectangle or ring."""
    options = record["options"]["shape"]
    sizes = {key: value for key, value in options.items() if key != "shape"}
    shape = Rectangle(**sizes) if options["shape"] == "rectangle" else Disc(**sizes)
    sheet = printable_sheet(fs.named_pattern(name), shape)
    area = sheet.areas["sheet"]
    if isinstance(shape, Disc):
        area = np.pi * (shape.radius**2 - 0.25 * (shape.hub or 0.0) ** 2)
    volumes = sheet.expected_volumes()
    volumes["substrate"] += (area - sheet.areas["sheet"]) * sheet.pattern.substrate_thickness
    return volumes


def admesh_fixes(path: Path) -> int:
    """How many things admesh finds or mends in a file."""
    told = subprocess.run(["admesh", str(path)], capture_output=True, text=True, check=True).stdout
    names = ("Degenerate facets", "Edges fixed", "Facets removed", "Facets added")
    names += ("Facets reversed", "Backwards edges", "Normals fixed", "Total disconnected facets")
    return sum(int(re.search(rf"{name}\s*:\s*(\d+)", told)[1]) for name in names)


def measure(name: str, shape: str, folder: Path) -> str:
    """One row of the first table."""
    path, cost = made(name, shape, SIZES[shape], folder)
    record = json.loads(path.read_text())
    figures, nominal = record["figures"], nominal_volumes(name, record)
    surfaces = {part: read_stl(stl_of(path, part).read_bytes()) for part in PARTS}
    off = [abs(volume_of(*surfaces[part]) / nominal[part] - 1.0) for part in PARTS]
    above = level(*surfaces["scales"], ABOVE)
    sheet = level(*surfaces["substrate"], INSIDE)
    fixes = sum(admesh_fixes(stl_of(path, part)) for part in PARTS)
    cells = [
        *(name, shape, figures["whole_scales"], figures["cut_scales"], figures["pieces_removed"]),
        sum(n_open_edges(faces) for _, faces in surfaces.values()),
        sum(crosses_itself(*surface) for surface in surfaces.values()),
        *(f"{value:.1e}" for value in off),
        f"{smallest_wall(above, 0.4):.3f}",
        f"{smallest_wall(level(*surfaces['scales'], INSIDE), 0.4):.3f}",
        "yes" if all(is_printable(area, 0.79) for area in sheet) else "no",
        f"{smallest_distance(above):.4f}",
        "clean" if fixes == 0 else f"{fixes} fixes",
        sum(figures["triangles"].values()),
        *cost,
    ]
    return "| " + " | ".join(map(str, cells)) + " |"


def sliced(path: Path) -> tuple[int, float, str]:
    """Layers of the printer's code, seconds, and what the slicer says of repairs."""
    code = path.with_suffix(".gcode")
    start = time.perf_counter()
    told = subprocess.run(
        [*SLICER, "-o", str(code), str(path)], capture_output=True, text=True, check=True
    )
    layers = code.read_text().count(";LAYER_CHANGE")
    return layers, time.perf_counter() - start, loaded(path)[1] + told.stdout + told.stderr


def loaded(path: Path) -> tuple[int, str]:
    """Number of objects in a file, and what the slicer says of them."""
    told = subprocess.run(
        ["prusa-slicer", "--info", str(path)], capture_output=True, text=True, check=True
    ).stdout
    objects = re.findall(r"manifold = (\w+)", told)
    return len(objects), told if set(objects) == {"yes"} else f"repair: {told}"


def slice_all(name: str, shape: str, folder: Path) -> str:
    """One row of the second table."""
    path, _ = made(name, shape, SLICED[shape], folder)
    cells: list[object] = [name, f"{shape} {SLICED[shape]}"]
    said = ""
    for part in PARTS:
        layers, seconds, told = sliced(stl_of(path, part))
        cells += [layers, f"{seconds:.0f}"]
        said += told
    n_objects, told = loaded(path.with_suffix(".3mf"))
    mended = re.findall(r"(repair|fixed|removed|added|reversed|backwards)", said + told)
    cells += [n_objects, "no" if not mended else ", ".join(sorted(set(mended)))]
    return "| " + " | ".join(map(str, cells)) + " |"


def told(row: str) -> str:
    """The row, shown at once."""
    print(row, flush=True)
    return row


def main() -> None:
    """Print the tables, and write them if asked."""
    output = output_file(__doc__)
    for program in ("admesh", "prusa-slicer"):
        if shutil.which(program) is None:
            raise SystemExit(
                f"{program} is missing. On Debian: "
                "apt-get install --no-install-recommends admesh prusa-slicer"
            )
    cases = [(entry.name, shape) for entry in fs.named_patterns() for shape in SIZES]
    with tempfile.TemporaryDirectory() as folder:
        rows = [MADE, "|" + "---|" * (MADE.count("|") - 1)]
        rows += [told(measure(*case, Path(folder))) for case in cases]
        rows += ["", *CUT.split("\n")]
        rows += [told(slice_all(*case, Path(folder))) for case in cases]
    report(rows, output)


if __name__ == "__main__":
    main()

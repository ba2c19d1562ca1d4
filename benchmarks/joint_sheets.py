"""Whole sheets of scales on joints: time, memory, and how both grow with the number of scales.

    python benchmarks/joint_sheets.py [--output FILE] [--largest N]

First the sheet of Fig. 13, beside the macro model in the same process. Then sheets whose far end is
turned, which takes a moment and no force: hexagons before they touch, by number, and chevrons bent
through contact to 0.02 /mm. Each size in a process of its own; times are of processor time on one
thread, what building and analyzing takes is told apart. The shell's sheet of Fig. 13 took 1,116 s
when it was last measured; it is no longer part of the package.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from report import heading, peak_memory, report, table

import flexscale as fs
from flexscale.finite.native_sheet import NativeSheet, bend_native_sheet

SIZES = (100, 1_000, 10_000, 100_000)  # scales of 100 mm2
BEFORE = (0.001, 0.002, 0.003)  # mm-1, hexagons touch at 0.009
THROUGH = (0.005, 0.01, 0.015, 0.02)  # mm-1, chevrons touch at 0.0145
MOST_IN_CONTACT = 10_000
FIG_13 = tuple(np.linspace(0.0025, 0.025, 10))


def build(name: str, n_scales: int) -> tuple[NativeSheet, float]:
    """A sheet of about so many scales of a pattern, 1.6 times as long as wide; s that it took."""
    warm = NativeSheet(fs.named_pattern(name), 60.0, 40.0, ends="turned")
    list(bend_native_sheet(warm, (0.002, 0.016)))  # compiles
    width = np.sqrt(n_scales * 100.0 / 1.6)
    start = time.process_time()
    sheet = NativeSheet(fs.named_pattern(name), 1.6 * width, width, ends="turned")
    return sheet, time.process_time() - start


def bend(sheet: NativeSheet, curvatures: tuple[float, ...]) -> dict[str, float]:
    """Cost of a way through curvatures."""
    start, clock = time.process_time(), time.perf_counter()
    samples = list(bend_native_sheet(sheet, curvatures))
    return {
        "seconds": time.process_time() - start,
        "wall": time.perf_counter() - clock,
        "iterations": sum(s.get("newton_iterations", 0) for s in samples),
        "status": max(s["status"] for s in samples),
        "contacts": samples[-1].get("contact_pairs", 0),
    }


def measure(name: str, n_scales: int) -> dict[str, float]:
    """Cost of a sheet of hexagons before contact, or of chevrons through it."""
    sheet, built = build(name, n_scales)
    found = bend(sheet, BEFORE if name == "hexagon" else THROUGH)
    sizes = {"scales": sheet.n_scales, "unknowns": len(sheet.active), "build": built}
    return found | sizes | {"memory": peak_memory()}


def fig_13() -> list[str]:
    """Ten curvatures of the sheet of chevrons, and of the macro model fitted to a sweep."""
    pattern = fs.named_pattern("chevron")
    sheet = NativeSheet(pattern, 100.0, 50.0)
    list(bend_native_sheet(sheet, FIG_13))  # compiles
    start = time.process_time()
    native = list(bend_native_sheet(NativeSheet(pattern, 100.0, 50.0), FIG_13))
    seconds = time.process_time() - start
    sweep = fs.sweep(pattern, np.arange(0.0, 180.0, 10.0), (0.0, *FIG_13[::3]), workers=1)
    model = fs.fit(sweep, fs.tangent_stiffness(pattern))
    start = time.process_time()
    macro = [fs.simulate_sheet(model, length=100.0, width=50.0, curvature=k) for k in FIG_13]
    of_macro = time.process_time() - start
    rows = [
        [f"{k:g}", f"{s['energy_density']:.4g}", f"{m.energy_density:.4g}", str(s["contact_pairs"]),
         str(s["status"])]
        for k, s, m in zip(FIG_13, native, macro, strict=True)
    ]  # fmt: skip
    head = ["curvature, mm-1", "native energy density, N/mm", "macro", "contacts", "status"]
    said = (
        f"{sheet.n_scales} scales, {len(sheet.active)} unknowns: {seconds:.1f} s on joints, "
        f"{of_macro:.1f} s by the macro model."
    )
    return ["## The sheet of Fig. 13, closing", "", *table(head, rows), said, ""]


def by_number(name: str, largest: int) -> list[dict[str, float]]:
    """Each size in a process of its own."""
    found = []
    for n in (size for size in SIZES if size <= largest):
        command = [sys.executable, __file__, "--one", name, str(n)]
        done = subprocess.run(command, check=True, capture_output=True, text=True)
        found.append(json.loads(done.stdout))
        print(name, found[-1], file=sys.stderr, flush=True)
    return found


def powers(found: list[dict[str, float]], names: tuple[str, ...]) -> str:
    """How costs grow from the smallest sheet to the largest."""
    a, b = found[0], found[-1]
    span = np.log(b["scales"] / a["scales"])
    grown = [f"{name} by the power {np.log(b[name] / a[name]) / span:.2f}" for name in names]
    return f"From {a['scales']} to {b['scales']} scales grow {', '.join(grown)}."


def before_contact(largest: int) -> list[str]:
    """Newton iterations of hexagons."""
    found = by_number("hexagon", largest)
    for f in found:
        f["iteration"] = f["seconds"] / f["iterations"]
    rows = [
        [f"{f['scales']}", f"{f['unknowns']}", f"{f['build']:.1f}", f"{1e3 * f['iteration']:.0f}",
         f"{1e3 * f['iteration'] / f['scales']:.3f}", f"{f['memory']:.0f}", f"{f['status']}"]
        for f in found
    ]  # fmt: skip
    head = ["scales", "unknowns", "build, s", "ms an iteration", "ms a scale", "peak memory, MB",
            "status"]  # fmt: skip
    said = powers(found, ("iteration", "build", "memory"))
    return ["## Hexagons before contact", "", *table(head, rows), said, ""]


def through_contact(largest: int) -> list[str]:
    """Chevrons bent to 0.02 /mm."""
    found = by_number("chevron", min(largest, MOST_IN_CONTACT))
    rows = [
        [f"{f['scales']}", f"{f['build']:.1f}", f"{f['seconds']:.0f}", f"{f['wall']:.0f}",
         f"{f['iterations']}", f"{f['contacts']}", f"{f['memory']:.0f}", f"{f['status']}"]
        for f in found
    ]  # fmt: skip
    head = ["scales", "build, s", "bending, s", "the same by the clock, s", "iterations",
            "contacts at last", "peak memory, MB", "status"]  # fmt: skip
    said = powers(found, ("seconds", "memory"))
    return ["## Chevrons through contact to 0.02 /mm", "", *table(head, rows), said, ""]


def main() -> None:
    """Print the tables, and write them if asked."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--output", type=Path, help="write the tables to this Markdown file too")
    parser.add_argument("--largest", type=int, default=SIZES[-1], help="number of scales")
    parser.add_argument("--one", nargs=2, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.one:
        print(json.dumps(measure(arguments.one[0], int(arguments.one[1]))))
        return
    rows = heading("Sheets of scales on joints", __doc__ or "")
    rows += fig_13() + before_contact(arguments.largest) + through_contact(arguments.largest)
    report(rows, arguments.output)


if __name__ == "__main__":
    main()

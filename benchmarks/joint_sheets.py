"""Whole sheets of scales on joints: time, memory, and how both grow with the number of scales.

    python benchmarks/joint_sheets.py [--output FILE] [--largest N]

First the sheet of Fig. 13, beside the macro model in the same process. Then hexagons whose far end
is turned, which takes a moment and no force: Newton iterations before scales touch, and into
contact up to 1,000 scales. Each size in a process of its own; times are of processor time on one
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
INTO = (0.009, 0.01, 0.011, 0.012)
MOST_IN_CONTACT = 1_000
FIG_13 = tuple(np.linspace(0.0025, 0.025, 10))


def measure(n_scales: int) -> dict[str, float]:
    """Cost of a sheet of about so many hexagons, 1.6 times as long as wide."""
    warm = NativeSheet(fs.named_pattern("hexagon"), 60.0, 40.0, ends="turned")
    list(bend_native_sheet(warm, (0.002, 0.01)))  # compiles
    width = np.sqrt(n_scales * 100.0 / 1.6)
    start = time.process_time()
    sheet = NativeSheet(fs.named_pattern("hexagon"), 1.6 * width, width, ends="turned")
    built = time.process_time()
    first, *samples = bend_native_sheet(sheet, BEFORE)
    spent = time.process_time()
    iterations = first["newton_iterations"] + sum(s["newton_iterations"] for s in samples)
    found = {
        "scales": sheet.n_scales,
        "unknowns": len(sheet.active),
        "build": built - start,
        "iteration": (spent - built) / iterations,
        "status": max(s["status"] for s in (first, *samples)),
        "memory": peak_memory(),
    }
    if n_scales <= MOST_IN_CONTACT:
        start = time.process_time()
        samples = list(bend_native_sheet(sheet, INTO))
        found |= {
            "contact": time.process_time() - start,
            "contact_iterations": sum(s.get("newton_iterations", 0) for s in samples),
            "contact_status": max(s["status"] for s in samples),
            "contact_pairs": samples[-1].get("contact_pairs", 0),
        }
    return found


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


def sizes(largest: int) -> list[str]:
    """Each size in a process of its own."""
    found = []
    for n in (size for size in SIZES if size <= largest):
        command = [sys.executable, __file__, "--one", str(n)]
        done = subprocess.run(command, check=True, capture_output=True, text=True)
        found.append(json.loads(done.stdout))
        print(found[-1], file=sys.stderr, flush=True)
    rows = [
        [f"{f['scales']}", f"{f['unknowns']}", f"{f['build']:.1f}", f"{1e3 * f['iteration']:.0f}",
         f"{1e3 * f['iteration'] / f['scales']:.3f}", f"{f['memory']:.0f}", f"{f['status']}",
         f"{f['contact']:.0f}" if "contact" in f else "",
         f"{f['contact_iterations']}" if "contact" in f else "",
         f"{f['contact_pairs']}" if "contact" in f else ""] for f in found
    ]  # fmt: skip
    head = ["scales", "unknowns", "build, s", "ms an iteration", "ms a scale", "peak memory, MB",
            "status", "into contact, s", "iterations", "contacts at last"]  # fmt: skip
    a, b = found[0], found[-1]
    span = np.log(b["scales"] / a["scales"])
    powers = {k: np.log(b[k] / a[k]) / span for k in ("iteration", "build", "memory")}
    said = f"From {a['scales']} to {b['scales']} scales: " + ", ".join(
        f"{name} grows by the power {power:.2f}" for name, power in powers.items()
    )
    return ["## Hexagons by number", "", *table(head, rows), said + ".", ""]


def main() -> None:
    """Print the tables, and write them if asked."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--output", type=Path, help="write the tables to this Markdown file too")
    parser.add_argument("--largest", type=int, default=SIZES[-1], help="number of scales")
    parser.add_argument("--one", type=int, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.one:
        print(json.dumps(measure(arguments.one)))
        return
    rows = heading("Sheets of scales on joints", __doc__ or "")
    rows += fig_13() + sizes(arguments.largest)
    report(rows, arguments.output)


if __name__ == "__main__":
    main()

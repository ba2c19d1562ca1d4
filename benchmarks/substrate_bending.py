"""Substrate elements compared at finite curvature: opening, closing, and through contact.

    python benchmarks/substrate_bending.py [--output FILE]

Real materials and contact; the scales' mesh is the default one throughout. The paper's elements
bend by the turn of the normal: their limit is C1 with the measure "turn". The default measure,
"layers", is the same at small strains.
"""

from __future__ import annotations

import time
from dataclasses import replace

from report import output_file, report

import flexscale as fs

CURVATURES = (0.0, 0.004, 0.008, 0.01, 0.011, 0.013, 0.016, 0.02)
SHOWN = (0.004, 0.008, 0.011, 0.013, 0.02)
DEFAULT = fs.MeshOptions()
FINER = replace(DEFAULT, across=4, along=0.1, corner=0.1)
FINEST = replace(DEFAULT, across=8, along=0.05, corner=0.05)
CASES = (
    (fs.SubstrateOptions(), "default", DEFAULT),
    (fs.SubstrateOptions(bending_measure="turn"), "default", DEFAULT),
    (fs.SubstrateOptions("edge_angle"), "default", DEFAULT),
    (fs.SubstrateOptions("edge_angle"), "4 × 0.1", FINER),
    (fs.SubstrateOptions("edge_angle"), "8 × 0.05", FINEST),
)


def table(family: str) -> list[str]:
    """Moments along 0° of all elements, closing and opening, as Markdown."""
    heads = [f"{side} {k:g} [N]" for side in ("closing", "opening") for k in SHOWN]
    heads = ["element", "mesh", *heads, "iterations", "time [s]"]
    lines = [f"## {family}, 0°", "", f"| {' | '.join(heads)} |", "|" + "---|" * len(heads)]
    pattern = fs.Pattern(fs.Tiling(family))
    for substrate, name, mesh in CASES:
        element = " ".join(substrate.to_config().values())
        start = time.perf_counter()
        data = fs.sweep(
            pattern,
            [0.0],
            CURVATURES,
            symmetry=False,
            workers=1,
            model=fs.NativeModel("shell", mesh=mesh, substrate=substrate),
        )
        seconds = time.perf_counter() - start
        moments = data.moment.sel(direction=0.0, curvature=list(SHOWN)).values
        cells = [element, name, *(f"{m:.4g}" for m in moments.ravel())]
        cells += [str(int(data.newton_iterations.sum())), f"{seconds:.0f}"]
        lines.append(f"| {' | '.join(cells)} |")
        print(lines[-1], flush=True)
    return [*lines, ""]


def main() -> None:
    """Print both tables, and write them if asked."""
    output = output_file(__doc__)
    rows = ["# Substrate elements at finite curvature", ""]
    for family in ("IH76", "IH20"):
        rows += table(family)
    report(rows, output)


if __name__ == "__main__":
    main()

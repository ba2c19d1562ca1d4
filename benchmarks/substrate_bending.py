"""Substrate elements compared at finite curvature: opening, closing, and through contact.

    python benchmarks/substrate_bending.py [--output FILE]

Real materials and contact; the scales' mesh is the default one throughout.
"""

from __future__ import annotations

import time
from dataclasses import replace

from report import output_file, report

import flexscale as fs

CURVATURES = (0.0, 0.004, 0.008, 0.01, 0.011, 0.013, 0.016, 0.02)
SHOWN = (0.004, 0.008, 0.011, 0.013, 0.02)
DEFAULT = fs.MeshOptions()
CASES = (
    ("c1", "default", DEFAULT),
    ("edge_angle", "default", DEFAULT),
    ("edge_angle", "4 × 0.1", replace(DEFAULT, across=4, along=0.1, corner=0.1)),
    ("averaged_normals", "default", DEFAULT),
    ("averaged_normals", "4 × 0.1", replace(DEFAULT, across=4, along=0.1, corner=0.1)),
)


def table(family: str) -> list[str]:
    """Moments along 0° of all elements, closing and opening, as Markdown."""
    heads = [f"{side} {k:g} [N]" for side in ("closing", "opening") for k in SHOWN]
    heads = ["element", "mesh", *heads, "iterations", "time [s]"]
    lines = [f"## {family}, 0°", "", f"| {' | '.join(heads)} |", "|" + "---|" * len(heads)]
    pattern = fs.Pattern(fs.Tiling(family))
    for element, name, mesh in CASES:
        start = time.perf_counter()
        data = fs.sweep(
            pattern, [0.0], CURVATURES, mesh=mesh, substrate=fs.SubstrateOptions(element),
            symmetry=False, workers=1,
        )  # fmt: skip
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

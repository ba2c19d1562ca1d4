"""Bending stiffness against the mesh: value, unknowns and time.

    python benchmarks/stiffness_convergence.py [--output FILE]

Scales are rigid (modulus times 1e4) in the first table, PETG in the second. The last line of each
table compares the default mesh with its finest: an estimate of the default's error.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import flexscale as fs
from flexscale.homogenize.cell_problem import CellProblem, plate_stiffness
from flexscale.homogenize.tangent import solve_tangent

MESHES = {
    "coarse": fs.MeshOptions(along=2.0, corner=0.4),
    "default": fs.MeshOptions(),
    "4 across": fs.MeshOptions(
        across=4, along=0.8, corner=0.1, across_grading=1.6, scale_size=1.5, scale_layers=3
    ),
    "6 across": fs.MeshOptions(
        across=6, along=0.7, corner=0.03, growth=1.4, across_grading=2.0,
        scale_size=1.2, scale_layers=4,
    ),
    "8 across": fs.MeshOptions(
        across=8, along=0.5, corner=0.03, growth=1.3, across_grading=2.0,
        scale_size=1.0, scale_layers=6,
    ),
}  # fmt: skip
CASES = (("IH76", 0.0), ("IH76", 45.0), ("IH20", 0.0))


def table(scale_material: fs.NeoHookean, name: str) -> list[str]:
    """Markdown rows, one a mesh."""
    plate = plate_stiffness(fs.TPU, 0.4)
    heads = [f"{family} {direction:g}° [D]" for family, direction in CASES]
    rows = [
        f"| {name} scales | " + " | ".join(heads) + " | unknowns (IH76, IH20) | s (IH76, IH20) |"
    ]
    rows.append("|" + "---|" * (len(CASES) + 3))
    values: dict[str, list[float]] = {}
    for mesh_name, mesh in MESHES.items():
        tangents, sizes, times = {}, [], []
        for family in ("IH76", "IH20"):
            start = time.perf_counter()
            pattern = fs.Pattern(fs.Tiling(family), scale_material=scale_material)
            problem = CellProblem.from_pattern(pattern, mesh)
            tangents[family] = solve_tangent(problem)
            times.append(f"{time.perf_counter() - start:.2f}")
            sizes.append(str(len(problem.active)))
        values[mesh_name] = [float(tangents[f].stiffness(d)) / plate for f, d in CASES]
        cells = [f"{value:.5g}" for value in values[mesh_name]]
        rows.append(
            f"| {mesh_name} | {' | '.join(cells)} | {', '.join(sizes)} | {', '.join(times)} |"
        )
    finest = list(values.values())[-1]
    errors = [f"{100 * (a / b - 1):+.2f} %" for a, b in zip(values["default"], finest, strict=True)]
    rows.append(f"| default against finest | {' | '.join(errors)} | | |")
    return rows


def main() -> None:
    """Print both tables, and write them if asked."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, help="write the tables to this Markdown file too")
    output = parser.parse_args().output
    fs.tangent_stiffness(fs.Pattern(fs.Tiling("IH76")))  # compiles
    rigid = fs.NeoHookean(young_modulus=2020.0e4, poisson_ratio=0.35)
    rows = [*table(rigid, "rigid"), "", *table(fs.PETG, "PETG")]
    print("\n".join(rows))
    if output:
        output.write_text("\n".join(rows) + "\n")


if __name__ == "__main__":
    main()

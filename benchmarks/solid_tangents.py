"""Stiffness of the named patterns at rest by the solid cell, extrapolated from two meshes.

    python benchmarks/solid_tangents.py [--log FILE] [--output FILE]

The log keeps one line of JSON for each solve, and solves that it has are not done again. Each runs
in a process of its own, one after the other. The edge of the bond is singular: energies of a mesh
are above the limit by a share of the size h of the elements there. With sizes that grow by the root
of two, twice the answer at h/2 less that at h is the limit, to 0.6 % for squares. Elastic scales
change the stiffness by a share that hardly depends on the sheet's mesh: it is taken from one mesh.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from report import heading, report, table

import flexscale as fs
from flexscale.homogenize.cell_model import plate_stiffness
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.tangent import TangentStiffness, solve_tangent
from flexscale.mechanics.scale_options import ScaleOptions
from flexscale.mesh.solid_options import SolidOptions
from flexscale.patterns.named import named_pattern, named_patterns

FIRST = ("square", "hexagon", "chevron", "arrowhead", "rhombus", "fish_scale")
ROOT = 2.0**0.5
#: Sizes at the bond's edge, growth, along, corner: a pair for rigid scales, and one for elastic
#: ones beside rigid ones.
PAIR = ((0.06, ROOT, 1.6, 0.2), (0.03, ROOT, 1.6, 0.2))
SHARE = (0.06, 2.0, 1.6, 0.2)
LOG = Path("results/local/solid_tangents.jsonl")
DIRECTIONS = np.arange(0.0, 180.0, 15.0)
Key = tuple[str, str, float, float, float, float]


def solve(name: str, scales: str, edge: float, growth: float, along: float, corner: float) -> dict:
    """One line of the log."""
    mesh = fs.MeshOptions(along=along, corner=corner)
    native = fs.NativeModel(
        "solid", mesh=mesh, scales=ScaleOptions(scales), solid=SolidOptions(edge, growth)
    )
    start = time.perf_counter()
    problem = CellProblem.from_pattern(named_pattern(name), native.without_contact)
    ready = time.perf_counter()
    tangent = solve_tangent(problem)
    return {
        "pattern": name,
        "scales": scales,
        "edge": edge,
        "growth": growth,
        "along": along,
        "corner": corner,
        "layers": native.solid.n_rows(named_pattern(name).substrate_thickness),
        "n_scales": problem.mesh.n_scales,
        "n_unknowns": len(problem.active),
        "matrix": tangent.matrix.tolist(),
        "in_plane": tangent.in_plane.tolist(),
        "seconds_setup": round(ready - start, 1),
        "seconds_solve": round(time.perf_counter() - ready, 1),
        "peak_memory_gb": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6, 2),
    }


def jobs() -> list[tuple]:
    """All solves, those of the first patterns first."""
    names = [*FIRST, *(p.name for p in named_patterns() if p.name not in FIRST)]
    found = [("square", scales, *SHARE) for scales in ("rigid", "tets")]
    for part in (names[:6], names[6:]):
        found += [(n, "rigid", *sizes) for n in part for sizes in PAIR]
    for scales in ("rigid", "tets"):
        found += [(n, scales, *SHARE) for n in names]
    return found


def key_of(line: dict[str, Any]) -> Key:
    return tuple(line[k] for k in ("pattern", "scales", "edge", "growth", "along", "corner"))


def read(log: Path) -> dict[Key, dict[str, Any]]:
    if not log.exists():
        return {}
    lines = [json.loads(text) for text in log.read_text().splitlines()]
    return {key_of(line): line for line in lines}


def limit(done: dict[Key, dict[str, Any]], name: str, part: str) -> np.ndarray | None:
    """Twice the finer mesh's answer less the coarser one's; None if one is missing."""
    keys = [(name, "rigid", *sizes) for sizes in PAIR]
    if not all(key in done for key in keys):
        return None
    coarse, fine = (np.array(done[key][part]) for key in keys)
    return 2.0 * fine - coarse


def rows(done: dict[Key, dict[str, Any]]) -> list[list[str]]:
    found = []
    for name in dict.fromkeys(job[0] for job in jobs()):
        matrix = limit(done, name, "matrix")
        if matrix is None:
            continue
        pattern = named_pattern(name)
        unit = plate_stiffness(pattern.substrate_material, pattern.substrate_thickness)
        rigid = np.asarray(TangentStiffness(matrix, matrix).stiffness(DIRECTIONS)) / unit
        found.append([name, "rigid", *(f"{value:.4g}" for value in rigid)])
        keys = [(name, scales, *SHARE) for scales in ("tets", "rigid")]
        if all(key in done for key in keys):
            elastic, stiff = (
                np.asarray(
                    TangentStiffness(np.array(done[key]["matrix"]), matrix).stiffness(DIRECTIONS)
                )
                for key in keys
            )
            found.append([name, "PETG", *(f"{v:.4g}" for v in rigid * elastic / stiff)])
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--log", type=Path, default=LOG, help="file of the solves, gone on with")
    parser.add_argument("--output", type=Path, help="write the table to this Markdown file too")
    parser.add_argument("--one", help="solve this one alone and print its line")
    options = parser.parse_args()
    if options.one:
        print(json.dumps(solve(*json.loads(options.one))))
        return
    for job in jobs():
        if job in read(options.log):
            continue
        command = [sys.executable, __file__, "--log", str(options.log), "--one", json.dumps(job)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            print(f"{job}: {done.stderr.splitlines()[-1:]}", file=sys.stderr, flush=True)
            continue
        options.log.parent.mkdir(parents=True, exist_ok=True)
        with options.log.open("a") as file:
            file.write(done.stdout.splitlines()[-1] + "\n")
    head = ["pattern", "scales", *(f"{direction:.0f}°" for direction in DIRECTIONS)]
    title = "Stiffness at rest by the solid cell, in units of the sheet's D"
    report([*heading(title, __doc__), *table(head, rows(read(options.log)))], options.output)


if __name__ == "__main__":
    main()

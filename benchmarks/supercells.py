"""How the cost of a sample grows with the number of scales in the cell: supercells of hexagons.

    python benchmarks/supercells.py [--output FILE]

Cells of 1, 4, 16 and 64 hexagons at the default mesh, bent to the same curvatures, before contact
and in contact (the largest before contact only): set-up, one Newton iteration with its parts, a
whole sample, memory. Energies per area must agree, which they do to the solver's tolerance. One
thread, one process a cell.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from report import report

import flexscale as fs
from flexscale.homogenize.bend_line import Line
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.line import follow_line
from flexscale.solve.solver_options import SolverOptions

SIDES = (1, 2, 4, 8)  # cells along each lattice vector
CURVATURES = (0.004, 0.008, 0.0125)
LARGEST = CURVATURES[:2]
DEGREES = 20.0


def supercell(n: int) -> fs.Pattern:
    """n x n cells of hexagons in one."""
    single = fs.named_pattern("hexagon")
    first, second = single.lattice
    tiles = [tile + k * first + m * second for k in range(n) for m in range(n)
             for tile in single.tiles]  # fmt: skip
    return fs.Pattern.from_polygons(tiles, n * first, n * second)


def measure(n: int) -> dict[str, float]:
    """Times [s] and numbers of one supercell; memory in MB."""
    start = time.perf_counter()
    problem = CellProblem.from_pattern(supercell(n))
    found: dict[str, float] = {"scales": n * n, "unknowns": len(problem.active)}
    found["set-up"] = time.perf_counter() - start
    curvatures = LARGEST if n == SIDES[-1] else CURVATURES
    line = Line("closing", DEGREES, curvatures)
    samples, before = [], time.perf_counter()
    for sample in follow_line(problem, line, SolverOptions()):
        now = time.perf_counter()
        samples.append(sample | {"seconds": now - before})
        before = now
    for sample in samples:
        name = f"{sample['curvature']:g}"
        found[f"status {name}"] = sample["status"]
        found[f"energy {name}"] = sample.get("energy_density", float("nan"))
        found[f"sample {name}"] = sample["seconds"]
        found[f"iterations {name}"] = sample["newton_iterations"]
    z = samples[1]["state"]
    cell = problem.bent(line.bend(CURVATURES[1]))
    start = time.perf_counter()
    state = cell.evaluate(z)
    found["evaluation"] = time.perf_counter() - start
    start = time.perf_counter()
    values = cell.hessian_values(state)
    found["Hessian"] = time.perf_counter() - start
    start = time.perf_counter()
    problem.system.factorize(values)
    found["factorization"] = time.perf_counter() - start
    start = time.perf_counter()
    problem.system.solve(state.gradient)
    found["solve"] = time.perf_counter() - start
    found["memory"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    return found


def table(results: list[dict[str, float]]) -> list[str]:
    """Markdown, with the exponent of growth between neighboring sizes."""
    names = ["set-up", "evaluation", "Hessian", "factorization", "solve"]
    names += [f"sample {k:g}" for k in CURVATURES]
    heads = ["scales", "unknowns", *(f"{name} [s]" for name in names), "iterations", "memory [MB]"]
    rows = [f"| {' | '.join(heads)} |", "|" + "---|" * len(heads)]
    for k, found in enumerate(results):
        cells = [f"{found['scales']:.0f}", f"{found['unknowns']:.0f}"]
        for name in names:
            if name not in found:
                cells.append("")
                continue
            cell = f"{found[name]:.3g}"
            if k:
                growth = np.log(found[name] / results[k - 1][name]) / np.log(4.0)
                cell += f" ({growth:.2f})"
            cells.append(cell)
        keys = [f"iterations {c:g}" for c in CURVATURES]
        counts = [f"{found[key]:.0f}" for key in keys if key in found]
        cells += ["/".join(counts), f"{found['memory']:.0f}"]
        rows.append(f"| {' | '.join(cells)} |")
    rows += ["", "In brackets: exponent of growth with the number of scales. Energy densities over"]
    rows += ["those of one scale, less 1:", ""]
    for c in CURVATURES:
        key = f"energy {c:g}"
        ratios = [found[key] / results[0][key] - 1.0 for found in results if key in found]
        rows.append(f"- at {c:g} /mm: " + ", ".join(f"{ratio:.1e}" for ratio in ratios[1:]))
    return rows


def main() -> None:
    """Print the table, and write it if asked."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--output", type=Path, help="write the table to this Markdown file too")
    parser.add_argument("--one", type=int, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.one:
        print(json.dumps(measure(arguments.one)))
        return
    measure(1)  # compiles
    results = []
    for n in SIDES:
        command = [sys.executable, __file__, "--one", str(n)]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        results.append(json.loads(done.stdout.splitlines()[-1]))
        print(results[-1], flush=True)
    report(table(results), arguments.output)


if __name__ == "__main__":
    main()

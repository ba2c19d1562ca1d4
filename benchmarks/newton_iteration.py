"""Where the time of a Newton iteration goes, and what the two treatments of the constraint cost.

    python benchmarks/newton_iteration.py [--output FILE]

One thread; medians over repetitions at a bent state, compilation left out. "Energies" are value,
gradient and element Hessians; "assembly" pulls them back to the unknowns and adds them into the
sparse matrix.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import flexscale as fs
from flexscale.embedding.curvature_map import Bend
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.solve.newton import SolverOptions, solve_equilibrium

CURVATURE, DIRECTION = 0.005, float(np.radians(20.0))


def milliseconds(work: Callable[[], object], repetitions: int = 9) -> float:
    """Median time of a call, after one to warm up."""
    work()
    times = []
    for _ in range(repetitions):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return 1e3 * statistics.median(times)


def split(problem: CellProblem) -> dict[str, float]:
    """Milliseconds of the parts of one iteration."""
    cell = problem.bent(Bend(CURVATURE, DIRECTION))
    solution = solve_equilibrium(cell, problem.embedding.rest, SolverOptions())
    state, pull_back = solution.evaluation, problem.pull_back
    blocks = pull_back.pair_blocks(state.world.y)
    second = problem.embedding.world_map.second_order(state.z, cell.bend, state.world, state.forces)
    values = cell.hessian_values(state)
    parts = {
        "energy and gradient": milliseconds(lambda: cell.evaluate(state.z)),
        "element Hessians": milliseconds(lambda: pull_back.pair_blocks(state.world.y)),
        "assembly": milliseconds(
            lambda: pull_back.hessian(state.world, blocks, state.forces, second)
        ),
        "factorization": milliseconds(lambda: problem.system.factorization.factorize(values)),
        "solves": milliseconds(lambda: problem.system.solve(state.gradient)),
    }
    parts["sum"] = sum(parts.values())
    return parts


def constraint_times(problem: CellProblem) -> list[str]:
    """Bordered and augmented Lagrangian from the same start: time, iterations, difference."""
    cell = problem.bent(Bend(2.0 * CURVATURE, DIRECTION))
    near = solve_equilibrium(
        problem.bent(Bend(1.6 * CURVATURE, DIRECTION)), problem.embedding.rest, SolverOptions()
    )
    found, cells = {}, []
    for method in ("bordered", "augmented_lagrangian"):
        options = SolverOptions(constraint=method, max_iterations=200)
        start = time.perf_counter()
        found[method] = solve_equilibrium(cell, near.z, options)
        seconds = time.perf_counter() - start
        cells.append(f"{found[method].iterations} iterations, {1e3 * seconds:.0f} ms")
    difference = np.abs(found["bordered"].z - found["augmented_lagrangian"].z).max()
    return [*cells, f"{difference:.1e} mm"]


def main() -> None:
    """Print the tables, and write them if asked."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, help="write the tables to this Markdown file too")
    output = parser.parse_args().output
    problems = {f: CellProblem.from_pattern(fs.Pattern(fs.Tiling(f))) for f in ("IH76", "IH20")}
    splits = {family: split(problem) for family, problem in problems.items()}
    rows = ["| ms per Newton iteration | IH76 squares | IH20 hexagons |", "|---|---|---|"]
    sizes = " | ".join(str(len(problem.active)) for problem in problems.values())
    rows.append(f"| (unknowns) | {sizes} |")
    for part in splits["IH76"]:
        rows.append(f"| {part} | " + " | ".join(f"{s[part]:.1f}" for s in splits.values()) + " |")
    rows += ["", "| constraint | bordered | augmented Lagrangian | largest difference |"]
    rows.append("|---|---|---|---|")
    for family, problem in problems.items():
        rows.append(f"| {family} | " + " | ".join(constraint_times(problem)) + " |")
    print("\n".join(rows))
    if output:
        output.parent.mkdir(parents=True, exist_ok=True)
        output.write_text("\n".join(rows) + "\n")


if __name__ == "__main__":
    main()

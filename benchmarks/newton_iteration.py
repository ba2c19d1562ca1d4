"""Where the time of a Newton iteration goes, and what the two treatments of the constraint cost.

    python benchmarks/newton_iteration.py [--output FILE]

One thread; medians over repetitions at bent states before and in contact, compilation left out.
"Contact" is all that contact adds: search for close pairs, energy, gradient and Hessian, and the
step that nothing passes through. "Assembly" pulls element Hessians back to the unknowns and adds
them into the sparse matrix.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable

import numpy as np
from report import output_file, report

import flexscale as fs
from flexscale.homogenize.bend_line import Line
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.line import follow_line
from flexscale.solve.solver_options import SolverOptions

CURVATURE, TOUCHING, DEGREES = 0.005, 0.015, 20.0


def milliseconds(work: Callable[[], object], repetitions: int = 9) -> float:
    """Median time of a call, after one to warm up."""
    work()
    times = []
    for _ in range(repetitions):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return 1e3 * statistics.median(times)


def split(problem: CellProblem, curvature: float) -> dict[str, float]:
    """Milliseconds of the parts of one iteration."""
    line = Line("closing", DEGREES, (0.5 * curvature, 0.8 * curvature, curvature))
    z = list(follow_line(problem, line, SolverOptions()))[-1]["state"]
    cell, pull_back, contact = (
        problem.bent(line.bend(curvature)),
        problem.pull_back,
        problem.contact,
    )
    state = cell.evaluate(z)
    blocks = pull_back.pair_blocks(state.world.y)
    second = problem.embedding.world_map.second_order(state.z, cell.bend, state.world, state.forces)
    values = cell.hessian_values(state)

    def touch() -> None:
        y = state.world.y.copy()  # contact keeps what it found at the very same array
        contact.energy_parts(y)
        contact.add_gradient(y, np.zeros_like(y))
        contact.pair_blocks(y)
        contact.free_share(state.world.y, y)

    def elements() -> None:
        problem.embedding.world_map.place(z, cell.bend)
        for energy in problem.energies:
            energy.energy_parts(state.world.y)
            energy.add_gradient(state.world.y, np.zeros_like(state.world.y))
            energy.hessian_blocks(state.world.y)

    parts = {
        "contact": milliseconds(touch),
        "energies, gradients, element Hessians": milliseconds(elements),
        "assembly": milliseconds(
            lambda: pull_back.hessian(state.world, blocks, state.forces, second)
        ),
        "factorization": milliseconds(lambda: problem.system.factorization.factorize(values)),
        "solves": milliseconds(lambda: problem.system.solve(state.gradient)),
    }
    parts["sum"] = sum(parts.values())
    parts["contact's share, %"] = 100.0 * parts["contact"] / parts["sum"]
    parts["sum / factorization"] = parts["sum"] / parts["factorization"]
    return parts


def iteration_counts(problem: CellProblem) -> list[str]:
    """Newton iterations per sample along one line: before contact, in contact, largest."""
    curvatures = (0.001, 0.003, 0.006, 0.009, 0.012, 0.015, 0.02)
    line = Line("closing", DEGREES, curvatures)
    samples = list(follow_line(problem, line, SolverOptions()))
    touching = np.array([sample["contact_pairs"] > 0 for sample in samples])
    counts = np.array([sample["newton_iterations"] for sample in samples])
    return [f"{counts[~touching].mean():.1f}", f"{counts[touching].mean():.1f}", str(counts.max())]


def main() -> None:
    """Print the tables, and write them if asked."""
    output = output_file(__doc__)
    problems = {f: CellProblem.from_pattern(fs.Pattern(fs.Tiling(f))) for f in ("IH76", "IH20")}
    states = [("IH76", CURVATURE), ("IH76", TOUCHING), ("IH20", CURVATURE), ("IH20", TOUCHING)]
    splits = [split(problems[family], curvature) for family, curvature in states]
    names = [f"{family}, {'in' if k == TOUCHING else 'before'} contact" for family, k in states]
    rows = ["| ms per Newton iteration | " + " | ".join(names) + " |", "|---|---|---|---|---|"]
    sizes = " | ".join(str(len(problems[family].active)) for family, _ in states)
    rows.append(f"| (unknowns) | {sizes} |")
    for part in splits[0]:
        rows.append(f"| {part} | " + " | ".join(f"{s[part]:.1f}" for s in splits) + " |")
    rows += ["", "| Newton iterations per sample | before contact | in contact | largest |"]
    rows.append("|---|---|---|---|")
    for family, problem in problems.items():
        rows.append(f"| {family}, {DEGREES:g}° | " + " | ".join(iteration_counts(problem)) + " |")
    report(rows, output)


if __name__ == "__main__":
    main()

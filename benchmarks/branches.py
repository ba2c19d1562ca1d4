"""Does it matter where the solver starts? The same samples from flat and from their neighbors.

    python benchmarks/branches.py [--output FILE]

Every sample is reached five ways: along its line in steps, as sweeps do; from flat at once, with no
samples on the way; from the sample at the next larger curvature, bent back; and from the states of
the same curvature 15 degrees to either side, turned. The last three go in small steps. Where the
sheet's strips do not buckle and scales do not slide, all of them must find the same equilibrium.
Relative differences in energy from the first are given where they exceed 1e-6: there is more than
one branch. Energies below the line's are marked: sweeps follow the path of a sheet bent from flat,
which need not be the lowest.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from report import output_file, report

import flexscale as fs
from flexscale.arrays import FloatArray
from flexscale.homogenize.bend_line import Line
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.line import follow_line
from flexscale.solve.newton import Solution, solve_equilibrium
from flexscale.solve.solver_options import SolverOptions
from flexscale.status import SolveStatus

CURVATURES = (0.002, 0.006, 0.009, 0.012, 0.015, 0.02, 0.025)
PATTERNS = {"square": (15.0, 30.0), "hexagon": (0.0, 15.0), "chevron": (30.0, 60.0)}
TURN = 15.0
STEP, LEAST_STEP = 1.0 / 15.0, 1.0 / 500.0  # of the way from a neighbor; halved where it fails
SAME = 1e-6
WAYS = ("from flat at once", "from the next", f"from -{TURN:g}°", f"from +{TURN:g}°")
Way = Callable[[float], tuple[Line, float]]  # share of the way -> line and curvature there
HEADER = "| pattern | side | direction | curvature, /mm | in contact | " + " | ".join(WAYS) + " |"

OPTIONS = SolverOptions(max_iterations=150)


def admissible(problem: CellProblem, line: Line, curvature: float, z: FloatArray) -> FloatArray:
    """z with the scales moved apart along the bend until none cut through one another."""
    bend = line.bend(curvature)
    for room in (0.0, 0.01, 0.02, 0.04, 0.08):
        apart = stretched(problem, z, bend.direction, room)
        if not cut(problem, line, curvature, apart):
            return apart
    return z


def stretched(problem: CellProblem, z: FloatArray, direction: float, strain: float) -> FloatArray:
    """z with all scales and the sheet between them moved apart along a direction [rad]."""
    cell, inner = problem.embedding, problem.embedding.inner
    n, out = np.array([np.cos(direction), np.sin(direction)]), z.copy()
    out[-3:] += strain * np.array([n[0] * n[0], n[1] * n[1], n[0] * n[1]])
    free = inner.vertex_node[inner.vertex_node >= 0] - 3 * inner.n_nodes
    starts = cell.world_map.starts
    nodes = np.concatenate([starts[:-1], free + starts[-1]])
    along = z[nodes] * n[0] + z[nodes + 1] * n[1]
    out[nodes] += strain * n[0] * along
    out[nodes + 1] += strain * n[1] * along
    return out


def cut(problem: CellProblem, line: Line, curvature: float, z: FloatArray) -> bool:
    """Whether scales cut through one another."""
    y = problem.embedding.world_map.place(z, line.bend(curvature)).y
    return problem.contact is not None and problem.contact.intersects(y)


def equilibrium_from(
    problem: CellProblem, line: Line, curvature: float, z: FloatArray
) -> Solution | None:
    """The equilibrium found from a state; None if there is none to be found."""
    start = admissible(problem, line, curvature, z)
    solution = solve_equilibrium(problem.bent(line.bend(curvature)), start, OPTIONS)
    return solution if solution.status == SolveStatus.converged else None


def followed(problem: CellProblem, way: Way, z: FloatArray | None) -> Solution | None:
    """Equilibrium at the end of a way, followed from the one at its start; None if not reached.

    The states on the way are predicted from the last two.
    """
    if z is None:
        return None
    share, step, rate = 0.0, STEP, np.zeros_like(z)
    while step >= LEAST_STEP:
        step = min(step, 1.0 - share)
        found = equilibrium_from(problem, *way(share + step), z + step * rate)
        if found is None:
            step *= 0.5
            continue
        share += step
        rate, z = (found.z - z) / step, found.z
        if share >= 1.0 - 1e-9:
            return found
        step = min(2.0 * step, STEP)
    return None


def turned(other: Line, line: Line, curvature: float) -> Way:
    """From the same curvature in another direction."""
    turn = (line.direction - other.direction + 90.0) % 180.0 - 90.0
    return lambda share: (
        replace(line, direction=other.direction + share * turn),
        curvature,
    )


def bent_back(line: Line, start: float, curvature: float) -> Way:
    """From a larger curvature in the same direction."""
    return lambda share: (line, start + share * (curvature - start))


def energy_density(problem: CellProblem, solution: Solution | None) -> float:
    """N/mm; nan where there is none."""
    return float("nan") if solution is None else solution.evaluation.energy / problem.area


def shown(energy: float, known: float) -> str:
    """One cell of the table."""
    if not np.isfinite(energy):
        return "not converged"
    difference = energy / known - 1.0
    if abs(difference) <= SAME:
        return "same"
    return f"{100.0 * difference:+.3f} %{' (lower)' if difference < 0.0 else ''}"


def compare(problem: CellProblem, name: str, side: str, direction: float) -> list[list[str]]:
    """Rows of one line."""
    lines = [Line(side, (direction + turn) % 180.0, CURVATURES) for turn in (0.0, -TURN, TURN)]
    found = [list(follow_line(problem, line, SolverOptions())) for line in lines]
    rows, line = [], lines[0]
    for k, curvature in enumerate(CURVATURES):
        sample = found[0][k]
        if sample["status"]:
            continue
        (flat,) = follow_line(problem, Line(side, direction, (curvature,)), SolverOptions())
        neighbors = [(turned(other, line, curvature), samples[k])
                     for other, samples in zip(lines[1:], found[1:], strict=True)]  # fmt: skip
        if k + 1 < len(CURVATURES):
            neighbors.insert(0, (bent_back(line, CURVATURES[k + 1], curvature), found[0][k + 1]))
        solutions = [followed(problem, way, start.get("state")) for way, start in neighbors]
        energies = [flat.get("energy_density", float("nan"))]
        energies += [energy_density(problem, solution) for solution in solutions]
        cells = [shown(energy, sample["energy_density"]) for energy in energies]
        if k + 1 == len(CURVATURES):
            cells.insert(1, "")
        touching = "yes" if sample["contact_pairs"] else "no"
        rows.append([name, side, f"{direction:g}°", f"{curvature:g}", touching, *cells])
        print("| " + " | ".join(rows[-1]) + " |", flush=True)
    return rows


def main() -> None:
    """Print the table, and write it if asked."""
    output = output_file(__doc__)
    found = []
    for name, directions in PATTERNS.items():
        problem = CellProblem.from_pattern(fs.named_pattern(name))
        for side in ("closing", "opening"):
            for direction in directions:
                found += compare(problem, name, side, direction)
    rows = [HEADER, "|" + "---|" * (5 + len(WAYS))]
    rows += ["| " + " | ".join(row) + " |" for row in found]
    cells = [cell for row in found for cell in row[5:] if cell]
    counts = (cells.count("same"), cells.count("not converged"), len(cells))
    told = (
        f"{counts[0]} of {counts[2]} starts found the line's state, {counts[1]} did not converge."
    )
    rows += ["", told]
    report(rows, output)


if __name__ == "__main__":
    main()

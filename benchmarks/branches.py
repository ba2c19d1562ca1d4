"""Does it matter where the solver starts? The same samples from flat and from their neighbors.

    python benchmarks/branches.py [--output FILE]

Every sample is reached five ways: along its line in steps, as sweeps do; from flat at once, with no
samples on the way; from the sample at the next larger curvature, along the tangent there; and from
the states of the same curvature 15 degrees to either side, turned a degree at a time. Where the
sheet's strips do not buckle and scales do not slide, all of them must find the same equilibrium.
Relative differences in energy from the first are given where they exceed 1e-6: there is more than
one branch. Energies below the line's are marked: sweeps follow the path of a sheet bent from flat,
which need not be the lowest.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from report import output_file, report

import flexscale as fs
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.line import Line, follow_line
from flexscale.mechanics.energy import FloatArray
from flexscale.solve.newton import Solution, SolverOptions, solve_equilibrium
from flexscale.status import SolveStatus

CURVATURES = (0.002, 0.006, 0.009, 0.012, 0.015, 0.02, 0.025)
PATTERNS = {"square": (15.0, 30.0), "hexagon": (0.0, 15.0), "chevron": (30.0, 60.0)}
TURN = 15.0
TURN_STEP, LEAST_TURN_STEP = 1.0 / 15.0, 1.0 / 500.0  # of the turn; halved where it fails
SAME = 1e-6
WAYS = ("from flat at once", "from the next", f"from -{TURN:g}°", f"from +{TURN:g}°")
HEADER = "| pattern | side | direction | curvature, /mm | in contact | " + " | ".join(WAYS) + " |"

OPTIONS = SolverOptions(max_iterations=150)


def admissible(problem: CellProblem, line: Line, curvature: float, z: FloatArray) -> FloatArray:
    """z with the scales moved apart along the bend until none cut through one another."""
    bend = line.bend(curvature)
    for room in (0.0, 0.01, 0.02, 0.04, 0.08):
        apart = problem.embedding.stretched(z, bend.direction, room)
        if not cut(problem, line, curvature, apart):
            return apart
    return z


def cut(problem: CellProblem, line: Line, curvature: float, z: FloatArray) -> bool:
    """Whether scales cut through one another."""
    y = problem.embedding.world_map.place(z, line.bend(curvature)).y
    return problem.contact is not None and problem.contact.intersects(y)


def predicted_back(
    problem: CellProblem, line: Line, samples: list[dict], k: int
) -> FloatArray | None:
    """State at sample k, predicted from the one after it; that one itself where scales would cut
    through one another."""
    if k + 1 == len(samples) or "state" not in samples[k + 1]:
        return None
    z: FloatArray = samples[k + 1]["state"]
    back = z - (CURVATURES[k + 1] - CURVATURES[k]) * samples[k + 1]["rate"]
    return z if cut(problem, line, CURVATURES[k], back) else back


def equilibrium_from(
    problem: CellProblem, line: Line, curvature: float, z: FloatArray | None
) -> Solution | None:
    """The equilibrium found from a state; None if there is none to be found."""
    if z is None:
        return None
    start = admissible(problem, line, curvature, z)
    solution = solve_equilibrium(problem.bent(line.bend(curvature)), start, OPTIONS)
    return solution if solution.status == SolveStatus.converged else None


def turned(
    problem: CellProblem, other: Line, line: Line, curvature: float, z: FloatArray | None
) -> Solution | None:
    """Equilibrium of a line from that of another direction, followed along the turn in between.

    The states on the way are predicted from the last two; None where it is not reached.
    """
    if z is None:
        return None
    turn = (line.direction - other.direction + 90.0) % 180.0 - 90.0
    share, step, rate = 0.0, TURN_STEP, np.zeros_like(z)
    while step >= LEAST_TURN_STEP:
        step = min(step, 1.0 - share)
        to = replace(line, direction=other.direction + (share + step) * turn)
        found = equilibrium_from(problem, to, curvature, z + step * rate)
        if found is None:
            step *= 0.5
            continue
        share += step
        rate, z = (found.z - z) / step, found.z
        if share >= 1.0 - 1e-9:
            return found
        step = min(2.0 * step, TURN_STEP)
    return None


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
        back = predicted_back(problem, line, found[0], k)
        solutions = [equilibrium_from(problem, line, curvature, back)]
        solutions += [
            turned(problem, other, line, curvature, samples[k].get("state"))
            for other, samples in zip(lines[1:], found[1:], strict=True)
        ]
        energies = [flat.get("energy_density", float("nan"))]
        energies += [energy_density(problem, solution) for solution in solutions]
        cells = [shown(energy, sample["energy_density"]) for energy in energies]
        if back is None:
            cells[1] = ""
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

"""Every equilibrium of the quickstart, looked at: converged, stable, free of intersections?

    python benchmarks/quickstart_states.py [--output FILE]

Intersections are sought with exact geometry that knows nothing of the barrier
(tests/physics/intersections.py), on the surfaces that touch, and on those of the finite elements,
which may overlap by what they give way within the contact edge.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from report import output_file, report

import flexscale as fs
from flexscale.homogenize.bend_line import Line
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.line import follow_line
from flexscale.solve.solver_options import SolverOptions

sys.path.insert(0, str(Path(__file__).parents[1]))
from tests.physics.intersections import surfaces_intersect

CURVATURES = (0.0, 0.001, 0.003, 0.006, 0.009, 0.012, 0.015, 0.02)
DIRECTIONS = range(0, 180, 15)


def look(family: str) -> dict[str, str]:
    """What there is to say about the states of one pattern."""
    problem = CellProblem.from_pattern(fs.Pattern(fs.Tiling(family)))
    contact = problem.contact
    surface = contact.surface
    samples, crossing = [], 0
    for side in ("closing", "opening"):
        for direction in DIRECTIONS:
            line = Line(side, float(direction), CURVATURES)
            for sample in follow_line(problem, line, SolverOptions()):
                samples.append(sample)
                if sample["status"] or not sample["contact_pairs"]:
                    continue
                bend = line.bend(sample["curvature"])
                y = problem.embedding.world_map.place(sample["state"], bend).y
                mesh = (surface.triangles, surface.bodies)
                crossing += surfaces_intersect(contact.positions(y), *mesh)
    done = [sample for sample in samples if sample["status"] == 0]
    touching = [sample for sample in done if sample["contact_pairs"]]
    before = [s["newton_iterations"] for s in done if not s["contact_pairs"] and s["curvature"]]
    after = [s["newton_iterations"] for s in touching]
    share = min(s["min_gap"] for s in touching) / contact.activation_distance
    return {
        "samples": str(len(samples)),
        "converged": str(len(done)),
        "in contact": str(len(touching)),
        "with negative eigenvalues": str(sum(s["negative_eigenvalues"] > 0 for s in done)),
        "saddles left on the way": str(sum(s["saddles_left"] for s in done)),
        "cut through one another": str(crossing),
        "smallest distance, d_hat": f"{share:.2f}",
        "largest barrier stiffness, of the first": (
            f"{max(s['barrier_stiffness'] for s in done) / problem.barrier_stiffness:g}"
        ),
        "Newton iterations before contact, mean": f"{np.mean(before):.1f}",
        "Newton iterations in contact, median": f"{np.median(after):.0f}",
        "Newton iterations in contact, mean": f"{np.mean(after):.1f}",
        "Newton iterations in contact, largest": str(max(after)),
    }


def main() -> None:
    """Print the table, and write it if asked."""
    output = output_file(__doc__)
    columns = [look(family) for family in ("IH76", "IH20")]
    rows = ["| | IH76 squares | IH20 hexagons |", "|---|---|---|"]
    rows += [f"| {name} | " + " | ".join(c[name] for c in columns) + " |" for name in columns[0]]
    report(rows, output)


if __name__ == "__main__":
    main()

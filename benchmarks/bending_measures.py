"""Opening far: what the choice of the bending measure changes, and whether gap strips buckle.

    python benchmarks/bending_measures.py [--output FILE]

Squares along a side and hexagons, opening to 0.03 /mm, with the three measures of the C1 sheet.
"Stretch" is the largest lattice stretch; a state buckles if saddles were met and left on the way to
it, or if its tangent has negative eigenvalues.
"""

from __future__ import annotations

import numpy as np
from report import output_file, report

import flexscale as fs
from flexscale.homogenize.cell_problem import CellModel, CellProblem
from flexscale.homogenize.line import Line, follow_line
from flexscale.mechanics.substrate_options import BENDING_MEASURES
from flexscale.mesh.torus import build_mesh
from flexscale.solve.newton import SolverOptions

CURVATURES = (0.001, 0.003, 0.006, 0.01, 0.0125, 0.015, 0.02, 0.025, 0.03)
SHOWN = (0.01, 0.02, 0.03)


def row(family: str, direction: float, measure: str) -> str:
    """Moments of one opening line."""
    pattern = fs.Pattern(fs.Tiling(family))
    options = fs.SubstrateOptions(bending_measure=measure)
    mesh = build_mesh(pattern, fs.MeshOptions())
    problem = CellProblem(mesh, CellModel.of_pattern(pattern, substrate=options))
    line = Line("opening", direction, CURVATURES)
    samples = list(follow_line(problem, line, SolverOptions()))
    done = [sample for sample in samples if sample["status"] == 0]
    found = {sample["curvature"]: sample for sample in done}
    cells = [f"{family} {direction:g}°", measure]
    cells += [f"{found[k]['moment']:.3f}" if k in found else "not converged" for k in SHOWN]
    buckled = sum(s["saddles_left"] > 0 or s["negative_eigenvalues"] > 0 for s in done)
    iterations = np.mean([sample["newton_iterations"] for sample in done])
    stretch = max(abs(sample["stretch"][:2] - 1.0).max() for sample in done)
    bending = max(s["energy_density_bending"] / s["energy_density"] for s in done)
    cells += [f"{len(done)} of {len(samples)}", str(buckled), f"{iterations:.1f}"]
    text = "| " + " | ".join([*cells, f"{stretch:.3f}", f"{100 * bending:.0f} %"]) + " |"
    print(text, flush=True)
    return text


def main() -> None:
    """Print the table, and write it if asked."""
    output = output_file(__doc__)
    rows = [
        "| pattern | measure | M(0.01), N | M(0.02) | M(0.03) | converged | buckled | iterations "
        "| stretch | bending share |",
        "|---" * 10 + "|",
    ]
    for family, direction in (("IH76", 0.0), ("IH76", 45.0), ("IH20", 0.0)):
        rows += [row(family, direction, measure) for measure in BENDING_MEASURES]
    report(rows, output)


if __name__ == "__main__":
    main()

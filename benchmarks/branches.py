"""How far the equilibria that sweeps find lie below the symmetric ones.

    python benchmarks/branches.py [--output FILE]

Bent along a mirror axis, a pattern has equilibria as symmetric as the axis, without shear S_xy
between neighboring cells. Once scales touch these may be saddles, and rows of scales slide to
lower energy. Here every sample of the quickstart in such a direction is computed twice: as a sweep
does, and with S_xy held at 0.
"""

from __future__ import annotations

import numpy as np
from report import output_file, report

import flexscale as fs
from flexscale.embedding.pull_back import PullBack
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.line import Line, follow_line
from flexscale.solve.newton import SolverOptions

CURVATURES = (0.001, 0.003, 0.006, 0.009, 0.012, 0.015, 0.02)
HEADER = (
    "| pattern | side | direction | curvature, /mm | S_xy | saddles left | energy below symmetric "
    "| moment, relative difference |"
)


def hold_shear(problem: CellProblem) -> None:
    """Take S_xy, the last unknown, out of the unknowns."""
    embedding = problem.embedding
    problem.active = np.setdiff1d(problem.active, [embedding.n_unknowns - 1])
    problem.shift_mode = embedding.shift_mode[problem.active]
    problem.pull_back = PullBack(
        embedding.world_map, problem.energies, problem.active, problem.contact
    )
    problem.build_system()


def main() -> None:
    """Print the samples whose energies differ by more than 0.1 %, and how many were compared."""
    output = output_file(__doc__)
    rows, compared, failed, largest = [HEADER, "|" + "---|" * 8], 0, 0, 0.0
    for family in ("IH76", "IH20"):
        free, held = (CellProblem.from_pattern(fs.Pattern(fs.Tiling(family))) for _ in range(2))
        hold_shear(held)
        for side in ("closing", "opening"):
            for direction in (0.0, 90.0):
                line = Line(side, direction, CURVATURES)
                pairs = zip(
                    follow_line(free, line, SolverOptions()),
                    follow_line(held, line, SolverOptions()),
                    strict=True,
                )
                for lower, symmetric in pairs:
                    if lower["status"] or symmetric["status"]:
                        failed += 1
                        continue
                    compared += 1
                    below = 1.0 - lower["energy_density"] / symmetric["energy_density"]
                    moment = lower["moment"] / symmetric["moment"] - 1.0
                    largest = max(largest, abs(below))
                    if abs(below) > 1e-3:
                        rows.append(
                            f"| {family} | {side} | {direction:g} | {lower['curvature']:g} "
                            f"| {lower['stretch'][2]:.1e} | {lower['saddles_left']} "
                            f"| {100 * below:.2f} % | {100 * moment:+.2f} % |"
                        )
    rows += ["", f"{compared} samples compared, {failed} not converged on one of the branches; "]
    rows[-1] += f"largest relative difference in energy {100 * largest:.3f} %."
    report(rows, output)


if __name__ == "__main__":
    main()

"""Squares in contact: the moment against scale mesh, contact edge, and the barrier's two numbers.

    python benchmarks/contact_convergence.py [--output FILE]

PETG squares, closing: moments behind the onset and the slope between the last two samples in units
of D. Bent along a side (0°) walls meet along their top edges; along the diagonal (45°) corners of
diagonal neighbors meet first. Pressed at points (edge 0) a scale gives way the more the finer its
mesh; pressed over the contact edge it does not. "finer" has elements of two thirds in the scales.
"""

from __future__ import annotations

import time
from dataclasses import replace

from report import output_file, report

import flexscale as fs
from flexscale.homogenize.bend_line import Line
from flexscale.homogenize.cell_model import plate_stiffness
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.line import follow_line
from flexscale.solve.solver_options import SolverOptions

CURVATURES = (0.006, 0.009, 0.011, 0.013, 0.016, 0.02)
D = plate_stiffness(fs.TPU, 0.4)
LAYERED = fs.MeshOptions(layer_growth=1.0)
FINER = fs.MeshOptions().finer(1.5)

HEADER = (
    "| direction | scales | edge, mm | d_hat, gap | stiffness | M(0.011), N | M(0.013) | M(0.016) "
    "| M(0.02) | slope, 10³ D | unknowns | s |"
)


def measure(
    name: str, mesh: fs.MeshOptions, contact: fs.ContactOptions, direction: float = 0.0
) -> str:
    """One row: the curve on one mesh."""
    start = time.perf_counter()
    problem = CellProblem.from_pattern(
        fs.Pattern(fs.Tiling("IH76")), fs.NativeModel("shell", contact=contact, mesh=mesh)
    )
    line = Line("closing", direction, CURVATURES)
    samples = list(follow_line(problem, line, SolverOptions()))
    seconds = time.perf_counter() - start
    moments = [sample.get("moment", float("nan")) for sample in samples]
    slope = (moments[-1] - moments[-2]) / (CURVATURES[-1] - CURVATURES[-2]) / D
    cells = [
        f"{direction:g}°",
        name,
        f"{contact.edge:g}",
        f"{contact.activation:g}",
        f"{contact.stiffness:g}",
    ]
    cells += [f"{moment:.3f}" for moment in moments[2:]]
    cells += [f"{1e-3 * slope:.2f}", str(len(problem.active)), f"{seconds:.0f}"]
    row = "| " + " | ".join(cells) + " |"
    print(row, flush=True)
    return row


def main() -> None:
    """Print the table, and write it if asked."""
    output = output_file(__doc__)
    default = fs.ContactOptions()
    cases = [
        (f"{layers} layers", replace(LAYERED, scale_layers=layers), replace(default, edge=edge))
        for edge in (0.0, default.edge)
        for layers in (1, 2, 4, 8)
    ]
    fine = replace(LAYERED, scale_layers=8, scale_corner=0.45, scale_rim=0.2, scale_strips=2)
    cases += [("8 layers, fine rim", fine, replace(default, edge=e)) for e in (0.0, default.edge)]
    mesh = fs.MeshOptions()
    cases += [("default", mesh, replace(default, edge=edge)) for edge in (0.0, 0.25, 0.4, 0.5)]
    cases += [("default", mesh, replace(default, activation=0.0025))]
    cases += [("default", mesh, replace(default, stiffness=factor)) for factor in (0.1, 10.0)]
    scales = ("scale_corner", "scale_rim", "scale_size", "scale_strips", "scale_growth")
    finer = {name: getattr(FINER, name) for name in (*scales, "scale_layers", "layer_growth")}
    diagonal = [
        (name, size, replace(default, edge=edge), 45.0)
        for name, size in (("default", mesh), ("finer", replace(mesh, **finer)))
        for edge in (0.0, 0.25, 0.4, 0.5)
    ]
    print(HEADER)
    rows = [HEADER, "|" + "---|" * HEADER.count(" | ") + "---|"]
    rows += [measure(*case) for case in cases] + [measure(*case) for case in diagonal]
    report(rows, output)


if __name__ == "__main__":
    main()

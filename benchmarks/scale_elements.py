"""Ways to model a scale, at rest: error against unknowns and time of a Newton iteration.

    python benchmarks/scale_elements.py [--output FILE]

Linear tets (as the paper), quadratic tets, and the scale's own modes, each on finer and finer
meshes of the scale; the sheet's mesh is the default. The limit is that of many modes (cutoff 1e-4)
on the finest mesh. An iteration is one assembly of the Hessian and one factorization, on one thread
if OMP_NUM_THREADS=1 is set; contact is switched off, so modes of contact are left out.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

from report import output_file, report

import flexscale as fs
from flexscale.embedding.bends import Bend
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.tangent import solve_tangent

M = fs.MeshOptions()
CASES = (("square", 45.0), ("hexagon", 0.0))
MESHES = {
    "coarse": replace(
        M, scale_rim=0.45, scale_strips=1, scale_growth=3.0, scale_layers=3, layer_growth=3.0
    ),
    "medium": replace(
        M, scale_rim=0.3, scale_strips=2, scale_growth=2.0, scale_layers=4, layer_growth=2.0
    ),
    "fine": M,
}
FINEST = replace(
    M, scale_corner=0.45, scale_size=2.0, scale_rim=0.15, scale_strips=4, scale_growth=1.7,
    scale_layers=6, layer_growth=1.7,
)  # fmt: skip
LINEAR = {
    "2 layers of 2 mm": replace(
        M, scale_size=2.0, scale_corner=2.0, scale_strips=0, scale_layers=2, layer_growth=1.0
    ),
    **MESHES,
    "finest": FINEST,
}


@dataclass(frozen=True)
class Cost:
    """Stiffness [N mm], unknowns, seconds of an iteration and of everything before it."""

    stiffness: float
    unknowns: int
    iteration: float
    setup: float


def measure(name: str, direction: float, mesh: fs.MeshOptions, scales: fs.ScaleOptions) -> Cost:
    """One pattern with one kind of scale on one mesh."""
    start = time.perf_counter()
    contact = fs.ContactOptions(enabled=False)
    problem = CellProblem.from_pattern(
        fs.named_pattern(name), fs.NativeModel("shell", contact=contact, scales=scales, mesh=mesh)
    )
    setup = time.perf_counter() - start
    cell = problem.bent(Bend(1e-4, 0.3))
    best = float("inf")
    for _ in range(4):
        start = time.perf_counter()
        state = cell.evaluate(problem.embedding.rest)
        problem.system.factorize(cell.hessian_values(state))
        best = min(best, time.perf_counter() - start)
    stiffness = float(solve_tangent(problem).stiffness(direction))
    return Cost(stiffness, len(problem.active), best, setup)


def table(name: str, direction: float) -> list[str]:
    """All ways for one pattern."""
    limit = measure(name, direction, FINEST, fs.ScaleOptions(cutoff=1e-4)).stiffness
    rows = [
        f"## {name}, {direction:g}°: limit {limit:.5g} N mm",
        "",
        "| scale | mesh | unknowns | error | iteration, ms | set-up, s |",
        "|---|---|---|---|---|---|",
    ]
    ways = [("linear tets", label, replace(mesh, scale_order=1), fs.ScaleOptions("tets"))
            for label, mesh in LINEAR.items()]  # fmt: skip
    ways += [("quadratic tets", label, mesh, fs.ScaleOptions("tets"))
             for label, mesh in MESHES.items()]  # fmt: skip
    ways += [("modes", label, mesh, fs.ScaleOptions()) for label, mesh in MESHES.items()]
    for way, label, mesh, scales in ways:
        cost = measure(name, direction, mesh, scales)
        rows.append(
            f"| {way} | {label} | {cost.unknowns} | {100.0 * (cost.stiffness / limit - 1.0):+.2f} %"
            f" | {1e3 * cost.iteration:.0f} | {cost.setup:.1f} |"
        )
        print(rows[-1], flush=True)
    return [*rows, ""]


def main() -> None:
    """Both patterns."""
    output = output_file(__doc__)
    measure("square", 0.0, MESHES["coarse"], fs.ScaleOptions())  # compiles
    rows = ["# Ways to model a scale", "", (__doc__ or "").split("\n\n")[2], ""]
    for name, direction in CASES:
        rows += table(name, direction)
    report(rows, output)


if __name__ == "__main__":
    main()

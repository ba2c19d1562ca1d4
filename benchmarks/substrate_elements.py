"""Substrate elements compared: smooth (C1) triangles and edge angles.

    python benchmarks/substrate_elements.py [--output FILE]

Squares bent along a side and along the diagonal, and hexagons, which are isotropic; scales rigid
(modulus times 1e4, few elements) and contact off, so the sheet's elements alone count. Times are of
one thread if `OMP_NUM_THREADS=1` is set, the least of three.
"""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from crossed import cross_gaps
from report import output_file, report

import flexscale as fs
from flexscale.embedding.bends import Bend
from flexscale.homogenize.cell_model import CellModel, plate_stiffness
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.tangent import solve_tangent
from flexscale.mesh.torus import build_mesh

NO_CONTACT = fs.ContactOptions(enabled=False)
RIGID = fs.NeoHookean(young_modulus=2020.0e4, poisson_ratio=0.35)
#: Family -> name and directions of the table, degree; the last one is the hard one.
FAMILIES = {"IH76": ("squares", (0.0, 45.0)), "IH20": ("hexagons", (0.0,))}

#: (across, along, corner, growth, across_grading), mm.
SMOOTH = (
    (2, 2.0, 0.4, 1.6, 1.0), (2, 0.8, 0.25, 1.6, 1.0), (4, 0.8, 0.1, 1.6, 1.6),
    (6, 0.7, 0.03, 1.4, 2.0), (8, 0.5, 0.015, 1.3, 2.0), (12, 0.3, 0.004, 1.25, 1.8),
)  # fmt: skip
#: Elements across and size along, mm: quadrilaterals as long as wide.
UNIFORM = ((2, 0.2), (4, 0.1), (8, 0.05), (16, 0.025))
FINEST = (20, 0.02)
ACROSS = ((2, 0.2), (4, 0.2), (8, 0.2), (16, 0.2))
#: mm, see `paper_note`.
PAPER_SIZE = 0.142
PAPER = ((2, PAPER_SIZE), (4, PAPER_SIZE))


@dataclass(frozen=True)
class Row:
    """Stiffnesses over D, and the cost of a Newton iteration."""

    element: str
    mesh: str
    triangles: int
    unknowns: int
    values: tuple[float, ...]
    assembly: float
    factorization: float

    @property
    def seconds(self) -> float:
        """Of one assembly and factorization."""
        return self.assembly + self.factorization


def options(
    across: int, along: float, corner: float, growth: float = 1.6, grading: float = 1.0
) -> fs.MeshOptions:
    """A mesh whose scales have next to no elements."""
    return fs.MeshOptions(
        across=across, along=along, corner=corner, growth=growth, across_grading=grading,
        scale_size=20.0, scale_corner=20.0, scale_strips=0, scale_layers=1, scale_order=1,
    )  # fmt: skip


def measure(family: str, element: str, mesh: fs.MeshOptions, crossed: bool = False) -> Row:
    """Tangent stiffness and times of one mesh."""
    pattern = fs.Pattern(fs.Tiling(family), scale_material=RIGID)
    torus = build_mesh(pattern, mesh)
    torus = cross_gaps(torus) if crossed else torus
    model = CellModel.of_pattern(
        pattern, fs.NativeModel("shell", substrate=fs.SubstrateOptions(element), contact=NO_CONTACT)
    )
    problem = CellProblem(torus, model)
    tangent = solve_tangent(problem)
    cell = problem.bent(Bend(0.0, 0.0))
    state = cell.evaluate(problem.embedding.rest)
    assembly, factorization = [], []
    for _ in range(3):
        start = time.perf_counter()
        hessian = cell.hessian_values(state)
        assembly.append(time.perf_counter() - start)
        start = time.perf_counter()
        problem.system.factorize(hessian)
        factorization.append(time.perf_counter() - start)
    plate = plate_stiffness(fs.TPU, pattern.substrate_thickness)
    values = tuple(float(tangent.stiffness(d)) / plate for d in FAMILIES[family][1])
    name = f"{mesh.across} × {mesh.along:g}" + (" crossed" if crossed else "")
    triangles = int((torus.triangle_scale < 0).sum())
    unknowns = len(problem.active)
    row = Row(element, name, triangles, unknowns, values, min(assembly), min(factorization))
    print(family, row, flush=True)
    return row


def ladder(
    family: str, element: str, levels: Iterable[tuple[int, float]], crossed: bool = False
) -> list[Row]:
    """One element on meshes of (elements across, size along)."""
    return [measure(family, element, options(n, size, size), crossed) for n, size in levels]


def table(title: str, family: str, rows: list[Row], truth: tuple[float, ...]) -> list[str]:
    """Markdown: stiffness and its distance from the reference, one row a mesh."""
    directions = FAMILIES[family][1]
    heads = ["element", "mesh", "gap triangles", "unknowns"]
    for direction in directions:
        heads += [f"{direction:g}° [D]", "error"]
    heads += ["assembly [s]", "factorization [s]"]
    lines = [f"### {title}", "", f"| {' | '.join(heads)} |", "|" + "---|" * len(heads)]
    for row in rows:
        cells = [row.element, row.mesh, str(row.triangles), str(row.unknowns)]
        for value, reference in zip(row.values, truth, strict=True):
            cells += [f"{value:.5g}", f"{100 * (value / reference - 1):+.1f} %"]
        cells += [f"{row.assembly:.3f}", f"{row.factorization:.3f}"]
        lines.append(f"| {' | '.join(cells)} |")
    return [*lines, ""]


def limit_of(rows: list[Row]) -> str:
    """Observed rate and Richardson limit of three meshes, each twice as fine as the one before."""
    a, b, c = (row.values[-1] for row in rows)
    ratio = (b - a) / (c - b)
    if ratio <= 1.0:
        return "differences do not fall"
    if ratio < np.sqrt(2.0):
        return f"rate {np.log2(ratio):.2f}, too low to tell a limit"
    return f"rate {np.log2(ratio):.2f}, limit {c + (c - b) / (ratio - 1.0):.5g} D"


def equal_cost(rows: list[Row], smooth: list[Row], truth: float) -> list[str]:
    """Each mesh of edge angles against the cheapest smooth one that is no further off."""
    lines = ["| edge angles | error | C1 | error | unknowns | time |", "|---|---|---|---|---|---|"]
    for row in rows:
        error = row.values[-1] / truth - 1.0
        good = [s for s in smooth if abs(s.values[-1] / truth - 1.0) <= abs(error)]
        best = min(good, key=lambda s: s.unknowns)
        lines.append(
            f"| {row.mesh}, {row.unknowns} unknowns | {100 * error:+.1f} % | {best.mesh}, "
            f"{best.unknowns} unknowns | {100 * (best.values[-1] / truth - 1.0):+.1f} % | "
            f"× {row.unknowns / best.unknowns:.1f} | × {row.seconds / best.seconds:.1f} |"
        )
    return [*lines, ""]


def family_report(family: str) -> list[str]:
    """All tables of one family."""
    name, _ = FAMILIES[family]
    smooth = [measure(family, "c1", options(*level)) for level in SMOOTH]
    truth = smooth[-1].values
    angles = ladder(family, "edge_angle", UNIFORM)
    finest = ladder(family, "edge_angle", [FINEST])
    lines = [f"## {name.capitalize()}", "", "Errors are distances from the finest C1 mesh.", ""]
    lines += table("C1", family, smooth, truth)
    lines += table("Edge angles, all sizes halved", family, angles + finest, truth)
    crossed = {}
    for element in ("edge_angle",):
        crossed[element] = ladder(family, element, UNIFORM[:3], crossed=True)
    both = [row for rows in crossed.values() for row in rows]
    lines += table("On crossed diagonals", family, both, truth)
    across = [row for element in crossed for row in ladder(family, element, ACROSS)]
    lines += table("Refined across the gap only", family, across, truth)
    paper = [row for element in crossed for c in (False, True)
             for row in ladder(family, element, PAPER, c)]  # fmt: skip
    lines += table("As fine as the paper's mesh may be", family, paper, truth)
    lines += ["### Limits", ""]
    lines += [f"- edge angles: {limit_of(angles[1:])}; C1: {truth[-1]:.5g} D, from above"]
    for element, rows in crossed.items():
        lines.append(f"- {element}, crossed diagonals: {limit_of(rows)}")
    lines += ["", "### Cost at equal error", "", *equal_cost(angles + finest, smooth, truth[-1])]
    return lines


def paper_note() -> list[str]:
    """What the paper says of its meshes."""
    edge = np.sqrt(4.0 / np.sqrt(3.0) * 5000.0 / 575477)
    return [
        "## The paper's meshes",
        "",
        "The paper gives one count, 577,806 vertices and 575,477 faces for a sheet of 100 mm ×",
        "50 mm (its Fig. 13), and none for its periodic cells. It does not say whether faces of",
        f"scales are among them. If all were the sheet's and alike, their edges were {edge:.3f} mm",
        "long: two to four elements across a gap of 0.4 mm. The tables named after it have that.",
        "",
    ]


def main() -> None:
    """Print all tables, and write them if asked."""
    output = output_file(__doc__)
    solve_tangent(CellProblem.from_pattern(fs.Pattern(fs.Tiling("IH76"))))  # compiles
    measure("IH76", "edge_angle", options(2, 0.8, 0.8))  # compiles
    rows = ["# Substrate elements", "", *paper_note()]
    for family in FAMILIES:
        rows += family_report(family)
    report(rows, output)


if __name__ == "__main__":
    main()

"""Bending stiffness at rest against the mesh and the bond radius, squares and hexagons.

    python benchmarks/stiffness_convergence.py [--output FILE]

First table: rigid scales (modulus times 1e4), so the sheet's mesh alone counts. Then PETG, at one
bond radius a table, against the scale's mesh: with a bond radius there is a limit, without it there
is none. Last, both meshes finer. Each table ends with the default mesh's distance from its finest.
Times are of one thread if `OMP_NUM_THREADS=1` is set; contact is switched off.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from report import output_file, report

import flexscale as fs
from flexscale.embedding.bends import Bend
from flexscale.homogenize.cell_model import plate_stiffness
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.tangent import solve_tangent

DEFAULT = fs.MeshOptions()
SHEETS = {
    "coarse": replace(DEFAULT, along=2.0, corner=0.4),
    "default": DEFAULT,
    "4 across": replace(DEFAULT, across=4, corner=0.1, across_grading=1.6),
    "6 across": replace(
        DEFAULT, across=6, along=0.7, corner=0.03, growth=1.4, across_grading=2.0
    ),
}  # fmt: skip
#: Of a scale, with the default's sheet.
SCALES = {
    "linear tets, 2 layers": replace(
        DEFAULT, scale_order=1, scale_size=2.0, scale_corner=2.0, scale_strips=0,
        scale_layers=2, layer_growth=1.0,
    ),
    "1 layer, no strips": replace(
        DEFAULT, scale_size=2.0, scale_corner=2.0, scale_strips=0, scale_layers=1
    ),
    "4 layers, no strips": replace(
        DEFAULT, scale_size=1.2, scale_corner=1.2, scale_strips=0, scale_layers=4,
        layer_growth=1.0,
    ),
    "default": DEFAULT,
    "4 layers, rim 0.2": replace(
        DEFAULT, scale_size=2.0, scale_corner=0.4, scale_rim=0.2, scale_strips=2,
        scale_growth=2.0, scale_layers=4, layer_growth=2.5,
    ),
    "5 layers, rim 0.1": replace(
        DEFAULT, scale_size=2.0, scale_corner=0.25, scale_rim=0.1, scale_strips=3,
        scale_growth=2.0, scale_layers=5, layer_growth=2.2,
    ),
    "6 layers, rim 0.05": replace(
        DEFAULT, scale_size=2.0, scale_corner=0.25, scale_rim=0.05, scale_strips=4,
        scale_growth=2.0, scale_layers=6, layer_growth=2.2,
    ),
}  # fmt: skip
NO_CONTACT = fs.ContactOptions(enabled=False)
RADII = (0.0, 0.2, 0.4, 0.8)
BOND_RADIUS = 0.8  # mm, the default for a sheet of 0.4 mm
CASES = (("IH76", 0.0), ("IH76", 45.0), ("IH20", 0.0))
RIGID = fs.NeoHookean(young_modulus=2020.0e4, poisson_ratio=0.35)


@dataclass(frozen=True)
class Result:
    """Stiffnesses of `CASES` over D; per family unknowns and seconds of a Newton iteration."""

    values: tuple[float, ...]
    unknowns: tuple[int, ...]
    assembly: tuple[float, ...]
    factorization: tuple[float, ...]


def measure(mesh: fs.MeshOptions, material: fs.NeoHookean, bond_radius: float) -> Result:
    """Tangent stiffness of both families on one mesh."""
    plate = plate_stiffness(fs.TPU, 0.4)
    values, unknowns, assembly, factorization = [], [], [], []
    for family in ("IH76", "IH20"):
        pattern = fs.Pattern(fs.Tiling(family), scale_material=material, bond_radius=bond_radius)
        problem = CellProblem.from_pattern(
            pattern, fs.NativeModel("shell", contact=NO_CONTACT, mesh=mesh)
        )
        tangent = solve_tangent(problem)
        values += [float(tangent.stiffness(d)) / plate for f, d in CASES if f == family]
        unknowns.append(len(problem.active))
        cell = problem.bent(Bend(0.0, 0.0))
        start = time.perf_counter()
        hessian = cell.hessian_values(cell.evaluate(problem.embedding.rest))
        assembly.append(time.perf_counter() - start)
        start = time.perf_counter()
        problem.system.factorize(hessian)
        factorization.append(time.perf_counter() - start)
    return Result(tuple(values), tuple(unknowns), tuple(assembly), tuple(factorization))


def table(title: str, first: str, results: Iterable[tuple[str, Result]]) -> list[str]:
    """Markdown: a heading, a row per mesh, and the default's distance from the last."""
    heads = [f"{family} {direction:g}° [D]" for family, direction in CASES]
    heads = [first, *heads, "unknowns", "assembly [s]", "factorization [s]"]
    rows = [f"## {title}", "", f"| {' | '.join(heads)} |", "|" + "---|" * len(heads)]
    values: dict[str, Sequence[float]] = {}
    for name, result in results:
        values[name] = result.values
        cells = [name, *(f"{value:.5g}" for value in result.values)]
        cells.append(", ".join(str(n) for n in result.unknowns))
        for seconds in (result.assembly, result.factorization):
            cells.append(", ".join(f"{s:.3f}" for s in seconds))
        rows.append(f"| {' | '.join(cells)} |")
        print(rows[-1], flush=True)
    if "default" in values:
        finest = list(values.values())[-1]
        errors = [
            f"{100 * (a / b - 1):+.1f} %" for a, b in zip(values["default"], finest, strict=True)
        ]
        rows.append(f"| default against last | {' | '.join(errors)} | | | |")
    return [*rows, ""]


def main() -> None:
    """Print all tables, and write them if asked."""
    output = output_file(__doc__)
    solve_tangent(CellProblem.from_pattern(fs.Pattern(fs.Tiling("IH76"))))  # compiles
    rows = ["# Bending stiffness at rest against the mesh", ""]
    rows += table(
        "Rigid scales",
        "sheet",
        ((name, measure(mesh, RIGID, BOND_RADIUS)) for name, mesh in SHEETS.items()),
    )
    for radius in RADII:
        rows += table(
            f"PETG scales, bond radius {radius:g} mm",
            "scale",
            ((name, measure(mesh, fs.PETG, radius)) for name, mesh in SCALES.items()),
        )
    sheet = SHEETS["6 across"]
    finest = replace(
        SCALES["5 layers, rim 0.1"],
        across=sheet.across, along=sheet.along, corner=sheet.corner, growth=sheet.growth,
        across_grading=sheet.across_grading,
    )  # fmt: skip
    meshes = {"default": DEFAULT, "6 across; 5 layers, rim 0.1": finest}
    rows += table(
        f"PETG scales, bond radius {BOND_RADIUS:g} mm, both meshes finer",
        "mesh",
        ((name, measure(mesh, fs.PETG, BOND_RADIUS)) for name, mesh in meshes.items()),
    )
    report(rows, output)


if __name__ == "__main__":
    main()

"""Sheets of fitted models, 100 x 50 mm at 0.02 /mm: energy, error and time by element.

    python benchmarks/fitted_sheet.py --results DIR [--output FILE]

Models are those that `flexscale run` has fitted in DIR. The paper's linear triangles at its number
of faces against smooth ones: errors are distances of the energy from the limit of the same element,
extrapolated from its two finest meshes at the second order. Times are of one core, mesh and pattern
analysis included. The last column compares with the law itself, E(kappa) times the area: sheets
give way at their free edges.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from macro_shell import COST_HEAD, CURVATURE, LENGTH, WIDTH, bend, cost_cells
from report import report

import flexscale as fs

SIZES = {"edge_angle": (3.0, 1.476), "c1": (12.0, 6.0, 3.0)}
DIRECTIONS = (0.0, 45.0, 90.0)


def table(name: str, model: fs.MacroModel) -> list[str]:
    """Both elements, in some directions."""
    head = f"{COST_HEAD[:-1]}| energy [N mm] | error | over the law |"
    rows = []
    for direction in DIRECTIONS:
        law = float(model.energy(CURVATURE, direction)) * LENGTH * WIDTH
        rows += [f"## {name}, along {direction:g}°", "", head, "|" + "---|" * 14]
        for element, sizes in SIZES.items():
            costs = [
                bend(element, size, 1, law=model.sheet_law(), direction=direction) for size in sizes
            ]
            energies = [cost.sheet.energy for cost in costs]
            ratio = (sizes[-2] / sizes[-1]) ** 2
            limit = energies[-1] + (energies[-1] - energies[-2]) / (ratio - 1.0)
            for size, cost in zip(sizes, costs, strict=True):
                cells = cost_cells(element, size, cost)
                cells += [
                    f"{cost.sheet.energy:.3f}",
                    f"{100 * (cost.sheet.energy / limit - 1):+.3f} %",
                ]
                rows.append(f"| {' | '.join([*cells, f'{cost.sheet.energy / law:.3f}'])} |")
        rows.append("")
    return rows


def main() -> None:
    """All fits of a results folder, or the named ones."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--results", type=Path, required=True, help="folder of the datasets")
    parser.add_argument("--patterns", nargs="+", help="patterns; all that are fitted if left out")
    parser.add_argument("--output", type=Path, help="write the tables to this Markdown file too")
    arguments = parser.parse_args()
    registry = fs.open_registry(arguments.results)
    rows = ["# Sheets of fitted models", "", (__doc__ or "").split("\n\n")[2], ""]
    for entry in registry.find(kind="fit"):
        model = fs.MacroModel.from_dataset(registry.load(entry))
        name = str(model.labels["pattern"])
        if not arguments.patterns or name in arguments.patterns:
            rows += table(name, model)
    report(rows, arguments.output)


if __name__ == "__main__":
    main()

"""The twelve named patterns at rest: symmetry, softest and stiffest direction, time.

    python benchmarks/named_patterns.py [--output FILE]

The bending stiffness a(θ) of a pattern with rotations of order 3, 4 or 6 must be constant, or of
period 90°. The last two columns give the largest departure from that, relative to the mean of a:
with the mesh that FlexScale makes, which has the symmetry of the pattern, and with an ordinary mesh
of the same element sizes, which has not (tiles sheared by 1e-6 are no longer congruent, so every
tile is meshed for itself and as a whole).
"""

from __future__ import annotations

import time

import numpy as np
from report import output_file, report

import flexscale as fs
from flexscale.homogenize.cell_model import plate_stiffness
from flexscale.homogenize.cell_problem import CellProblem

D = plate_stiffness(fs.TPU, 0.4)
ANGLES = np.arange(0.0, 180.0, 5.0)
HEADER = (
    "| pattern | family | drawn group | scales | softest | at | stiffest | at | ratio "
    "| unknowns | mesh, s | all, s | departure | unsymmetric mesh |"
)


def sheared(pattern: fs.Pattern) -> fs.Pattern:
    """The same pattern but for a shear of 1e-6, which breaks all symmetries but half turns."""
    shear = np.eye(2) + 1e-6 * np.array([[0.7, 0.9], [0.4, -0.7]])
    tiles = [tile @ shear for tile in pattern.tiles]
    return fs.Pattern.from_polygons(tiles, *(pattern.lattice @ shear))


def departure(tangent: fs.TangentStiffness, rotation_order: int) -> float:
    """Largest relative departure of a(θ) from the period that rotations ask for; nan without."""
    turn = {3: None, 6: None, 4: 90.0}.get(rotation_order, 0.0)
    a = np.array([tangent.stiffness(angle) for angle in ANGLES])
    if turn == 0.0:
        return float("nan")
    if turn is None:
        return float(np.abs(a - a.mean()).max() / a.mean())
    turned = np.array([tangent.stiffness(angle + turn) for angle in ANGLES])
    return float(np.abs(a - turned).max() / a.mean())


def measure(name: str) -> str:
    """One row of the table."""
    start = time.perf_counter()
    pattern = fs.named_pattern(name)
    symmetry = pattern.symmetry()
    problem = CellProblem.from_pattern(pattern)
    meshed = time.perf_counter() - start
    tangent = fs.tangent_stiffness(pattern)
    seconds = time.perf_counter() - start - meshed
    off = departure(tangent, symmetry.rotation_order)
    cells = [name, pattern.family, symmetry.group, str(pattern.n_scales)]
    for angle in (tangent.softest, tangent.stiffest):
        cells += [f"{tangent.stiffness(angle) / D:.4g} D", f"{round(angle, 1) % 180.0:.1f}°"]
    ratio = tangent.stiffness(tangent.stiffest) / tangent.stiffness(tangent.softest)
    cells += [f"{ratio:.4g}", str(len(problem.active)), f"{meshed:.1f}", f"{seconds:.1f}"]
    if np.isnan(off):
        cells += ["", ""]
    else:
        ordinary = departure(fs.tangent_stiffness(sheared(pattern)), symmetry.rotation_order)
        cells += [f"{off:.0e}", f"{ordinary:.1e}"]
    row = "| " + " | ".join(cells) + " |"
    print(row, flush=True)
    return row


def main() -> None:
    """Print the table, and write it if asked."""
    output = output_file(__doc__)
    fs.tangent_stiffness(fs.named_pattern("square"))  # compiles
    rows = [HEADER, "|" + "---|" * (HEADER.count("|") - 1)]
    rows += [measure(entry.name) for entry in fs.named_patterns()]
    report(rows, output)


if __name__ == "__main__":
    main()

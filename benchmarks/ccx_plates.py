"""Plates of exported sections in CalculiX, and what they should do, for tests and benchmarks."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import flexscale as fs
from flexscale.homogenize.tangent import TangentStiffness
from flexscale.mechanics.linear_law import linear_sheet
from flexscale.mesh.sheet import crossed_rectangle
from flexscale.sheets.conditions import Conditions
from flexscale.sheets.load_path import follow_loads
from flexscale.sheets.sheet import build_sheet
from flexscale.sheets.sheet_problem import SheetProblem
from flexscale.solve.solver_options import SolverOptions

LENGTH, WIDTH = 60.0, 20.0  # mm, of a cantilever
SIDE = 60.0  # mm, of the twisted plate


@dataclass(frozen=True)
class Plate:
    """A rectangle [0, length] × [0, width] of elements S8R.

    Attributes
    ----------
    points : (n, 2) mm.
    elements : (m, 8) node numbers, from 1.
    """

    points: np.ndarray
    elements: np.ndarray

    def at(self, condition: np.ndarray) -> list[int]:
        """Numbers of the nodes that meet a condition, (n,) bool."""
        return (np.flatnonzero(condition) + 1).tolist()


def build_plate(length: float, width: float, cells: tuple[int, int]) -> Plate:
    numbers: dict[tuple[int, int], int] = {}
    ring = ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1))
    elements = [
        [numbers.setdefault((2 * i + a, 2 * j + b), len(numbers) + 1) for a, b in ring]
        for i in range(cells[0])
        for j in range(cells[1])
    ]
    places = np.array(list(numbers), dtype=float)
    return Plate(places * [0.5 * length / cells[0], 0.5 * width / cells[1]], np.array(elements))


def solve_plate(
    folder: Path,
    plate: Plate,
    section: Path,
    supports: Sequence[tuple[int, int, int]],
    loads: Sequence[tuple[int, int, float]],
) -> np.ndarray:
    """(n, 3) displacements [mm]; supports are (node, first, last degree of freedom), loads (node,
    degree of freedom, force in N)."""
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{i}, {x:.12g}, {y:.12g}, 0." for i, (x, y) in enumerate(plate.points, 1)]
    lines.append("*ELEMENT, TYPE=S8R, ELSET=FLEXSCALE")
    lines += [", ".join(map(str, (i, *nodes))) for i, nodes in enumerate(plate.elements, 1)]
    lines += [f"*INCLUDE, INPUT={section.name}", "*BOUNDARY"]
    lines += [f"{node}, {first}, {last}, 0." for node, first, last in supports]
    lines += ["*STEP", "*STATIC", "*CLOAD"]
    lines += [f"{node}, {axis}, {force:.12e}" for node, axis, force in loads]
    lines += ["*NODE PRINT, NSET=ALL", "U", "*END STEP"]
    (folder / "job.inp").write_text("\n".join(lines) + "\n")
    done = subprocess.run(["ccx", "-i", "job"], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-2000:]
    text = (folder / "job.dat").read_text()
    rows = [line.split() for line in text.splitlines() if re.match(r"\s+\d+\s+-?\d\.", line)]
    assert len(rows) == len(plate.points), done.stdout[-2000:]
    found = np.zeros((len(rows), 3))
    for number, *values in rows:
        found[int(number) - 1] = [float(value) for value in values]
    return found


def twisted_plate(tangent: TangentStiffness, folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Deflections (n,) of a square plate on three corners with a force P on the fourth.

    Kirchhoff's corner forces make a uniform moment M_xy = P/2, and so uniform curvatures D⁻¹ (0, 0,
    P/2): the second array.
    """
    force = 1e-3
    section = fs.export(tangent, to="calculix", path=folder / "section.inp", replace=True)
    plate = build_plate(SIDE, SIDE, (10, 10))
    x, y = plate.points.T
    (first,), (second,) = plate.at((x == 0) & (y == 0)), plate.at((x == SIDE) & (y == 0))
    (third,), (free,) = plate.at((x == 0) & (y == SIDE)), plate.at((x == SIDE) & (y == SIDE))
    supports = [(first, 1, 3), (second, 2, 3), (third, 3, 3)]
    found = solve_plate(folder, plate, section, supports, [(free, 3, force)])[:, 2]
    k = np.linalg.solve(tangent.matrix, [0.0, 0.0, 0.5 * force])
    return found, 0.5 * (k[0] * x * (x - SIDE) + k[1] * y * (y - SIDE) + k[2] * x * y)


def cantilever(
    tangent: TangentStiffness, folder: Path, cells: tuple[int, int] = (48, 16)
) -> tuple[float, float]:
    """Deflection of the middle of a clamped strip's end under a small force there, in CalculiX and
    by our own sheet of the same A and D; `cells` along and across."""
    force = 1e-4
    section = fs.export(tangent, to="calculix", path=folder / "section.inp", replace=True)
    plate = build_plate(LENGTH, WIDTH, cells)
    x, y = plate.points.T
    end = np.array(plate.at(x > LENGTH - 1e-9))
    end = end[np.argsort(y[end - 1])]
    shares = np.zeros(len(end))  # of a quadratic edge: 1, 4, 1 sixths of each element's
    for cell in range(cells[1]):
        shares[2 * cell : 2 * cell + 3] += np.array([1.0, 4.0, 1.0]) / (6.0 * cells[1])
    loads = [(int(node), 3, force * share) for node, share in zip(end, shares, strict=True)]
    supports = [(node, 1, 6) for node in plate.at(x < 1e-9)]
    found = solve_plate(folder, plate, section, supports, loads)
    return float(found[end[len(end) // 2] - 1, 2]), _our_tip(tangent, force, cells)


def _our_tip(tangent: TangentStiffness, force: float, cells: tuple[int, int]) -> float:
    mesh = crossed_rectangle((0.0, LENGTH), (0.0, WIDTH), cells)
    x = mesh.points[:, 0]
    left, right = x < 1e-9, x > LENGTH - 1e-9
    law = linear_sheet(tangent.in_plane, tangent.matrix)
    sheet = build_sheet(mesh, law, clamped=left)
    conditions = Conditions(sheet)
    conditions.clamp(left)
    conditions.load_line(right, (0.0, 0.0, force / WIDTH))
    (step,) = follow_loads(SheetProblem(conditions), (1.0,), SolverOptions(max_iterations=400))
    assert step.status == 0
    middle = right & (np.abs(mesh.points[:, 1] - 0.5 * WIDTH) < 1e-9)
    return float(step.state.y[sheet.rows.positions(middle)][0, 2])

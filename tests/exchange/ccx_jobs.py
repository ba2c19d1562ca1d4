"""Plates of exported sections in CalculiX."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np


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

"""Cells that the physics tests share; D is the bending stiffness of the paper's substrate."""

from __future__ import annotations

from functools import cache

import flexscale as fs
from flexscale.homogenize.cell_model import plate_stiffness
from flexscale.homogenize.cell_problem import CellProblem

D = plate_stiffness(fs.TPU, 0.4)  # 0.18018 N mm

#: PETG with its modulus times 1e4: the closed forms assume rigid scales.
RIGID = fs.NeoHookean(young_modulus=2020.0e4, poisson_ratio=0.35)

#: The finer mesh of the comparison with the literature values.
FINE = fs.MeshOptions(across=6, along=0.7, corner=0.03, growth=1.4, across_grading=2.0)


def square(**changes) -> fs.Pattern:
    """Squares of side 10 mm, the paper's sizes and materials."""
    return fs.Pattern(fs.Tiling("IH76"), **changes)


def hexagon(**changes) -> fs.Pattern:
    """Regular hexagons of 100 mm2, the paper's sizes and materials."""
    return fs.Pattern(fs.Tiling("IH20"), **changes)


@cache
def square_problem() -> CellProblem:
    """The default square cell, set up once."""
    return CellProblem.from_pattern(square())


@cache
def hexagon_problem() -> CellProblem:
    """The default hexagon cell, set up once."""
    return CellProblem.from_pattern(hexagon())

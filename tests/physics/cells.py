"""Cells that the physics tests share; D is the bending stiffness of the paper's substrate."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import pytest

import flexscale as fs
from flexscale.homogenize.cell_model import plate_stiffness
from flexscale.homogenize.cell_problem import CellProblem

D = plate_stiffness(fs.TPU, 0.4)  # 0.18018 N mm

#: PETG with its modulus times 1e4: the closed forms assume rigid scales.
RIGID = fs.NeoHookean(young_modulus=2020.0e4, poisson_ratio=0.35)

#: The finer mesh of the comparison with the literature values.
FINE = fs.MeshOptions(across=6, along=0.7, corner=0.03, growth=1.4, across_grading=2.0)

#: Half as fine as the default: a tenth of the time, and the stiffness of squares within 1 %.
COARSE = fs.MeshOptions().finer(0.5)

#: For what must hold on every mesh: the coarse one, and with `make test-slow` the default.
MESHES = [
    pytest.param(COARSE, id="coarse"),
    pytest.param(fs.MeshOptions(), marks=pytest.mark.slow, id="default"),
]


def few_tets(mesh: fs.MeshOptions) -> fs.MeshOptions:
    """The same sheet under scales of few finite elements, enough for those that are rigid."""
    return replace(mesh, scale_size=10.0, scale_layers=1, scale_order=1)


def square(**changes) -> fs.Pattern:
    """Squares of side 10 mm, the paper's sizes and materials."""
    return fs.Pattern(fs.Tiling("IH76"), **changes)


def hexagon(**changes) -> fs.Pattern:
    """Regular hexagons of 100 mm2, the paper's sizes and materials."""
    return fs.Pattern(fs.Tiling("IH20"), **changes)


@cache
def square_problem(mesh: fs.MeshOptions = COARSE) -> CellProblem:
    """The square cell, set up once for each mesh."""
    return CellProblem.from_pattern(square(), fs.NativeModel("shell", mesh=mesh))


@cache
def hexagon_problem(mesh: fs.MeshOptions = COARSE) -> CellProblem:
    """The hexagon cell, set up once for each mesh."""
    return CellProblem.from_pattern(hexagon(), fs.NativeModel("shell", mesh=mesh))

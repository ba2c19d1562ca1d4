"""From a pattern to its bending response: cell problem, tangent at rest, sweeps of curvature."""

from flexscale.homogenize.cell_problem import CellProblem as CellProblem
from flexscale.homogenize.shape import solve_shapes as solve_shapes
from flexscale.homogenize.sweep import check_sweep as check_sweep
from flexscale.homogenize.sweep import sweep as sweep
from flexscale.homogenize.tangent import TangentStiffness as TangentStiffness
from flexscale.homogenize.tangent import tangent_stiffness as tangent_stiffness
from flexscale.solve.newton import SolverOptions as SolverOptions

"""Finite bending before contact: moment, energy, symmetry of the two sides."""

from __future__ import annotations

import numpy as np
import pytest

import flexscale as fs
from flexscale.embedding.bends import Bend
from flexscale.homogenize.bend_line import Line
from flexscale.homogenize.cell_model import CellModel
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.line import follow_line
from flexscale.homogenize.tangent import solve_tangent
from flexscale.mechanics.scale_options import SCALE_MODELS
from flexscale.mesh.bare import build_bare_mesh
from flexscale.solve.newton import solve_equilibrium
from flexscale.solve.solver_options import SolverOptions
from flexscale.status import SolveStatus
from tests.derivatives import directional_difference, multiply_upper, relative_error
from tests.physics.cells import (
    MESHES,
    D,
    hexagon,
    hexagon_problem,
    square,
    square_problem,
)

#: Several layers of tets, as fewer modes would have nothing to leave out.
LAYERED = fs.MeshOptions(
    across=2, corner=0.25, growth=1.6, scale_rim=0.45, scale_strips=1, scale_growth=3.0,
    scale_layers=3, layer_growth=3.0,
)  # fmt: skip


def solve(problem, curvature, degrees, options=None, start=None):
    """Equilibrium of a cell under one bend, and its objective."""
    cell = problem.bent(Bend(curvature, float(np.radians(degrees))))
    z = problem.embedding.rest if start is None else start
    return cell, solve_equilibrium(cell, z, options or SolverOptions())


@pytest.mark.parametrize("degrees", [0.0, 37.0])
@pytest.mark.parametrize("curvature", [0.02, -0.02])
def test_bare_sheet_has_moment_d_kappa(curvature, degrees):
    """A cylinder of unstretched sheet is exact: M = D kappa and F = I; the issue asks for 0.1 %."""
    lattice = np.array([[3.0, 0.0], [1.0, 2.5]])
    problem = CellProblem(build_bare_mesh(lattice, 1.0), CellModel.of_pattern(square()))
    cell, solution = solve(problem, curvature, degrees)
    assert solution.status == SolveStatus.converged
    assert cell.moment(solution.evaluation) == pytest.approx(D * curvature, rel=1e-4)
    assert np.abs(solution.z[-3:]).max() < 1e-4


@pytest.mark.parametrize("scales", SCALE_MODELS)
@pytest.mark.parametrize("make", [pytest.param(square, marks=pytest.mark.slow), hexagon])
def test_derivatives_of_the_bent_cell(make, scales):
    """Gradient, unprojected Hessian, moment and load rate in z at a random deformed state.

    Of squares, whose lattice vectors lie along the axes, it is a special case of hexagons.
    """
    # Contact has tests of its own: a random state would press scales together.
    contact = fs.ContactOptions(enabled=False)
    problem = CellProblem.from_pattern(
        make(),
        fs.NativeModel("shell", contact=contact, scales=fs.ScaleOptions(scales), mesh=LAYERED),
    )
    generator = np.random.default_rng(4)
    rest = problem.embedding.rest
    line = Line("closing", 23.0, (0.005,))
    (sample,) = follow_line(problem, line, SolverOptions())
    z = sample["state"] + 5e-5 * generator.normal(size=len(rest))
    bend = line.bend(0.005)
    cell, state = problem.bent(bend), problem.bent(bend).evaluate(z)
    direction = np.zeros(len(rest))
    direction[problem.active] = generator.normal(size=len(problem.active))

    slope = directional_difference(lambda h: cell.evaluate(z + h * direction).energy, 3e-6)
    assert relative_error(state.gradient @ direction[problem.active], slope) < 1e-8
    curve = directional_difference(lambda h: cell.evaluate(z + h * direction).gradient, 3e-6)
    upper = cell.hessian_values(state)
    product = multiply_upper(problem.pull_back, upper, direction[problem.active])
    assert relative_error(product, curve) < 1e-7

    def bent(h):
        return problem.bent(Bend(bend.curvature + h, bend.direction)).evaluate(z)

    slope = directional_difference(lambda h: bent(h).energy, 3e-6)
    assert relative_error(cell.moment(state) * problem.area, slope) < 1e-8
    rate = directional_difference(lambda h: bent(h).gradient, 3e-6)
    assert relative_error(cell.gradient_rate(state), rate) < 1e-8


@pytest.mark.parametrize("degrees", [0.0, 20.0, 45.0])
@pytest.mark.parametrize("mesh", MESHES)
def test_tangent_is_the_initial_slope_of_a_sweep(mesh, degrees):
    """M / kappa at 1e-4 mm-1 within 0.1 % of C : nnnn (real moduli)."""
    problem = square_problem(mesh)
    tangent = solve_tangent(problem)
    (sample,) = follow_line(problem, Line("closing", degrees, (1e-4,)), SolverOptions())
    slope = sample["moment"] / 1e-4
    assert slope == pytest.approx(tangent.stiffness(degrees), rel=1e-3)


def test_small_curvature_is_solved_as_accurately():
    """At 1e-5 mm-1 M / kappa still meets the tangent: stopping is relative to the sample."""
    tangent = solve_tangent(square_problem())
    cell, solution = solve(square_problem(), 1e-5, 0.0)
    assert solution.status == SolveStatus.converged
    assert cell.moment(solution.evaluation) / 1e-5 == pytest.approx(
        tangent.stiffness(0.0), rel=1e-6
    )


@pytest.mark.parametrize("mesh", MESHES)
def test_moment_is_the_derivative_of_the_energy_curve(mesh):
    """Envelope theorem: M = dE/dkappa along equilibria, without differentiating the state."""
    problem, kappa = square_problem(mesh), 0.01
    (sample,) = follow_line(problem, Line("closing", 30.0, (kappa,)), SolverOptions())

    def energy(h):
        start = sample["state"] + h * sample["rate"]
        return solve(problem, kappa + h, 30.0, start=start)[1].evaluation.energy / problem.area

    cell, solution = solve(problem, kappa, 30.0, start=sample["state"])
    slope = directional_difference(energy, 2e-4)
    assert cell.moment(solution.evaluation) == pytest.approx(slope, rel=1e-6)


@pytest.mark.parametrize("degrees", [0.0, 30.0])
@pytest.mark.parametrize("mesh", MESHES)
def test_opening_and_closing_part_at_second_order(mesh, degrees):
    """Both sides have one slope; their moments differ by O(kappa^2), a factor 4 for 2 kappa."""
    problem = hexagon_problem(mesh)
    moments = []
    for side in ("closing", "opening"):
        samples = follow_line(problem, Line(side, degrees, (0.001, 0.002)), SolverOptions())
        moments.append([sample["moment"] for sample in samples])
    parts = np.subtract(*moments)
    assert parts[1] / parts[0] == pytest.approx(4.0, rel=0.05)


def test_the_constraint_holds_and_does_no_work_at_small_curvature():
    problem = square_problem()
    _, solution = solve(problem, 0.01, 45.0)
    assert abs(problem.embedding.mean_offset @ solution.z) < 1e-15
    assert solution.negative_eigenvalues == 0


@pytest.mark.parametrize("mesh", MESHES)
def test_sweep_has_the_symmetry_of_squares(mesh):
    """Directions 30 and 60 degree are mirror images, 20 and 110 degree quarter turns."""
    model = fs.NativeModel("shell", mesh=mesh)
    data = fs.sweep(square(), [20.0, 30.0, 60.0, 110.0], [0.004, 0.008], workers=1, model=model)
    moment = data.moment
    assert moment.sel(direction=30.0).values == pytest.approx(
        moment.sel(direction=60.0).values, rel=1e-8
    )
    assert moment.sel(direction=20.0).values == pytest.approx(
        moment.sel(direction=110.0).values, rel=1e-8
    )


@pytest.mark.parametrize("mesh", MESHES)
def test_sweep_has_the_symmetry_of_hexagons(mesh):
    model = fs.NativeModel("shell", mesh=mesh)
    data = fs.sweep(hexagon(), [10.0, 50.0, 70.0], [0.008], ["opening"], workers=1, model=model)
    assert data.moment.values.ravel() == pytest.approx([float(data.moment[0, 0, 0])] * 3, rel=1e-8)

"""Cells with the paper's substrate elements: exact cases, derivatives, invariances."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import flexscale as fs
from flexscale.embedding.bends import Bend
from flexscale.homogenize.cell_model import CellModel
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.tangent import solve_tangent
from flexscale.mesh.bare import build_bare_mesh
from flexscale.mesh.periodic_mesh import GAP_EDGE
from flexscale.mesh.topology import build_edges
from flexscale.solve.newton import solve_equilibrium
from flexscale.solve.solver_options import SolverOptions
from flexscale.status import SolveStatus
from tests.derivatives import directional_difference, multiply_upper, relative_error
from tests.physics.cells import COARSE, RIGID, D, few_tets, hexagon, square

OBLIQUE = np.array([[3.0, 0.0], [1.0, 2.5]])
NU = fs.TPU.poisson_ratio
PLATE = D * np.array([[1.0, NU, 0.0], [NU, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - NU)]])
EDGE_ANGLE = fs.SubstrateOptions("edge_angle")


@pytest.fixture(scope="module")
def cell():
    """A coarse cell of the pattern that `make` builds, each set up once."""
    # Without contact, which has tests of its own: random states would press scales together.
    contact = fs.ContactOptions(enabled=False)
    return cache(
        lambda make, options: CellProblem.from_pattern(
            make(), fs.NativeModel("shell", contact=contact, substrate=options, mesh=COARSE)
        )
    )


def test_bare_sheet_is_an_isotropic_plate():
    """Edge angles hold every quadratic height, so the tangent is exact on any mesh."""
    model = CellModel.of_pattern(square(), fs.NativeModel("shell", substrate=EDGE_ANGLE))
    problem = CellProblem(build_bare_mesh(OBLIQUE, 1.5), model)
    assert solve_tangent(problem).matrix == pytest.approx(PLATE, abs=1e-9 * D)


def test_a_vertex_of_three_triangles():
    """Each of its triangles meets one vertex across two edges; the plate stays exact."""
    mesh = build_bare_mesh(OBLIQUE, 1.5)
    corners, offsets = mesh.triangles[0], mesh.triangle_offsets[0]
    triangles, shifts = np.repeat(corners[None], 3, axis=0), np.repeat(offsets[None], 3, axis=0)
    for k in range(3):
        triangles[k, k], shifts[k, k] = mesh.n_vertices, 0
    triangles = np.concatenate([triangles, mesh.triangles[1:]])
    shifts = np.concatenate([shifts, mesh.triangle_offsets[1:]])
    topology = build_edges(triangles, shifts)
    split = replace(
        mesh,
        positions=np.vstack([mesh.positions, mesh.corner_positions()[0].mean(axis=0)]),
        triangles=triangles,
        triangle_offsets=shifts,
        triangle_scale=np.full(len(triangles), -1),
        vertex_scale=np.append(mesh.vertex_scale, -1),
        vertex_kind=np.append(mesh.vertex_kind, mesh.vertex_kind[0]),
        outline_tangent=np.vstack([mesh.outline_tangent, [0.0, 0.0]]),
        edges=topology.edges,
        edge_shift=topology.edge_shift,
        triangle_edges=topology.triangle_edges,
        triangle_edge_offsets=topology.triangle_edge_offsets,
        edge_scale=np.full(len(topology.edges), GAP_EDGE),
    )
    split.validate()
    problem = CellProblem(
        split, CellModel.of_pattern(square(), fs.NativeModel("shell", substrate=EDGE_ANGLE))
    )
    assert solve_tangent(problem).matrix == pytest.approx(PLATE, abs=1e-9 * D)
    state = 0.01 * np.random.default_rng(1).normal(size=len(problem.embedding.rest))
    bent, z = problem.bent(Bend(0.05, 0.3)), problem.embedding.rest + state
    direction = np.zeros_like(z)
    direction[problem.active] = state[problem.active]
    curve = directional_difference(lambda h: bent.evaluate(z + h * direction).gradient, 1e-3)
    upper = bent.hessian_values(bent.evaluate(z))
    product = multiply_upper(problem.pull_back, upper, direction[problem.active])
    assert relative_error(product, curve) < 1e-8


def test_a_bent_bare_sheet_converges_to_that_of_smooth_elements():
    """Chords of a circle: second order in the element size, to the same law at 0.1 mm-1."""

    def moment(options: fs.SubstrateOptions, size: float) -> float:
        model = CellModel.of_pattern(square(), fs.NativeModel("shell", substrate=options))
        problem = CellProblem(build_bare_mesh(OBLIQUE, size), model)
        bent = problem.bent(Bend(0.1, 0.6))
        solution = solve_equilibrium(bent, problem.embedding.rest, SolverOptions())
        assert solution.status == SolveStatus.converged
        return bent.moment(solution.evaluation)

    limit = moment(fs.SubstrateOptions("c1", bending_measure="turn"), 0.6)
    errors = [moment(EDGE_ANGLE, size) / limit - 1.0 for size in (0.6, 0.3)]
    assert abs(errors[1]) < 2e-4
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.15)


@pytest.mark.parametrize("make", [square, pytest.param(hexagon, marks=pytest.mark.slow)])
@pytest.mark.parametrize("options", [EDGE_ANGLE])
def test_derivatives_of_the_bent_cell(cell, make, options):
    """Gradient, unprojected Hessian, moment and load rate at a random state, in all unknowns."""
    problem = cell(make, options)
    generator = np.random.default_rng(4)
    rest = problem.embedding.rest
    z = rest + 2e-3 * generator.normal(size=len(rest))
    bend = Bend(0.03, 0.4)
    bent, state = problem.bent(bend), problem.bent(bend).evaluate(z)
    direction = np.zeros(len(rest))
    direction[problem.active] = generator.normal(size=len(problem.active))

    slope = directional_difference(lambda h: bent.evaluate(z + h * direction).energy, 1e-5)
    assert relative_error(state.gradient @ direction[problem.active], slope) < 1e-8
    curve = directional_difference(lambda h: bent.evaluate(z + h * direction).gradient, 1e-5)
    upper = bent.hessian_values(state)
    product = multiply_upper(problem.pull_back, upper, direction[problem.active])
    assert relative_error(product, curve) < 1e-8

    def at(h):
        return problem.bent(Bend(bend.curvature + h, bend.direction)).evaluate(z)

    slope = directional_difference(lambda h: at(h).energy, 1e-5)
    assert relative_error(bent.moment(state) * problem.area, slope) < 1e-8
    rate = directional_difference(lambda h: at(h).gradient, 1e-5)
    assert relative_error(bent.gradient_rate(state), rate) < 1e-8


def test_edge_angles_make_exact_hinges():
    """Rigid squares along a side, a = D P / g: one smooth bend across each gap, 2 % as for C1."""
    tangent = fs.tangent_stiffness(
        square(scale_material=RIGID),
        model=fs.NativeModel("shell", mesh=few_tets(fs.MeshOptions()), substrate=EDGE_ANGLE),
    )
    assert tangent.stiffness(0.0) == pytest.approx(24.8 * D, rel=0.02)


@pytest.mark.parametrize(
    ("make", "direction"),
    [(square, 45.0), pytest.param(hexagon, 20.0, marks=pytest.mark.slow)],
)
def test_edge_angles_converge_from_below(make, direction):
    """S-shaped strips: C1 from above, edge angles from below; together they bracket the truth."""
    found = []
    for size in (0.6, 0.3, 0.15):
        mesh = fs.MeshOptions(
            across=2, along=size, corner=size, scale_strips=0, scale_layers=1, scale_order=1
        )
        pattern = make(scale_material=RIGID)
        found.append(
            fs.tangent_stiffness(
                pattern, model=fs.NativeModel("shell", mesh=mesh, substrate=EDGE_ANGLE)
            )
        )
    smooth = fs.tangent_stiffness(
        make(scale_material=RIGID), model=fs.NativeModel("shell", mesh=few_tets(fs.MeshOptions()))
    )
    a = [tangent.stiffness(direction) for tangent in [*found, smooth]]
    assert a == sorted(a)
    assert a[0] < 0.4 * a[3]


def test_hexagons_are_isotropic_at_rest(cell):
    """Edges have no preferred side: the mesh's six-fold symmetry is the element's too."""
    a = solve_tangent(cell(hexagon, EDGE_ANGLE)).stiffness(np.arange(0.0, 180.0, 7.0))
    assert np.ptp(a) < 1e-6 * a.mean()


@pytest.mark.parametrize("degrees", [0.0, 20.0])
def test_tangent_is_the_initial_slope_of_a_sweep(cell, degrees):
    problem = cell(square, EDGE_ANGLE)
    bent = problem.bent(Bend(1e-4, np.radians(degrees)))
    solution = solve_equilibrium(bent, problem.embedding.rest, SolverOptions())
    slope = bent.moment(solution.evaluation) / 1e-4
    assert slope == pytest.approx(solve_tangent(problem).stiffness(degrees), rel=1e-3)


SQUARE = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]])
SLANTED = np.array([[0.0, 0.0], [11.0, 0.0], [13.0, 8.0], [2.0, 8.0]])
#: Invariances hold on any mesh, so on a coarse one.
COARSEST = fs.MeshOptions(
    across=2, along=4.0, corner=1.0, scale_size=10.0, scale_layers=1, scale_order=1
)


def moments(pattern: fs.Pattern, direction: float = 25.0) -> np.ndarray:
    """Moments to both sides at 0.008 mm-1."""
    data = fs.sweep(
        pattern,
        [direction],
        [0.0, 0.008],
        workers=1,
        model=fs.NativeModel("shell", mesh=COARSEST, substrate=EDGE_ANGLE),
    )
    assert (data.status == 0).all()
    return data.moment.values[:, 0, 1]


def test_origin_cell_and_axes_do_not_matter():
    """A moved pattern, other lattice vectors, and pattern and direction turned together."""
    expected = moments(fs.Pattern.from_polygons([SLANTED], SLANTED[1], SLANTED[3]))
    moved = fs.Pattern.from_polygons([SLANTED + np.array([3.7, -2.2])], SLANTED[1], SLANTED[3])
    other = fs.Pattern.from_polygons([SLANTED], SLANTED[1], SLANTED[1] + SLANTED[3])
    c, s = np.cos(np.radians(33.0)), np.sin(np.radians(33.0))
    r = np.array([[c, -s], [s, c]])
    turned = fs.Pattern.from_polygons([SLANTED @ r.T], r @ SLANTED[1], r @ SLANTED[3])
    assert moments(moved) == pytest.approx(expected, rel=1e-8)
    assert moments(other) == pytest.approx(expected, rel=1e-8)
    assert moments(turned, 58.0) == pytest.approx(expected, rel=1e-8)


def test_supercell():
    """Two copies in one cell: edge angles are shared by the images of one cell, not by copies."""
    single = fs.Pattern.from_polygons([SQUARE], (10.0, 0.0), (0.0, 10.0))
    copies = [SQUARE, SQUARE + np.array([10.0, 0.0])]
    double = fs.Pattern.from_polygons(copies, (20.0, 0.0), (0.0, 10.0))
    assert moments(double) == pytest.approx(moments(single), rel=1e-8)


@pytest.mark.slow
def test_elements_agree_where_the_membrane_carries():
    """Squares along a side, in contact: stretched gaps, within 3 % on the default mesh."""
    curvatures = [0.0, 0.008, 0.011, 0.013, 0.016]
    found = [
        fs.sweep(
            square(),
            [0.0],
            curvatures,
            ["closing"],
            workers=1,
            model=fs.NativeModel("shell", substrate=options),
        )
        for options in (fs.SubstrateOptions("c1"), EDGE_ANGLE)
    ]
    smooth, angles = (data.moment.values[0, 0, 2:] for data in found)
    assert angles == pytest.approx(smooth, rel=0.03)

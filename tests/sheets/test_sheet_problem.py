"""Held and loaded sheets: derivatives through grips, conditions, warnings, refusals."""

from __future__ import annotations

import logging

import numpy as np
import pytest
from scipy.special import ellipe, ellipk

from flexscale.errors import BadInputError, ConfigError, UnknownNameError
from flexscale.mechanics.linear_law import isotropic_sheet, linear_sheet, orthotropic_matrix
from flexscale.mesh.sheet import SheetMesh, disc, rectangle, staggered_rectangle
from flexscale.sheets.bent_sheet import BendingRig, SheetOptions, bend_sheet
from flexscale.sheets.conditions import Conditions
from flexscale.sheets.grips import Grip, Sliding, Turning
from flexscale.sheets.load_path import follow_loads
from flexscale.sheets.sheet import build_sheet
from flexscale.sheets.sheet_problem import SheetProblem
from flexscale.sheets.sheet_rows import POSITION
from flexscale.sheets.surfaces import cylinder, polar_plane, sphere
from flexscale.solve.solver_options import SolverOptions
from flexscale.status import SolveStatus
from tests.derivatives import directional_difference, relative_error

LAW = linear_sheet(
    orthotropic_matrix(40.0, 25.0, 6.0, 5.0), orthotropic_matrix(30.0, 12.0, 3.0, 6.0)
)
AXIS = np.array([0.6, 0.0, 0.8])
MOTIONS = {
    "turning": Turning(AXIS),
    "sliding": Sliding(np.array([0.6, 0.0, 0.8]), np.array([-0.8, 0.0, 0.6]), 0.3),
    "sliding straight": Sliding(np.array([0.6, 0.0, 0.8]), np.array([-0.8, 0.0, 0.6]), 0.0),
}


def gripped(element: str, motion) -> tuple[SheetProblem, np.ndarray]:
    """A small sheet clamped at one end and gripped at the other, and a bent state of it."""
    mesh = staggered_rectangle(3.0, 2.0, (3, 2))
    left, right = mesh.points[:, 0] < 1e-9, mesh.points[:, 0] > 3.0 - 1e-9
    sheet = build_sheet(mesh, LAW, element=element, clamped=left | right)
    conditions = Conditions(sheet)
    conditions.clamp(left)
    rows = sheet.rows.rigid(right)
    position = (sheet.rows.kinds[rows] == POSITION).astype(float)
    grip = Grip(rows, position, sheet.rest[rows], np.array([3.0, 1.0, 0.0]), motion)
    conditions.grip(grip, load=np.linspace(0.1, 0.3, motion.n_unknowns))
    problem = SheetProblem(conditions, "superlu")
    z = problem.start(0.7)
    z[problem.active] += 0.05 * np.random.default_rng(4).normal(size=len(problem.active))
    return problem, z


@pytest.mark.parametrize("element", ["c1", "edge_angle"])
@pytest.mark.parametrize("name", list(MOTIONS))
def test_derivatives_through_grips_match_differences(element, name):
    """Gradient and Hessian in all active unknowns, those of the grip among them, to 1e-6."""
    problem, z = gripped(element, MOTIONS[name])
    direction = np.zeros_like(z)
    direction[problem.active] = np.random.default_rng(6).normal(size=len(problem.active))

    def energy(s: float) -> float:
        return problem.evaluate(z + s * direction).energy

    def gradient(s: float) -> np.ndarray:
        return problem.evaluate(z + s * direction).gradient

    along = direction[problem.active]
    assert relative_error(gradient(0.0) @ along, directional_difference(energy, 1e-4)) < 1e-6
    values = problem.hessian_values(problem.evaluate(z))
    n = len(problem.active)
    matrix = problem.system.factorization._matrix
    problem.system.factorize(values)
    assert matrix.shape == (n, n)
    assert relative_error(matrix @ along, directional_difference(gradient, 1e-4)) < 1e-6


def test_a_vertex_of_three_triangles():
    """Each of them meets the same vertex across two of its edges; the Hessian counts it twice."""
    points = np.array([[0.0, 0.0], [3.0, 0.0], [1.0, 2.5], [1.3, 0.9]])
    mesh = SheetMesh(points, np.array([[0, 1, 3], [1, 2, 3], [2, 0, 3]]))
    sheet = build_sheet(mesh, LAW, element="edge_angle")
    conditions = Conditions(sheet)
    conditions.hold(sheet.rows.positions(np.arange(4) == 0))
    problem = SheetProblem(conditions, "superlu")
    z, generator = problem.start(1.0), np.random.default_rng(2)
    z[problem.active] += 0.1 * generator.normal(size=len(problem.active))
    direction = np.zeros_like(z)
    direction[problem.active] = along = generator.normal(size=len(problem.active))
    problem.system.factorize(problem.hessian_values(problem.evaluate(z)))
    product = problem.system.factorization._matrix @ along
    expected = directional_difference(lambda s: problem.evaluate(z + s * direction).gradient, 1e-4)
    assert relative_error(product, expected) < 1e-6


@pytest.mark.parametrize("surface", [cylinder(0.3), cylinder(0.0), polar_plane, sphere(4.0)])
def test_gradients_of_surfaces(surface):
    point, direction = np.array([[0.7, 0.4]]), np.array([0.3, -0.5])
    expected = directional_difference(lambda s: surface(point + s * direction)[0][0], 1e-3)
    assert surface(point)[1][0] @ direction == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("element", ["c1", "edge_angle"])
def test_a_strip_bends_to_a_cylinder(element):
    """Without coupling of the two directions the cylinder is exact.

    Linear triangles measure the turn per rest length: E = D kappa^2/2 per area. C1 sheets measure
    the second form, (1 + 2 e) kappa per rest length if the strip stretches by e, so it shortens by
    e = -D kappa^2/A and E = D kappa^2/2 (1 - D kappa^2/A). M is the slope of E.
    """
    a, d, kappa = 40.0, 30.0, -0.03
    law = linear_sheet(orthotropic_matrix(a, 25.0, 0.0, 5.0), orthotropic_matrix(d, 12.0, 0.0, 6.0))
    options = SheetOptions(element, size=4.0)
    bent = bend_sheet(law, length=40.0, width=20.0, curvature=kappa, options=options)
    slack = d * kappa**2 / a if element == "c1" else 0.0
    accuracy = {"c1": 5e-5, "edge_angle": 2e-3}[element]
    assert bent.status == SolveStatus.converged
    assert bent.energy_density == pytest.approx(0.5 * d * kappa**2 * (1 - slack), rel=accuracy)
    assert bent.moment == pytest.approx(d * kappa * (1 - 2.0 * slack), rel=accuracy)
    if element == "c1":
        # The held ends do not stretch, and elements next to them make up for it: 12 %.
        assert bent.slide == pytest.approx(-40.0 * slack, rel=0.15)
    end = bent.positions[np.argmax(bent.mesh.points[:, 0])]
    expected = cylinder(kappa)(np.array([[40.0 + bent.slide, 0.0]]))[0][0]
    assert end[[0, 2]] == pytest.approx(expected[[0, 2]], abs=1e-9)


@pytest.mark.parametrize("element", ["c1", "edge_angle"])
def test_a_sheet_placed_on_a_cylinder_has_its_energy(element):
    """Edge angles are set to the surface's normals: no solve needed to see the curvature."""
    sheet = build_sheet(rectangle(40.0, 20.0, 2.0), LAW, element=element)
    energy = sheet.energy.energy_parts(sheet.place(cylinder(0.02)))[0]
    assert energy / sheet.area == pytest.approx(0.5 * 30.0 * 0.02**2, rel=2e-3)


def test_moment_is_the_slope_of_the_energy():
    """(1/area) dE/dcurvature by the strips' reactions against a difference of energies."""
    rig = BendingRig(LAW, length=40.0, width=20.0, options=SheetOptions(size=6.0, strip=5.0))
    slope = directional_difference(lambda s: rig.bend(0.02 + s).energy_density, 5e-4)
    assert rig.bend(0.02).moment == pytest.approx(slope, rel=1e-6)


def test_direction_turns_the_material():
    """Bent along its second axis, a sheet is as stiff as one whose axes are exchanged."""
    exchanged = linear_sheet(
        orthotropic_matrix(25.0, 40.0, 6.0, 5.0), orthotropic_matrix(12.0, 30.0, 3.0, 6.0)
    )
    sizes = {"length": 40.0, "width": 20.0, "curvature": 0.02}
    for element in ("c1", "edge_angle"):
        options = SheetOptions(element, size=6.0)
        turned = bend_sheet(LAW, direction=90.0, options=options, **sizes)
        expected = bend_sheet(exchanged, options=options, **sizes)
        assert turned.energy == pytest.approx(expected.energy, rel=1e-9)
        assert turned.slide == pytest.approx(expected.slide, rel=1e-6)


def test_material_direction_has_a_sense():
    """Twist-bend coupling tells 30 degree from -30: the law is read in axes turned by -direction,
    so bending at 30 degree sees D = T D0 T^T with the curvature along 30 degree."""
    angle = np.radians(30.0)
    bend = np.array([np.cos(angle) ** 2, np.sin(angle) ** 2, np.sin(2.0 * angle)])
    bending = np.array([[30.0, 3.0, 4.0], [3.0, 12.0, 1.0], [4.0, 1.0, 6.0]])
    law = linear_sheet(orthotropic_matrix(40.0, 25.0, 6.0, 5.0), bending)
    rig = BendingRig(law, length=40.0, width=20.0, direction=30.0, options=SheetOptions(size=6.0))
    placed = rig.sheet.place(cylinder(0.01))
    density = rig.sheet.energy.energy_parts(placed)[0] / rig.sheet.area
    assert density == pytest.approx(0.5 * 1e-4 * bend @ bending @ bend, rel=1e-4)


def test_a_sheet_beyond_the_laws_range_warns_once(caplog):
    """One warning with the largest curvature and where it is, and none within the range."""
    options = SheetOptions(size=6.0)
    rig = BendingRig(LAW, length=40.0, width=20.0, options=options, curvature_range=0.015)
    with caplog.at_level(logging.WARNING, logger="flexscale"):
        assert rig.bend(0.01).largest_curvature < 0.015
        assert not caplog.records
        found = [rig.bend(k) for k in (0.02, 0.022)]
    (record,) = caplog.records
    assert f"{found[0].largest_curvature:.4g} mm-1" in record.getMessage()
    x, y = found[0].largest_at
    assert f"({x:.1f}, {y:.1f}) mm" in record.getMessage()
    assert "0.015" in record.getMessage()


def test_an_isotropic_disc_bends_alike_in_all_directions():
    """Hub clamped, a point of the rim pushed down: the same force at every sixth of the turn to
    rounding, and to 1 % between."""
    mesh = disc(20.0, 6, hub=5.0)
    hub = np.linalg.norm(mesh.points, axis=1) < 5.0 + 1e-9
    sheet = build_sheet(mesh, isotropic_sheet(1000.0, 0.3, 0.4), clamped=hub)
    rim = mesh.n_vertices - 36
    forces = []
    for vertex in (rim, rim + 6, rim + 3):
        chosen = np.arange(mesh.n_vertices) == vertex
        rows = sheet.rows.positions(chosen)
        conditions = Conditions(sheet)
        conditions.clamp(hub)
        conditions.hold(rows, "z", sheet.rest - [0.0, 0.0, 1.0])
        problem = SheetProblem(conditions)
        (step,) = follow_loads(problem, [1.0])
        assert step.status == SolveStatus.converged
        forces.append(step.state.full_gradient[3 * rows[0] + 2])
    assert forces[0] < 0.0
    assert forces[1] == pytest.approx(forces[0], rel=1e-6)
    assert forces[2] == pytest.approx(forces[0], rel=0.01)


@pytest.mark.parametrize("element", ["c1", "edge_angle"])
def test_rigid_motion_of_what_holds_a_sheet_changes_nothing(element):
    """A clamped strip under load, turned with its clamp and its load: the same energy."""
    mesh = staggered_rectangle(3.0, 1.0, (4, 2))
    left, right = mesh.points[:, 0] < 1e-9, mesh.points[:, 0] > 3.0 - 1e-9
    turn = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
    energies = []
    for rotation in (np.eye(3), turn):
        sheet = build_sheet(mesh, LAW, element=element, clamped=left)
        turned = sheet.rest @ rotation.T
        turned[sheet.absent] = 0.0
        conditions = Conditions(sheet)
        conditions.clamp(left, values=turned)
        conditions.load_line(right, rotation @ [0.0, 0.1, 0.5])
        problem = SheetProblem(conditions)
        z = problem.start(0.0)
        z[: turned.size] = turned.ravel()
        problem.rest[: turned.size] = turned.ravel()
        (step,) = follow_loads(problem, [1.0], z=z)
        assert step.status == SolveStatus.converged
        energies.append(step.state.strain_energy)
    assert energies[0] > 0.05
    assert energies[1] == pytest.approx(energies[0], rel=1e-9)


@pytest.mark.parametrize("element", ["c1", "edge_angle"])
def test_two_hinges_brought_together_make_an_elastica(element):
    """A flat sheet is a saddle once it is short enough; it is left, and the force is the elastica's
    4 K(k)^2 D/L^2 at the distance 2 E(k)/K(k) - 1."""
    length, width, m = 10.0, 2.0, 0.1
    mesh = staggered_rectangle(length, width, (12, 2))
    x = mesh.points[:, 0]
    left, right = x < 1e-9, x > length - 1e-9
    sheet = build_sheet(mesh, isotropic_sheet(1.2e4, 0.0, 0.1), element=element)
    conditions = Conditions(sheet)
    distance = 2.0 * ellipe(m) / ellipk(m) - 1.0
    conditions.hinge(left, (0.0, 1.0))
    conditions.hinge(right, (0.0, 1.0), shift=(length * (distance - 1.0), 0.0, 0.0))
    (step,) = follow_loads(SheetProblem(conditions), [1.0], SolverOptions(max_iterations=200))
    assert step.status == SolveStatus.converged
    assert step.negative_eigenvalues == 0
    force = step.state.full_gradient[3 * sheet.rows.positions(right)].sum()
    expected = -4.0 * ellipk(m) ** 2 * (1.2e4 * 0.1**3 / 12.0) / length**2 * width
    assert force == pytest.approx(expected, rel=0.01)


def test_prescribed_angle():
    """A strip whose end turns by 1 rad and is else free is an arc: E = D w / (2 L), its moment
    D w / L is the reaction."""
    mesh = staggered_rectangle(10.0, 2.0, (12, 2))
    left, right = mesh.points[:, 0] < 1e-9, mesh.points[:, 0] > 10.0 - 1e-9
    sheet = build_sheet(mesh, isotropic_sheet(1.2e4, 0.0, 0.1), clamped=left | right)
    conditions = Conditions(sheet)
    conditions.clamp(left)
    rows = sheet.rows.rigid(right)
    position = (sheet.rows.kinds[rows] == POSITION).astype(float)
    motion = Turning(np.array([0.0, -1.0, 0.0]))
    grip = Grip(rows, position, sheet.rest[rows], np.array([10.0, 1.0, 0.0]), motion)
    held = [False, False, False, True]
    places = conditions.grip(grip, held=held, values=[0.0, 0.0, 0.0, 1.0])
    steps = follow_loads(SheetProblem(conditions), [0.5, 1.0])
    assert steps[-1].status == SolveStatus.converged
    assert steps[-1].state.strain_energy == pytest.approx(0.5 * 2.0 / 10.0, rel=1e-3)
    assert steps[-1].state.full_gradient[places[3]] == pytest.approx(2.0 / 10.0, rel=1e-3)


def test_load_steps_are_cut_where_newton_fails():
    """With few iterations allowed the path still arrives, in more steps; with none it says so."""
    mesh = staggered_rectangle(10.0, 1.0, (8, 2))
    left, right = mesh.points[:, 0] < 1e-9, mesh.points[:, 0] > 10.0 - 1e-9
    results = []
    for most in (200, 25, 1):
        sheet = build_sheet(
            mesh, isotropic_sheet(1.2e6, 0.0, 0.1), element="edge_angle", clamped=left
        )
        conditions = Conditions(sheet)
        conditions.clamp(left)
        conditions.load_line(right, (0.0, 0.0, 1.0))
        solver = SolverOptions(max_iterations=most)
        results.append(follow_loads(SheetProblem(conditions), [1.0], solver)[-1])
    assert [r.status == SolveStatus.converged for r in results] == [True, True, False]
    assert results[1].state.energy == pytest.approx(results[0].state.energy, rel=1e-8)
    assert results[2].factor < 1.0


def test_bad_input_is_refused():
    mesh = rectangle(10.0, 5.0, 2.0)
    with pytest.raises(UnknownNameError, match="edge_angle"):
        build_sheet(mesh, LAW, element="edge_angel")
    with pytest.raises(ConfigError, match="flat at rest"):
        build_sheet(mesh, LAW, element="edge_angle", surface=sphere(10.0))
    sheet = build_sheet(mesh, LAW)
    conditions = Conditions(sheet)
    inside = (mesh.points[:, 0] > 0.1) & (mesh.points[:, 0] < 9.9)
    with pytest.raises(BadInputError, match="boundary edge"):
        conditions.load_line(inside & (abs(mesh.points[:, 1] - 2.5) < 0.1), (0.0, 0.0, 1.0))
    with pytest.raises(BadInputError, match="no derivative along"):
        conditions.hinge(mesh.points[:, 0] < 1e-9, (1.0, 1.0))
    problem, _ = gripped("c1", MOTIONS["sliding"])
    problem.conditions.load_line(problem.sheet.mesh.points[:, 0] > 3.0 - 1e-9, (0.0, 0.0, 1.0))
    with pytest.raises(BadInputError, match="load the grip instead"):
        SheetProblem(problem.conditions)
    linear = Conditions(build_sheet(mesh, LAW, element="edge_angle"))
    with pytest.raises(BadInputError, match="plane of symmetry"):
        linear.mirror(mesh.points[:, 0] < 1e-9, (0.0, 1.0), (1.0, 0.0), "x")
    small = mesh.mapped(lambda points: 0.1 * points)
    curved = Conditions(build_sheet(small, LAW, surface=sphere(10.0)))
    with pytest.raises(BadInputError, match="lengths along its line"):
        curved.load_line(mesh.points[:, 0] < 1e-9, (0.0, 0.0, 1.0))
    with pytest.raises(BadInputError, match="drawn as it is"):
        curved.load_area((0.0, 0.0, 1.0))
    conditions.clamp(np.ones(mesh.n_vertices, dtype=bool))
    with pytest.raises(BadInputError, match="All of the sheet is held"):
        SheetProblem(conditions)
    with pytest.raises(BadInputError, match=r"its own end: stay below 0\.06283"):
        bend_sheet(LAW, length=100.0, width=50.0, curvature=0.07)
    with pytest.raises(BadInputError, match="end strips of 50 mm"):
        bend_sheet(LAW, length=100.0, width=50.0, curvature=0.01, options=SheetOptions(strip=50.0))

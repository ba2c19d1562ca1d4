"""Contact: onset and post-contact moment against closed forms, no passing through, both sides.

The closed forms assume rigid scales; PETG's modulus is raised 1e4 times for them, and the scale
mesh is coarse.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import flexscale as fs
from flexscale.embedding.bends import Bend
from flexscale.errors import PatternError
from flexscale.homogenize.bend_line import Line
from flexscale.homogenize.cell_model import CellModel
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.line import follow_line
from flexscale.mechanics.layered_law import layered_energy
from flexscale.mesh.torus import build_mesh
from flexscale.patterns import Pattern
from flexscale.solve.solver_options import SolverOptions
from tests.derivatives import directional_difference, multiply_upper, relative_error
from tests.physics.cells import RIGID, hexagon, square
from tests.physics.intersections import surfaces_intersect

COARSE = fs.MeshOptions(along=1.5, corner=0.4, scale_size=4.0, scale_layers=1)
GAP, HEIGHT = 0.4, 4.0


def solve_line(pattern, side, degrees, curvatures, activation=0.005, stiffness=1.0):
    """Problem and samples of one line; all of them must converge."""
    contact = fs.ContactOptions(activation=activation, stiffness=stiffness)
    problem = CellProblem.from_pattern(
        pattern, fs.NativeModel("shell", contact=contact, mesh=COARSE)
    )
    line = Line(side, degrees, tuple(curvatures))
    samples = list(follow_line(problem, line, SolverOptions()))
    assert [sample["status"] for sample in samples] == [0] * len(samples)
    return problem, samples


def kink(samples) -> tuple[float, float]:
    """Curvature at which the two branches of the moment meet, and the slope of the second."""
    kappa = np.array([s["curvature"] for s in samples])
    moment = np.array([s["moment"] for s in samples])
    touching = np.array([s["contact_pairs"] > 0 for s in samples])
    stiff, offset = np.polyfit(kappa[touching], moment[touching], 1)
    before = np.flatnonzero(~touching)[-1]
    soft = moment[before] / kappa[before]
    return offset / (soft - stiff), stiff


def predicted_onset(
    pattern: Pattern,
    degrees: float,
    side: str,
    strain: np.ndarray | None = None,
    turn: float = 0.0,
) -> float:
    """kappa_0 = min_j (g + nu_j . S X_j + alpha t_j . X_j) / (h (X_j . n)(n . nu_j)), one tile.

    X_j is the lattice vector to neighbor j, nu_j the normal of the wall between and t_j the wall's
    direction, a quarter turn ahead of it; scales are rigid and share one rotation per lattice
    vector. Opening meets where the product is most negative. S (xx, yy, xy) is the strain of the
    lattice, which widens the gaps; alpha [rad] a turn of every scale about its own normal, which
    brings walls of staggered neighbors together. 0 if not given.
    """
    xx, yy, xy = np.zeros(3) if strain is None else strain
    lattice_strain = np.array([[xx, xy], [xy, yy]])
    (tile,) = pattern.tiles
    n = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
    sign = 1.0 if side == "closing" else -1.0
    onsets = []
    for start, end in zip(tile, np.roll(tile, -1, axis=0), strict=True):
        along = (end - start) / np.linalg.norm(end - start)
        normal = np.array([along[1], -along[0]])
        middle = 0.5 * (start + end)
        steps = [m * pattern.lattice[0] + k * pattern.lattice[1]
                 for m in (-1, 0, 1) for k in (-1, 0, 1) if m or k]  # fmt: skip
        # The neighbor across this wall has the wall's middle on its own outline.
        (step,) = [s for s in steps if on_outline(tile + s, middle)]
        product = sign * (step @ n) * (n @ normal)
        if product > 1e-9:
            gap = pattern.gap + normal @ lattice_strain @ step + turn * along @ step
            onsets.append(gap / (pattern.scale_height * product))
    return float(min(onsets))


def on_outline(polygon: np.ndarray, point: np.ndarray) -> bool:
    for start, end in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        arm = end - start
        share = np.clip((point - start) @ arm / (arm @ arm), 0.0, 1.0)
        if np.linalg.norm(start + share * arm - point) < 1e-9:
            return True
    return False


def test_predicted_onset_of_squares():
    assert predicted_onset(square(), 0.0, "closing") == pytest.approx(GAP / (HEIGHT * 10.0))
    assert predicted_onset(square(), 45.0, "closing") == pytest.approx(GAP / (HEIGHT * 5.0))


ONSETS = [
    pytest.param(square, 0.0, marks=pytest.mark.slow),
    (hexagon, 15.0),
    pytest.param(hexagon, 0.0, marks=pytest.mark.slow),
    pytest.param(hexagon, 30.0, marks=pytest.mark.slow),
]


def moved_onset(pattern: Pattern, degrees: float, side: str, shares: list[float]) -> float:
    """The predicted onset with the lattice's own strain, and the scales' own turn, there.

    Strips of sheet as thick as wide lengthen when they are bent and twisted, and turn the scales
    between them. Both are taken from the last two of the samples at these shares of the onset
    without them, all before contact, and continued linearly in the square of the curvature.
    """
    onset = predicted_onset(pattern, degrees, side)
    problem, samples = solve_line(pattern, side, degrees, onset * np.array(shares))
    assert samples[-1]["contact_pairs"] == 0
    squares, moved = [], []
    for sample in samples[-2:]:
        first = problem.embedding.world_map.split(sample["state"])[0][3:6]  # the scale's g_1
        turn = np.arctan2(first[1], first[0])
        squares.append(sample["curvature"] ** 2)
        moved.append([*(sample["stretch"] - [1.0, 1.0, 0.0]), turn])
    slope = (np.array(moved[1]) - moved[0]) / (squares[1] - squares[0])
    for _ in range(30):
        *strain, turn = moved[1] + slope * (onset**2 - squares[1])
        onset = predicted_onset(pattern, degrees, side, strain, turn)
    return onset


@pytest.mark.parametrize(("pattern", "degrees"), ONSETS)
def test_onset_of_closing(pattern, degrees):
    """Within 2 %: scales meet where their rigid rotations close the gap at the top."""
    rigid = pattern(scale_material=RIGID)
    expected = moved_onset(rigid, degrees, "closing", [0.2, 0.4, 0.7, 0.9])
    curvatures = expected * np.array([0.5, 0.9, 1.02, 1.04, 1.06])
    _, samples = solve_line(rigid, "closing", degrees, curvatures)
    assert kink(samples)[0] == pytest.approx(expected, rel=0.02)


def bricks(length: float, width: float, **changes) -> Pattern:
    tile = np.array([[0.0, 0.0], [length, 0.0], [length, width], [0.0, width]])
    return Pattern.from_polygons([tile], (length, 0.0), (0.5 * length, width), **changes)


@pytest.mark.slow
def test_onset_of_opening():
    """Convex scales meet when opening too: long bricks, bent obliquely. Within 2 %.

    Bricks of 12 x 3 mm, 10 mm high: the lattice lengthens by 3 % across them and they turn by 0.3
    degrees, which moves the onset by +23 and -8 %.
    """
    rigid = bricks(12.0, 3.0, scale_height=10.0, scale_material=RIGID)
    oblique = 0.5 * np.degrees(np.arctan(2.0))  # 31.7 degrees: where the formula's product is least
    shares = [0.1, 0.2, 0.35, 0.5, 0.7, 0.9, 1.0]
    expected = moved_onset(rigid, oblique, "opening", shares)
    plain = predicted_onset(rigid, oblique, "opening")
    _, samples = solve_line(rigid, "opening", oblique, plain * np.array([*shares, 1.1, 1.14]))
    gaps, curvatures = ([s[name] for s in samples[-2:]] for name in ("min_gap", "curvature"))
    assert samples[-1]["contact_pairs"] == 0
    rate = (gaps[0] - gaps[1]) / (curvatures[1] - curvatures[0])
    onset = curvatures[1] + gaps[1] / rate
    assert onset == pytest.approx(expected, rel=0.02)


ARROW = np.array([[-5, 10], [0, 0], [5, 10], [5, 20], [0, 10], [-5, 20]], dtype=float)


@pytest.mark.slow
@pytest.mark.parametrize("side", ["closing", "opening"])
def test_arrows_lock_to_both_sides(side):
    """Concave scales, bent to 0.03 /mm where they interlock: converged, free of intersections."""
    pattern = Pattern.from_polygons([ARROW], (10.0, 0.0), (0.0, 10.0), gap=0.3)
    problem = CellProblem.from_pattern(pattern)
    line = Line(side, 31.7, (0.006, 0.012, 0.018, 0.024, 0.027, 0.03))
    samples = list(follow_line(problem, line, SolverOptions()))
    surface = problem.contact.surface
    assert [sample["status"] for sample in samples] == [0] * len(samples)
    assert samples[-1]["contact_pairs"] > 0
    for sample in samples:
        y = problem.embedding.world_map.place(sample["state"], line.bend(sample["curvature"])).y
        points = problem.contact.positions(y)
        assert not surfaces_intersect(points, surface.triangles, surface.bodies)


def test_barrier_is_stiffened_where_scales_press_hard():
    """A barrier far too soft lets scales nearly meet; the next samples are kept further apart."""
    curvatures = (0.006, 0.0095, 0.0115, 0.0125, 0.0135)
    _, samples = solve_line(hexagon(), "closing", 0.0, curvatures, stiffness=1e-3)
    stiffness = np.array([sample["barrier_stiffness"] for sample in samples])
    share = np.array([sample["min_gap"] for sample in samples]) / (0.005 * GAP)
    assert share[2] < 0.1  # it did press hard
    assert (np.diff(stiffness)[share[:-1] < 0.1] > 0.0).all()
    assert share[-1] > share[2]


def test_scales_that_touch_at_rest_are_refused():
    mesh = build_mesh(hexagon(), COARSE)
    model = CellModel.of_pattern(hexagon())
    closer = mesh.scale_positions.copy()
    closer[:, :2] *= 1.0 + 0.3995 / 10.0  # scales grow into the gap on all sides
    with pytest.raises(PatternError, match=r"before (the sheet|it) is bent"):
        CellProblem(replace(mesh, scale_positions=closer), model)


def lever_moment(kappa: float, distance: float, period: float) -> float:
    """Post-contact moment of rigid squares along a side, per width; all strips are as long.

    Flat bases of length L = P - g hang on strips of sheet bent to arcs of length s, which turn by
    theta. Walls that stand on their ends meet at the top: their feet are 2 h sin(theta/2) + d
    apart. On the cylinder of curvature kappa the bases' mean offset is zero, so their middles are
    1/kappa - kappa L^2/24 away from the axis, and base and strip fill the angle theta of a period.
    The moment is what the strip's energy per area of the cell changes by.
    """
    base = period - GAP

    def energy(step: float) -> float:
        k = kappa + step
        middle = 1.0 / k - k * base**2 / 24.0
        half_angle = np.arctan(0.5 * base / middle)
        end = middle / np.cos(half_angle)
        theta = k * period
        for _ in range(60):
            chord = 2.0 * HEIGHT * np.sin(0.5 * theta) + distance
            theta = 2.0 * half_angle + 2.0 * np.arcsin(0.5 * chord / end)
        stretch = 0.5 * theta / np.sin(0.5 * theta) * chord / GAP
        e = np.array([stretch**2 - 1.0, 0.0, 0.0])
        b = np.array([stretch * theta / GAP, 0.0, 0.0])
        parts = layered_energy(e, b, fs.TPU.shear_modulus, fs.TPU.lame_lambda, 0.4)
        return GAP / period * sum(parts)

    return float(directional_difference(energy, 1e-5))


@pytest.mark.slow
@pytest.mark.parametrize("period", [10.0, 20.0])
def test_moment_after_contact_meets_the_lever(period):
    """From 1.05 to 2 kappa_0: between all of the width as a strip, and that beside scales alone.

    Where strips cross, a share g/P of the width, the sheet is held by those that are not stretched.
    """
    tile = period * np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    pattern = Pattern.from_polygons([tile], (period, 0.0), (0.0, period), scale_material=RIGID)
    curvatures = GAP / HEIGHT / period * np.array([0.5, 0.9, 1.05, 1.1, 1.3, 1.6, 2.0])
    _, samples = solve_line(pattern, "closing", 0.0, curvatures)
    for sample in samples[2:]:
        whole = lever_moment(sample["curvature"], sample["min_gap"], period)
        assert 1.0 - GAP / period < sample["moment"] / whole < 1.0


@pytest.mark.slow
def test_onset_and_slope_do_not_depend_on_the_barrier():
    """d_hat halved, or the stiffness ten times: onset and slope move by less than 1 %."""
    curvatures = [0.005, 0.009, 0.0108, 0.011, 0.0112]
    found = []
    for activation, stiffness in [(0.005, 1.0), (0.0025, 1.0), (0.005, 10.0)]:
        rigid = square(scale_material=RIGID)
        _, samples = solve_line(rigid, "closing", 0.0, curvatures, activation, stiffness)
        found.append(kink(samples))
    for onset, slope in found[1:]:
        assert onset == pytest.approx(found[0][0], rel=0.01)
        assert slope == pytest.approx(found[0][1], rel=0.01)


@pytest.mark.slow
def test_moment_integrates_to_the_energy_across_the_onset():
    """Within 0.5 %: contact is an energy, and the moment its exact derivative."""
    fine = np.concatenate([[0.004, 0.008], np.linspace(0.0095, 0.0115, 25)])
    _, samples = solve_line(hexagon(), "closing", 0.0, fine, 0.01)
    moment = np.array([s["moment"] for s in samples])
    energy = np.array([s["energy_density"] for s in samples])
    gained = np.trapezoid(moment[2:], fine[2:])
    assert gained == pytest.approx(energy[-1] - energy[2], rel=0.005)


@pytest.mark.parametrize(
    ("pattern", "degrees"),
    [(hexagon, 15.0), pytest.param(square, 30.0, marks=pytest.mark.slow)],
)
def test_no_scale_passes_through_another(pattern, degrees):
    """Accepted states are free of intersections, by exact geometry that knows no barrier."""
    curvatures = [0.005, 0.01, 0.0125, 0.015, 0.02]
    problem, samples = solve_line(pattern(), "closing", degrees, curvatures, 0.01)
    surface = problem.contact.surface
    for sample in samples:
        bend = Bend(sample["curvature"], float(np.radians(degrees)))
        y = problem.embedding.world_map.place(sample["state"], bend).y
        points = problem.contact.positions(y)
        assert not surfaces_intersect(points, surface.triangles, surface.bodies)
        assert sample["min_gap"] > 0.0
    # The test can see one: with a period 5 % shorter, scales of the last state overlap.
    z = samples[-1]["state"].copy()
    z[-3:-1] -= 0.05
    y = problem.embedding.world_map.place(z, bend).y
    assert surfaces_intersect(problem.contact.positions(y), surface.triangles, surface.bodies)


def test_derivatives_of_the_touching_cell():
    """Gradient and unprojected Hessian with active contact pairs, and the rate by kappa."""
    problem, samples = solve_line(hexagon(), "closing", 10.0, [0.005, 0.01, 0.0125], 0.01)
    bend = Bend(0.0125, float(np.radians(10.0)))
    cell, z = problem.bent(bend), samples[-1]["state"]
    state = cell.evaluate(z)
    assert samples[-1]["contact_pairs"] > 0
    direction = np.zeros(len(z))
    direction[problem.active] = np.random.default_rng(0).normal(size=len(problem.active))
    # Smaller than the distance kept, a few microns, by far.
    curve = directional_difference(lambda h: cell.evaluate(z + h * direction).gradient, 2e-6)
    upper = cell.hessian_values(state)
    product = multiply_upper(problem.pull_back, upper, direction[problem.active])
    assert relative_error(product, curve) < 1e-6

    def slope(h):
        return problem.bent(Bend(bend.curvature + h, bend.direction)).evaluate(z).gradient

    assert relative_error(cell.gradient_rate(state), directional_difference(slope, 1e-7)) < 1e-6


def test_each_pair_of_scales_is_met_once():
    """Pressed together until walls touch, a 2 x 1 supercell has the same contact per area."""
    tile = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]])
    densities = []
    for n in (1, 2):
        tiles = [tile + np.array([10.0 * k, 0.0]) for k in range(n)]
        pattern = Pattern.from_polygons(tiles, (10.0 * n, 0.0), (0.0, 10.0))
        problem = CellProblem.from_pattern(pattern, fs.NativeModel("shell", mesh=COARSE))
        z = problem.embedding.rest.copy()
        # Scales keep their places and size; only the period along x shrinks, by 0.399 mm a scale.
        for start, body in zip(problem.embedding.world_map.starts, problem.bodies, strict=False):
            z[start] -= 0.399 if body.anchor[0] > 10.0 else 0.0
        z[-3] = -0.399 / 10.0
        y = problem.embedding.world_map.place(z, Bend(0.0, 0.0)).y
        densities.append(problem.contact.energy_parts(y)[0] / problem.area)
    assert densities[0] > 1e-3
    assert densities[1] == pytest.approx(densities[0], rel=1e-6)

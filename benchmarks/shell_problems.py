"""Published problems of thin shells on macro sheets, by mesh; tests and benchmarks use them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexscale.mechanics.linear_law import isotropic_sheet, linear_sheet, orthotropic_matrix
from flexscale.mechanics.sheet_law import SheetLaw
from flexscale.mesh.sheet import annulus, crossed_rectangle, staggered_rectangle
from flexscale.sheets.conditions import Conditions
from flexscale.sheets.grips import Grip, Turning
from flexscale.sheets.load_path import LoadStep, follow_loads
from flexscale.sheets.sheet import Sheet, build_sheet
from flexscale.sheets.sheet_problem import SheetProblem
from flexscale.sheets.sheet_rows import POSITION
from flexscale.sheets.surfaces import polar_plane, sphere
from flexscale.solve.solver_options import SolverOptions

CLOSE = 1e-9
OPTIONS = SolverOptions(max_iterations=400)


@dataclass(frozen=True)
class Outcome:
    """What a problem gives on one mesh: quantities by name, and what it cost."""

    values: dict[str, float]
    steps: list[LoadStep]
    n_triangles: int
    n_unknowns: int

    @property
    def iterations(self) -> int:
        return sum(step.iterations for step in self.steps)


def _solve(conditions: Conditions, factors: Sequence[float]) -> tuple[SheetProblem, list[LoadStep]]:
    problem = SheetProblem(conditions)
    return problem, follow_loads(problem, factors, OPTIONS)


def _outcome(values: dict[str, float], problem: SheetProblem, steps: list[LoadStep]) -> Outcome:
    triangles = len(problem.sheet.mesh.triangles)
    return Outcome(values, steps, triangles, len(problem.active))


def _at(sheet: Sheet, vertices: np.ndarray, state) -> np.ndarray:
    """(n, 3) positions of chosen vertices."""
    return state.y[sheet.rows.positions(vertices)]


def _beam(element: str, length: float, n: int):
    """A strip of width 1 in n cells, or as many linear triangles as are about as fine."""
    if element == "c1":
        return crossed_rectangle((0.0, length), (0.0, 1.0), (n, 1))
    return staggered_rectangle(length, 1.0, (2 * n, max(2, n // 4)))


def cantilever(element: str, n: int, factors: Sequence[float] = (0.3, 1.0)) -> Outcome:
    """Cantilever under end shear (Sze, Liu and Lo 2004, 3.1): shortening U and deflection W."""
    mesh = _beam(element, 10.0, n)
    x = mesh.points[:, 0]
    left, right = x < CLOSE, x > 10.0 - CLOSE
    sheet = build_sheet(mesh, isotropic_sheet(1.2e6, 0.0, 0.1), element=element, clamped=left)
    conditions = Conditions(sheet)
    conditions.clamp(left)
    conditions.load_line(right, (0.0, 0.0, 4.0))
    problem, steps = _solve(conditions, factors)
    tip = _at(sheet, right, steps[-1].state).mean(axis=0)
    return _outcome({"U": 10.0 - tip[0], "W": tip[2]}, problem, steps)


def roll_up(element: str, n: int, factors: Sequence[float] = (0.25, 0.5, 0.75, 1.0)) -> Outcome:
    """Cantilever rolled up by an end moment (3.2): distance of the ends, turn over 2 pi."""
    mesh = _beam(element, 12.0, n)
    x = mesh.points[:, 0]
    left, right = x < CLOSE, x > 12.0 - CLOSE
    law = isotropic_sheet(1.2e6, 0.0, 0.1)
    sheet = build_sheet(mesh, law, element=element, clamped=left | right)
    conditions = Conditions(sheet)
    conditions.clamp(left)
    rows = sheet.rows.rigid(right)
    position = (sheet.rows.kinds[rows] == POSITION).astype(float)
    origin, axis = np.array([12.0, 0.5, 0.0]), np.array([0.0, -1.0, 0.0])
    grip = Grip(rows, position, sheet.rest[rows], origin, Turning(axis))
    places = conditions.grip(grip, load=[0.0, 0.0, 0.0, 50.0 * np.pi / 3.0])
    problem, steps = _solve(conditions, factors)
    state = steps[-1].state
    tip = _at(sheet, right, state).mean(axis=0) - [0.0, 0.5, 0.0]
    turn = state.z[places[3]] / (2.0 * np.pi)
    return _outcome({"gap": float(np.linalg.norm(tip)), "turn": float(turn)}, problem, steps)


def slit_annulus(
    element: str, cells: tuple[int, int], factors: Sequence[float] = (1.0,)
) -> Outcome:
    """Slit annular plate under a lifting line force (3.3): lift at the inner and outer corner.

    The C1 sheet has polar parameters, so its rim is round.
    """
    law = isotropic_sheet(21.0e6, 0.0, 0.03)
    if element == "c1":
        mesh = crossed_rectangle((6.0, 10.0), (0.0, 2.0 * np.pi), cells)
        angle, radius = mesh.points[:, 1], mesh.points[:, 0]
    else:
        mesh = annulus(6.0, 10.0, cells, slit=True)
        grid = (cells[0] + 1) * (cells[1] + 1)
        angle = np.full(mesh.n_vertices, 1.0)
        angle[:grid] = np.tile(np.linspace(0.0, 2.0 * np.pi, cells[1] + 1), cells[0] + 1)
        radius = np.linalg.norm(mesh.points, axis=1)
    held, free = angle < CLOSE, angle > 2.0 * np.pi - CLOSE
    surface = {"surface": polar_plane} if element == "c1" else {}
    sheet = build_sheet(mesh, law, element=element, clamped=held, **surface)
    conditions = Conditions(sheet)
    conditions.clamp(held)
    conditions.load_line(free, (0.0, 0.0, 0.8))
    problem, steps = _solve(conditions, factors)
    lift = _at(sheet, free, steps[-1].state)[:, 2]
    order = np.argsort(radius[free])
    values = {"inner": float(lift[order[0]]), "outer": float(lift[order[-1]])}
    return _outcome(values, problem, steps)


def hemisphere(n: int, force: float = 1.0) -> Outcome:
    """Pinched hemisphere with an 18 degree hole (MacNeal and Harder 1985), a quarter of it:
    displacements of the loads over `force`, which is that on the quarter; F = 2 on the whole."""
    mesh = crossed_rectangle((0.0, np.pi / 2.0), (0.0, np.radians(72.0)), (n, n))
    longitude, latitude = mesh.points.T
    start, end = longitude < CLOSE, longitude > np.pi / 2.0 - CLOSE
    sheet = build_sheet(mesh, isotropic_sheet(6.825e7, 0.3, 0.04), surface=sphere(10.0))
    conditions = Conditions(sheet)
    conditions.mirror(start, along=(0.0, 1.0), across=(1.0, 0.0), axis="y")
    conditions.mirror(end, along=(0.0, 1.0), across=(1.0, 0.0), axis="x")
    equator = latitude < CLOSE
    outward, inward = start & equator, end & equator
    conditions.hold(sheet.rows.positions(outward), "z")
    conditions.load_point(int(np.flatnonzero(outward)[0]), (force, 0.0, 0.0))
    conditions.load_point(int(np.flatnonzero(inward)[0]), (0.0, -force, 0.0))
    problem, steps = _solve(conditions, (1.0,))
    state = steps[-1].state
    values = {
        "outward": (_at(sheet, outward, state)[0, 0] - 10.0) / force,
        "inward": (10.0 - _at(sheet, inward, state)[0, 1]) / force,
    }
    return _outcome(values, problem, steps)


#: Sides [mm] and stiffnesses of the orthotropic plate.
PLATE = (10.0, 8.0)
PLATE_LAW: SheetLaw = linear_sheet(
    orthotropic_matrix(300.0, 100.0, 40.0, 50.0), orthotropic_matrix(3.0, 1.0, 0.4, 0.5)
)


def orthotropic_plate(element: str, n: int, height: float = 1e-6, turn: float = 0.0) -> Outcome:
    """Simply supported plate under uniform load: deflection of its middle over Navier's series
    w = 16 q/pi^6 sum sin(m pi/2) sin(k pi/2) / (m k (D11 (m/a)^4 + 2 H (m k/ab)^2 + D22 (k/b)^4)),
    H = D12 + 2 D66, at a load for which that is `height` [mm]. The plate is drawn turned by `turn`
    [rad], and its material with it."""
    a, b = PLATE
    d = PLATE_LAW.parameters[9:].reshape(3, 3)
    m, k = np.arange(1, 400, 2)[:, None], np.arange(1, 400, 2)[None]
    stiffness = d[0, 0] * (m / a) ** 4 + d[1, 1] * (k / b) ** 4
    stiffness = stiffness + 2.0 * (d[0, 1] + 2.0 * d[2, 2]) * (m * k / (a * b)) ** 2
    signs = np.sin(0.5 * np.pi * m) * np.sin(0.5 * np.pi * k)
    navier = 16.0 / np.pi**6 * np.sum(signs / (m * k * stiffness))
    if element == "c1":
        mesh = crossed_rectangle((0.0, a), (0.0, b), (n, n))
    else:
        mesh = staggered_rectangle(a, b, (2 * n, 2 * n))
    x, y = mesh.points.T
    axes = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    drawn = mesh.mapped(lambda points: points @ axes)
    sheet = build_sheet(drawn, PLATE_LAW, element=element, material_direction=turn)
    conditions = Conditions(sheet)
    sides = (x < CLOSE, axes[1]), (x > a - CLOSE, axes[1]), (y < CLOSE, axes[0])
    for side, direction in (*sides, (y > b - CLOSE, axes[0])):
        conditions.hinge(side, (direction[0], direction[1]), "z")
    conditions.hold(sheet.rows.positions((x < CLOSE) & (y < CLOSE)), "xy")
    conditions.hold(sheet.rows.positions((x > a - CLOSE) & (y < CLOSE)), "y")
    conditions.load_area((0.0, 0.0, height / navier))
    problem, steps = _solve(conditions, (1.0,))
    middle = np.hypot(x - 0.5 * a, y - 0.5 * b) < 1e-6
    deflection = _at(sheet, middle, steps[-1].state)[0, 2]
    return _outcome({"deflection": float(deflection / height)}, problem, steps)

"""The stage: a strip between two hinges that come closer (Fig. 11).

Flat strips under compression buckle to either side. Every test starts from an arc that is as short
as the hinges are apart and bent to the side that is asked for, so no imperfection is needed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from flexscale import checks
from flexscale.arrays import FloatArray, IntArray
from flexscale.checks import ANGLE, checked, length, series
from flexscale.mechanics.extrapolation import warn_beyond
from flexscale.mechanics.load_series import SHORTENINGS, require_shortenings
from flexscale.mechanics.sheet_law import SheetLaw
from flexscale.mesh.sheet import SheetMesh, rectangle
from flexscale.sheets.bent_sheet import TOLERANCE
from flexscale.sheets.conditions import Conditions
from flexscale.sheets.load_path import LoadStep, follow_loads
from flexscale.sheets.rigs import RigOptions
from flexscale.sheets.sheet import build_sheet
from flexscale.sheets.sheet_model import SheetModel
from flexscale.sheets.sheet_problem import SheetProblem
from flexscale.sheets.surfaces import Surface, hinged_arc
from flexscale.short_repr import ShortRepr
from flexscale.sides import ONE_SIDE, side_sign
from flexscale.solve.newton import solve_equilibrium
from flexscale.solve.solver_options import SolverOptions
from flexscale.status import SolveStatus
from flexscale.units import require_finite, require_positive

_CLOSE = 1e-9  # share of the length


@dataclass(frozen=True, eq=False, repr=False)
class StageTest(ShortRepr):
    """Forces on a strip between hinges; numbers are nan where no equilibrium was found.

    Attributes
    ----------
    length, width : mm, at rest.
    direction : degree, of the length in the pattern's coordinates.
    side : "closing" or "opening".
    mesh : triangles at rest.
    shortenings : (n,) mm, by which the hinges have come closer.
    force : (n,) N, that presses on a hinge.
    energy : (n,) N mm.
    deflection : (n,) mm, of the middle away from the line between the hinges, to the outer side of
        the arc; negative where the strip has snapped through to the other side.
    largest_curvature : (n,) mm-1, largest |principal curvature| in the strip.
    status : (n,) `SolveStatus`.
    iterations : (n,) of Newton's method.
    negative_eigenvalues : (n,) of the Hessian; a state that has some is unstable.
    positions : (n_vertices, 3) mm, at the last shortening that converged; one hinge is x = z = 0.
    """

    length: float
    width: float
    direction: float
    side: str
    mesh: SheetMesh
    shortenings: FloatArray
    force: FloatArray
    energy: FloatArray
    deflection: FloatArray
    largest_curvature: FloatArray
    status: IntArray
    iterations: IntArray
    negative_eigenvalues: IntArray
    positions: FloatArray


class StageRig:
    """A strip between two hinges.

    Parameters
    ----------
    law : energy per rest area.
    length, width : mm; the hinges are at both ends of the length.
    direction : degree, of the strip's length in the law's axes.
    options : discretization.
    curvature_range : mm-1, up to which the law is founded on data; beyond it, one warning a test.
    solver : how equilibria are sought; its tolerance is that of bent sheets if it is left out.
    """

    def __init__(
        self,
        law: SheetLaw,
        *,
        length: float = 100.0,
        width: float = 50.0,
        direction: float = 0.0,
        options: RigOptions | None = None,
        curvature_range: float = np.inf,
        solver: SolverOptions | None = None,
    ) -> None:
        self.options = options or RigOptions()
        self.length = require_positive(length, "strip length", "mm")
        self.width = require_positive(width, "strip width", "mm")
        self.direction = require_finite(direction, "direction", "degree")
        self.curvature_range = curvature_range
        self.solver = solver or SolverOptions(tolerance=TOLERANCE)
        mesh = rectangle(self.length, self.width, self.options.size)
        self.sheet = build_sheet(
            mesh, law, element=self.options.element,
            material_direction=-np.radians(self.direction),
        )  # fmt: skip
        x, y = mesh.points.T
        close = _CLOSE * self.length
        self.ends = (x <= close, x >= self.length - close)
        self._corner = self.ends[0] & (y <= close)
        middle = (x - 0.5 * self.length) ** 2 + (y - 0.5 * self.width) ** 2
        self._middle = int(np.argmin(middle))

    def problem(self, shortening: float) -> SheetProblem:
        """The strip with its hinges; closer by this much [mm] at the load factor 1."""
        conditions = Conditions(self.sheet)
        # Hinges hold their lines straight, and let the ends turn about y and grow wider along it.
        conditions.hinge(self.ends[0], (0.0, 1.0), "xz")
        conditions.hinge(self.ends[1], (0.0, 1.0), "xz", shift=(-shortening, 0.0, 0.0))
        conditions.hold(self.sheet.rows.positions(self._corner), "y")
        return SheetProblem(conditions, self.solver.linear_solver)

    def test(self, shortenings: ArrayLike = SHORTENINGS, side: str = "closing") -> StageTest:
        """Bring the hinges closer by one shortening [mm] after another; see `simulate_stage`."""
        sign = side_sign(side)
        asked = require_shortenings(shortenings, self.length)
        last = float(asked[-1])
        problem = self.problem(last)
        steps: list[LoadStep] = []
        for shortening in asked.tolist():
            before = steps[-1] if steps else None
            arc = hinged_arc(self.length, self.length - shortening, sign)
            steps.append(self._reach(problem, shortening / last, before, arc))
        numbers = np.array([self._numbers(step, sign) for step in steps]).T
        warn_beyond("The strip on the stage bends", numbers[3], self.curvature_range)
        return StageTest(
            length=self.length,
            width=self.width,
            direction=self.direction,
            side=side,
            mesh=self.sheet.mesh,
            shortenings=asked,
            force=numbers[0],
            energy=numbers[1],
            deflection=numbers[2],
            largest_curvature=numbers[3],
            status=np.array([int(step.status) for step in steps]),
            iterations=np.array([step.iterations for step in steps]),
            negative_eigenvalues=np.array([step.negative_eigenvalues for step in steps]),
            positions=self._last_shape(steps),
        )

    def _reach(
        self, problem: SheetProblem, factor: float, before: LoadStep | None, arc: Surface
    ) -> LoadStep:
        """Equilibrium at a factor, followed from the one before; from an arc where there is none,
        or where that leads nowhere."""
        spent, options = 0, self.solver.for_a_sample()
        if before is not None and before.status == SolveStatus.converged:
            z, reached = before.state.z, before.factor
            (step,) = follow_loads(problem, [factor], options, z, reached)
            if step.status == SolveStatus.converged:
                return step
            spent = step.iterations
        start = problem.start(factor, self.sheet.place(arc).ravel())
        found = solve_equilibrium(problem, start, options)
        return LoadStep(
            factor, found.status, found.evaluation, spent + found.iterations,
            found.negative_eigenvalues,
        )  # fmt: skip

    def _last_shape(self, steps: list[LoadStep]) -> FloatArray:
        n = self.sheet.mesh.n_vertices
        found = [step.state for step in steps if step.status == SolveStatus.converged]
        if not found:
            return np.full((n, 3), np.nan)
        return found[-1].y[self.sheet.rows.positions(np.ones(n, dtype=bool))]

    def _numbers(self, step: LoadStep, sign: float) -> tuple[float, float, float, float]:
        """Force, energy, deflection, largest curvature; nan unless converged."""
        if step.status != SolveStatus.converged:
            return np.nan, np.nan, np.nan, np.nan
        state, rows = step.state, self.sheet.rows
        # The resultant on the hinge that stays: derivatives along y carry no resultant.
        force = float(state.forces[rows.positions(self.ends[0]), 0].sum())
        chosen = np.arange(self.sheet.mesh.n_vertices) == self._middle
        height = float(state.y[rows.positions(chosen)[0], 2])
        largest = float(self.sheet.curvatures(state.y)[0].max())
        return force, state.strain_energy, -sign * height, largest


@checked(
    model=checks.MODEL,
    length=length("strip length"),
    width=length("strip width"),
    shortenings=series("mm", "shortening"),
    direction=ANGLE,
    side=ONE_SIDE,
    options=checks.RIG,
    solver=checks.SOLVER,
)
def simulate_stage(
    model: SheetModel,
    *,
    length: float = 100.0,
    width: float = 50.0,
    shortenings: ArrayLike = SHORTENINGS,
    direction: float = 0.0,
    side: str = "closing",
    options: RigOptions | None = None,
    solver: SolverOptions | None = None,
) -> StageTest:
    """Bring the two hinges of a strip of a macro model closer, and measure the force on them.

    Parameters
    ----------
    model : with in-plane stiffness, as `fs.fit` makes it.
    length, width : mm; the hinges are at both ends of the length.
    shortenings : (n,) mm, increasing from above 0.
    direction : degree, of the strip's length in the pattern's coordinates.
    side : "closing" bends the scales toward each other, "opening" away from each other.
    options : discretization; smooth triangles of 5 mm if not given.
    solver : how equilibria are sought.

    Returns
    -------
    StageTest; its numbers are nan where no equilibrium was found. Where the strip bends beyond the
    curvatures that the model was fitted to, one warning says so.

    Raises
    ------
    BadInputError : the model has no in-plane stiffness, or the shortenings do not increase or reach
        the length.
    UnitRangeError : a size, shortening or direction out of range.
    UnknownNameError : no such side.
    """
    rig = StageRig(
        model.sheet_law(), length=length, width=width, direction=direction, options=options,
        curvature_range=model.largest_curvature, solver=solver,
    )  # fmt: skip
    return rig.test(shortenings, side)

"""The mandrel: a disc clamped at its hub and pushed at one point of its rim (Figs. 6, 9, 10).

The disc turns under the probe: the point that is pushed goes around the rim of one mesh. The probe
has no friction, so it holds the height of that point and nothing else.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from flexscale import checks
from flexscale.arrays import FloatArray, IntArray
from flexscale.checks import checked, length, series
from flexscale.mechanics.extrapolation import warn_beyond
from flexscale.mechanics.load_series import finite_series
from flexscale.mechanics.sheet_law import SheetLaw
from flexscale.mesh.sheet import SheetMesh
from flexscale.sheets.bent_sheet import TOLERANCE
from flexscale.sheets.conditions import Conditions
from flexscale.sheets.load_path import LoadStep, follow_loads
from flexscale.sheets.rigs import RigOptions
from flexscale.sheets.rim import ANGLES, HUB, Rim
from flexscale.sheets.sheet import build_sheet
from flexscale.sheets.sheet_model import SheetModel
from flexscale.sheets.sheet_problem import SheetProblem
from flexscale.short_repr import ShortRepr
from flexscale.sides import ONE_SIDE, side_sign
from flexscale.solve.solver_options import SolverOptions
from flexscale.status import SolveStatus

#: degree, where the disc is pushed if nothing else is said.

_CLOSE = 1e-9  # share of the radius


@dataclass(frozen=True, eq=False, repr=False)
class MandrelTest(ShortRepr):
    """Forces around the rim of a disc; numbers are nan where no equilibrium was found.

    Attributes
    ----------
    radius, hub, indentation : mm.
    side : "closing" or "opening".
    mesh : triangles at rest, from the hub outward.
    angles : (n,) degree, where the rim is pushed, in the pattern's coordinates.
    force : (n,) N, of the probe, along its push.
    energy : (n,) N mm.
    largest_curvature : (n,) mm-1, largest |principal curvature| in the disc.
    status : (n,) `SolveStatus`.
    iterations : (n,) of Newton's method.
    negative_eigenvalues : (n,) of the Hessian; a state that has some is unstable.
    positions : (n_vertices, 3) mm, the disc pushed at the first angle modulo 180 degree;
        nan if that did not converge.
    """

    radius: float
    hub: float
    indentation: float
    side: str
    mesh: SheetMesh
    angles: FloatArray
    force: FloatArray
    energy: FloatArray
    largest_curvature: FloatArray
    status: IntArray
    iterations: IntArray
    negative_eigenvalues: IntArray
    positions: FloatArray


@dataclass(frozen=True, eq=False)
class Push:
    """One push: signed force [N] along z, largest |principal curvature| [mm-1], and the state."""

    force: float
    largest_curvature: float
    positions: FloatArray
    step: LoadStep

    @property
    def numbers(self) -> tuple[float, float, float]:
        """Force, energy, largest curvature; nan unless converged."""
        if self.step.status != SolveStatus.converged:
            return np.nan, np.nan, np.nan
        return self.force, self.step.state.strain_energy, self.largest_curvature


class MandrelRig:
    """A disc on the mandrel, to be pushed anywhere on its rim.

    Parameters
    ----------
    law : energy per rest area; its first axis is at 0 degree.
    radius, hub : mm.
    options : discretization, load steps. Rings of triangles come in fours, so that the rim has a
        vertex every 15 degrees.
    curvature_range : mm-1, up to which the law is founded on data; beyond it, one warning a test.
    solver : how equilibria are sought; its tolerance is that of bent sheets if it is left out.

    Raises
    ------
    UnitRangeError : a size that is not positive.
    BadInputError : a hub that leaves nothing of the disc.
    """

    def __init__(
        self,
        law: SheetLaw,
        *,
        radius: float = 100.0,
        hub: float = HUB,
        options: RigOptions | None = None,
        curvature_range: float = np.inf,
        solver: SolverOptions | None = None,
    ) -> None:
        self.options = options or RigOptions()
        self.rim = Rim(radius, hub, self.options.size)
        self.curvature_range = curvature_range
        self.solver = solver or SolverOptions(tolerance=TOLERANCE)
        mesh = self.rim.mesh()
        self.clamped = np.hypot(*mesh.points.T) <= hub * (1.0 + _CLOSE)
        self.sheet = build_sheet(mesh, law, element=self.options.element, clamped=self.clamped)

    def push(self, angle: float, height: float) -> Push:
        """Equilibrium with the rim at an angle [degree] held at a height [mm, closing > 0]."""
        everywhere = np.ones(self.sheet.mesh.n_vertices, dtype=bool)
        positions = self.sheet.rows.positions(everywhere)
        row = positions[self.rim.place(angle) - self.rim.n_vertices]
        conditions = Conditions(self.sheet)
        conditions.clamp(self.clamped)
        lifted = self.sheet.rest + np.array([0.0, 0.0, height])
        conditions.hold(np.array([row]), "z", lifted)
        problem = SheetProblem(conditions, self.solver.linear_solver)
        factors = np.arange(1, self.options.steps + 1) / self.options.steps
        step = follow_loads(problem, factors.tolist(), self.solver.for_a_sample())[-1]
        state = step.state
        largest = float(self.sheet.curvatures(state.y)[0].max())
        return Push(float(state.forces[row, 2]), largest, state.y[positions], step)

    def test(
        self, indentation: float = 15.0, angles: ArrayLike = ANGLES, side: str = "closing"
    ) -> MandrelTest:
        """Push at every angle [degree] by an indentation [mm]; see `simulate_mandrel`."""
        sign = side_sign(side)
        asked = finite_series(angles, "mandrel angle", "degree")
        self.rim.require_indentation(indentation)
        for angle in asked.tolist():
            self.rim.place(angle)  # bad input is refused before the first solve
        # Half a turn takes mesh and curvature tensors to themselves: both halves are the same.
        halves, place = np.unique(np.round(asked % 180.0, 6) % 180.0, return_inverse=True)
        pushes = [self.push(angle, sign * indentation) for angle in halves.tolist()]
        first = pushes[int(place[0])]
        force, energy, curvature = np.array([push.numbers for push in pushes])[place].T
        steps = [pushes[index].step for index in place.tolist()]
        warn_beyond("The disc on the mandrel bends", curvature, self.curvature_range)
        return MandrelTest(
            radius=self.rim.radius,
            hub=self.rim.hub,
            indentation=indentation,
            side=side,
            mesh=self.sheet.mesh,
            angles=asked,
            force=sign * force,
            energy=energy,
            largest_curvature=curvature,
            status=np.array([int(step.status) for step in steps]),
            iterations=np.array([step.iterations for step in steps]),
            negative_eigenvalues=np.array([step.negative_eigenvalues for step in steps]),
            positions=np.where(np.isfinite(first.numbers[0]), first.positions, np.nan),
        )


@checked(
    model=checks.MODEL,
    radius=length("disc radius"),
    hub=length("hub radius"),
    indentation=length(),
    angles=series("degree", "mandrel angle"),
    side=ONE_SIDE,
    options=checks.RIG,
    solver=checks.SOLVER,
)
def simulate_mandrel(
    model: SheetModel,
    *,
    radius: float = 100.0,
    hub: float = HUB,
    indentation: float = 15.0,
    angles: ArrayLike = ANGLES,
    side: str = "closing",
    options: RigOptions | None = None,
    solver: SolverOptions | None = None,
) -> MandrelTest:
    """Push the rim of a disc of a macro model, clamped at its hub, at one angle after another.

    Parameters
    ----------
    model : with in-plane stiffness, as `fs.fit` makes it.
    radius, hub : mm.
    indentation : mm, by which the point of the rim is pushed normal to the disc.
    angles : (n,) degree, in the pattern's coordinates; on vertices of the rim, which are every 15
        degrees or closer. Angles half a turn apart give the same and are solved once.
    side : "closing" pushes toward the scales, "opening" away from them.
    options : discretization and load steps; smooth triangles of 5 mm if not given.
    solver : how equilibria are sought.

    Returns
    -------
    MandrelTest; its numbers are nan where no equilibrium was found. Where the disc bends beyond the
    curvatures that the model was fitted to, one warning says so.

    Raises
    ------
    BadInputError : the model has no in-plane stiffness, the hub or the indentation is too large, or
        the rim has no vertex at an angle.
    UnitRangeError : a size, indentation or angle out of range.
    UnknownNameError : no such side.
    """
    rig = MandrelRig(
        model.sheet_law(), radius=radius, hub=hub, options=options,
        curvature_range=model.largest_curvature, solver=solver,
    )  # fmt: skip
    return rig.test(indentation, angles, side)

"""A rectangular macro sheet bent between two end strips that lie on a cylinder (Figs. 13, 14).

One strip is held on the cylinder; the other keeps its place on the cylinder's radius, but slides
along the arc as one body, since sheets lengthen where scales press on one another. It keeps its
turn, or turns with the arc as a native sheet's end does.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.checks import checked, choice, flag, length, number
from flexscale.errors import BadInputError
from flexscale.mechanics.extrapolation import warn_beyond
from flexscale.mechanics.sheet_law import SheetLaw
from flexscale.mechanics.substrate_options import SUBSTRATE_ELEMENTS
from flexscale.mesh.sheet import SheetMesh, rectangle
from flexscale.sheets.conditions import Conditions
from flexscale.sheets.grips import Grip, Sliding
from flexscale.sheets.sheet import Sheet, build_sheet
from flexscale.sheets.sheet_points import sheet_positions
from flexscale.sheets.sheet_problem import SheetProblem, SheetState
from flexscale.sheets.sheet_rows import POSITION
from flexscale.sheets.surfaces import cylinder
from flexscale.short_repr import ShortRepr
from flexscale.solve.newton import solve_equilibrium
from flexscale.solve.solver_options import SolverOptions
from flexscale.status import SolveStatus
from flexscale.units import LENGTHS, require_finite, require_positive, require_range

#: Newton decrement over the energy; the step it belongs to is still taken, so that energies are
#: good to 1e-12 of themselves, and states to 1e-6.
TOLERANCE = 1e-8
#: Sheets that lock between soft parts take more than the 20 to 40 of most.
MOST_ITERATIONS = 300
_KAPPA_STEP = 1e-4  # relative, of the central difference of the strips' places


@checked(
    element=choice("substrate element", SUBSTRATE_ELEMENTS),
    size=length("element size"),
    strip=number("mm", 0.0, LENGTHS[1]),
    turning=flag,
)
@dataclass(frozen=True)
class SheetOptions:
    """How a bent sheet is discretized and held.

    Attributes
    ----------
    element : "c1", or the paper's linear triangles with "edge_angle".
    size : mm, sides of the triangles.
    strip : mm, length of the end strips; 0 for the end edges alone. Whole vertices are gripped.
    turning : whether the strip that slides turns with the arc.
    """

    element: str = "c1"
    size: float = 5.0
    strip: float = 0.0
    turning: bool = False


@dataclass(frozen=True, eq=False, repr=False)
class BentSheet(ShortRepr):
    """A sheet at one curvature; numbers are nan unless it converged.

    Attributes
    ----------
    curvature : mm-1, positive closes.
    direction : degree, of the sheet's length in the law's axes.
    sheet : mesh and elements at rest.
    rows : (n_rows, 3) its deformed state.
    energy : N mm.
    energy_density : N/mm, over the rest area.
    moment : N, (1/area) dE/dcurvature: mean moment per width.
    slide : mm, by which the other end slid away along the arc.
    largest_curvature : mm-1, largest |principal curvature| in the sheet.
    largest_at : (2,) mm, where, in the sheet at rest.
    status, iterations, negative_eigenvalues : of the solve.
    """

    curvature: float
    direction: float
    sheet: Sheet
    rows: FloatArray
    energy: float
    energy_density: float
    moment: float
    slide: float
    largest_curvature: float
    largest_at: FloatArray
    status: SolveStatus
    iterations: int
    negative_eigenvalues: int

    @property
    def mesh(self) -> SheetMesh:
        """Triangles at rest."""
        return self.sheet.mesh

    @property
    def positions(self) -> FloatArray:
        """(n_vertices, 3) mm; the held end at x = 0, bent toward +z if the curvature is
        positive."""
        return self.rows[self.sheet.rows.positions(np.ones(self.mesh.n_vertices, dtype=bool))]

    def at(self, points: FloatArray) -> FloatArray:
        """Where points (n, 2) of the sheet at rest are, (n, 3), mm; see `sheet_positions`."""
        return sheet_positions(self.sheet, self.rows, points)


class BendingRig:
    """A rectangular sheet between end strips, to be bent to any curvature.

    Parameters
    ----------
    law : energy per rest area.
    length, width : mm; the sheet is bent along its length.
    direction : degree, of the sheet's length in the law's axes.
    options : discretization, end strips.
    curvature_range : mm-1, up to which the law is founded on data; beyond it, one warning.
    solver : how equilibria are sought; its tolerance is TOLERANCE if it is left out.
    """

    def __init__(
        self,
        law: SheetLaw,
        *,
        length: float,
        width: float,
        direction: float = 0.0,
        options: SheetOptions | None = None,
        curvature_range: float = np.inf,
        solver: SolverOptions | None = None,
    ) -> None:
        self.options = options or SheetOptions()
        self.length = require_positive(length, "sheet length", "mm")
        self.direction = require_finite(direction, "direction", "degree")
        self.curvature_range = curvature_range
        self.solver = solver or SolverOptions(tolerance=TOLERANCE, max_iterations=MOST_ITERATIONS)
        strip = require_range(self.options.strip, "strip", "mm", 0.0, np.inf)
        mesh = rectangle(length, width, self.options.size)
        along, close = mesh.points[:, 0], 1e-9 * length
        self.ends = (along <= strip + close, along >= length - strip - close)
        if 2.0 * strip >= length or (self.ends[0] | self.ends[1]).all():
            raise BadInputError(
                f"Two end strips of {strip:.12g} mm and triangles of {self.options.size:.12g} mm "
                f"leave nothing of a sheet of {length:.12g} mm to bend: make them smaller."
            )
        self.sheet = build_sheet(
            mesh, law, element=self.options.element, clamped=self.ends[0] | self.ends[1],
            material_direction=-np.radians(self.direction),
        )  # fmt: skip
        self._warned = False

    @cached_property
    def _flat_problem(self) -> SheetProblem:
        """The sheet between its strips; what it couples is the same at all curvatures."""
        conditions = Conditions(self.sheet)
        conditions.clamp(self.ends[0])
        conditions.grip(self._grip(0.0, self.sheet.rest))
        return SheetProblem(conditions, self.solver.linear_solver)

    def problem(self, curvature: float) -> SheetProblem:
        """The sheet with its strips on a cylinder; one object for all curvatures."""
        placed = self.sheet.place(cylinder(curvature))
        conditions = self._flat_problem.conditions
        conditions.clamp(self.ends[0], values=placed)
        conditions.move_grip(0, self._grip(curvature, placed))
        return self._flat_problem

    def _grip(self, curvature: float, placed: FloatArray) -> Grip:
        rows = self.sheet.rows.rigid(self.ends[1])
        origin, gradient = cylinder(curvature)(np.array([[self.length, 0.0]]))
        tangent, across = gradient[0].T
        return Grip(
            rows,
            (self.sheet.rows.kinds[rows] == POSITION).astype(float),
            placed[rows],
            origin[0],
            Sliding(tangent, np.cross(tangent, across), curvature, self.options.turning),
        )

    def bend(self, curvature: float) -> BentSheet:
        """Equilibrium at a curvature [mm-1, positive closes], sought from the cylinder."""
        curvature = require_finite(curvature, "curvature", "mm-1")
        if abs(curvature) * self.length >= 2.0 * np.pi:
            raise BadInputError(
                f"At a curvature of {curvature:.12g} mm-1 a sheet of {self.length:.12g} mm runs "
                f"into its own end: stay below {2.0 * np.pi / self.length:.4g} mm-1."
            )
        problem = self.problem(curvature)
        placed = self.sheet.place(cylinder(curvature)).ravel()
        z = problem.start(1.0, np.concatenate([placed, [0.0]]))
        solution = solve_equilibrium(problem, z, self.solver.for_a_sample())
        state: SheetState = solution.evaluation
        found = solution.status == SolveStatus.converged
        energy = state.strain_energy if found else np.nan
        values, places = self.sheet.curvatures(state.y)
        top = int(np.argmax(values))
        if found:
            self._warn_beyond(float(values[top]), places[top])
        return BentSheet(
            curvature=curvature,
            direction=self.direction,
            sheet=self.sheet,
            rows=state.y,
            energy=energy,
            energy_density=energy / self.sheet.area,
            moment=self._moment(curvature, state) if found else np.nan,
            slide=float(state.z[-1]) if found else np.nan,
            largest_curvature=float(values[top]) if found else np.nan,
            largest_at=places[top],
            status=solution.status,
            iterations=solution.iterations,
            negative_eigenvalues=solution.negative_eigenvalues,
        )

    def _moment(self, curvature: float, state: SheetState) -> float:
        """(1/area) dE/dcurvature at equilibrium: work of the forces on the strips as they move."""
        step = _KAPPA_STEP / self.length
        moved = []
        for kappa in (curvature - step, curvature + step):
            y = np.zeros_like(state.y)
            placed = self.sheet.place(cylinder(kappa))
            held = self.sheet.rows.rigid(self.ends[0])
            y[held] = placed[held]
            grip = self._grip(kappa, placed)
            y[grip.rows] = grip.place(state.z[-1:])
            moved.append(y)
        return float(np.sum(state.forces * (moved[1] - moved[0]))) / (2.0 * step * self.sheet.area)

    def _warn_beyond(self, largest: float, place: FloatArray) -> None:
        if largest <= self.curvature_range or self._warned:
            return
        self._warned = True
        at = f"at ({place[0]:.1f}, {place[1]:.1f}) mm"
        warn_beyond("The sheet bends", largest, self.curvature_range, at)


def bend_sheet(
    law: SheetLaw,
    *,
    length: float,
    width: float,
    curvature: float,
    direction: float = 0.0,
    options: SheetOptions | None = None,
    curvature_range: float = np.inf,
    solver: SolverOptions | None = None,
) -> BentSheet:
    """Bend a rectangular sheet to one curvature; parameters as in `BendingRig` and its `bend`."""
    rig = BendingRig(
        law, length=length, width=width, direction=direction, options=options,
        curvature_range=curvature_range, solver=solver,
    )  # fmt: skip
    return rig.bend(curvature)

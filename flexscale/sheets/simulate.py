"""Sheets of a fitted macro model."""

from __future__ import annotations

from flexscale import checks
from flexscale.checks import ANGLE, checked, length, number
from flexscale.sheets.bent_sheet import BentSheet, SheetOptions, bend_sheet
from flexscale.sheets.sheet_model import SheetModel
from flexscale.solve.solver_options import SolverOptions


@checked(
    model=checks.MODEL,
    length=length("sheet length"),
    width=length("sheet width"),
    curvature=number("mm-1"),
    direction=ANGLE,
    options=checks.SHEET,
    solver=checks.SOLVER,
)
def simulate_sheet(
    model: SheetModel,
    *,
    length: float,
    width: float,
    curvature: float,
    direction: float = 0.0,
    options: SheetOptions | None = None,
    solver: SolverOptions | None = None,
) -> BentSheet:
    """Bend a rectangular sheet of a macro model between two end strips that slide along the arc.

    Parameters
    ----------
    model : with in-plane stiffness, as `fs.fit` makes it.
    length, width : mm; the sheet is bent along its length.
    curvature : mm-1, positive closes.
    direction : degree, of the sheet's length in the pattern's coordinates.
    options : discretization and end strips; smooth triangles of 5 mm if not given.
    solver : how the equilibrium is sought.

    Returns
    -------
    BentSheet; its numbers are nan unless it converged. Where the sheet bends beyond the curvatures
    that the model was fitted to, one warning says so.

    Raises
    ------
    BadInputError : the model has no in-plane stiffness, or the sheet cannot be held so.
    UnitRangeError : a size or number out of range.
    """
    return bend_sheet(
        model.sheet_law(),
        length=length,
        width=width,
        curvature=curvature,
        direction=direction,
        options=options,
        curvature_range=model.largest_curvature,
        solver=solver,
    )

"""Sheets of a fitted macro model."""

from __future__ import annotations

import numpy as np

from flexscale.macro import tensor_law
from flexscale.macro.bent_sheet import BentSheet, SheetOptions, bend_sheet
from flexscale.macro.model import MacroModel
from flexscale.mechanics.sheet_law import SheetLaw
from flexscale.solve.newton import SolverOptions


def sheet_law(model: MacroModel) -> SheetLaw:
    """The law of a model's energy, for sheets of it.

    Raises
    ------
    BadInputError : the in-plane stiffness is not known.
    """
    parameters = model.law_parameters()
    assert model.in_plane is not None  # or there would be no parameters
    largest = float(np.linalg.eigvalsh(model.in_plane).max())
    return SheetLaw(tensor_law.energy, tensor_law.law, parameters, largest)


def simulate_sheet(
    model: MacroModel,
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
        sheet_law(model),
        length=length,
        width=width,
        curvature=curvature,
        direction=direction,
        options=options,
        curvature_range=model.largest_curvature,
        solver=solver,
    )

"""How far a mesh is from its limit, as far as the flat cell tells."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

import numpy as np

from flexscale.errors import MeshError
from flexscale.homogenize.cell_model import CellModel
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.tangent import TangentStiffness, solve_tangent
from flexscale.mechanics.contact_options import ContactOptions
from flexscale.mesh.options import MeshOptions
from flexscale.mesh.torus import build_mesh
from flexscale.patterns import Pattern

if TYPE_CHECKING:
    import xarray as xr

_ORDER = 2.0
_DIRECTIONS = np.arange(0.0, 180.0, 5.0)


def estimate_mesh_error(
    pattern: Pattern, mesh: MeshOptions, model: CellModel, tangent: TangentStiffness
) -> float:
    """Relative error of the flat cell's bending stiffness in the worst direction, by estimate.

    It is compared with that of elements twice as large. From half to three halves of the default's
    fineness, errors of squares and hexagons fall as the size to the power 2.4 to 2.7; the second
    order taken here is on the safe side: what is left is a third of what was won by halving.

    Parameters
    ----------
    mesh, model, tangent : of the cell whose error is asked for.

    Returns
    -------
    nan if the pattern cannot be meshed with larger elements.
    """
    without_contact = dataclasses.replace(model, contact=ContactOptions(enabled=False))
    try:
        solid = None if model.solid is None else model.solid.finer(0.5)
        coarse = build_mesh(pattern, mesh.finer(0.5), solid)
    except MeshError:
        return float("nan")
    without_contact = dataclasses.replace(without_contact, solid=solid)
    other = solve_tangent(CellProblem(coarse, without_contact))
    ratio = np.asarray(other.stiffness(_DIRECTIONS)) / np.asarray(tangent.stiffness(_DIRECTIONS))
    return float(np.abs(ratio - 1.0).max()) / (2.0**_ORDER - 1.0)


def note_mesh_error(dataset: xr.Dataset, error: float) -> None:
    """Write an estimate into a dataset's attributes."""
    dataset.attrs["mesh_error_at_rest"] = error
    dataset.attrs["mesh_error_comment"] = (
        "estimated relative error of the flat cell's bending stiffness in the worst direction, "
        "from elements twice as large; in contact errors are up to a few times that"
    )

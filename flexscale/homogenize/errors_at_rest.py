"""What is known of a native model's own errors, as far as the flat cell tells."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

import numpy as np

from flexscale.errors import MeshError
from flexscale.homogenize.cell_model import CellModel
from flexscale.homogenize.cell_problem import CellProblem
from flexscale.homogenize.native_model import NativeModel
from flexscale.homogenize.problem import Problem
from flexscale.homogenize.tangent import TangentStiffness, solve_tangent
from flexscale.mechanics.contact_options import ContactOptions
from flexscale.mesh.options import MeshOptions
from flexscale.mesh.torus import build_mesh
from flexscale.patterns import Pattern
from flexscale.patterns.material import modulus_band

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


def note_errors(
    dataset: xr.Dataset,
    pattern: Pattern,
    native: NativeModel,
    problem: Problem,
    tangent: TangentStiffness,
) -> None:
    """Write what is known of a model's own errors into a dataset's attributes."""
    if isinstance(problem, CellProblem):
        error = estimate_mesh_error(pattern, native.mesh, problem.model, tangent)
        dataset.attrs["mesh_error_at_rest"] = error
        dataset.attrs["mesh_error_comment"] = (
            "estimated relative error of the flat cell's bending stiffness in the worst direction, "
            "from elements twice as large; in contact errors are up to a few times that"
        )
    band = modulus_band(pattern.substrate_material)
    if band is not None:
        dataset.attrs["force_band"] = (
            f"forces and energies scale with Young's modulus of the sheet, whose measured values "
            f"lie from {band[0]:.2f} to {band[1]:.2f} of the one taken here; onsets do not change"
        )
    if problem.doubts:
        dataset.attrs["doubts"] = "; ".join(problem.doubts)

"""Native sheets over side and curvature, as a dataset."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from flexscale import checks
from flexscale.checks import ANGLE, checked, function, length, series
from flexscale.datasets.build_sheets import build_sheet_dataset
from flexscale.datasets.variables import SOME_SIDES
from flexscale.homogenize.checkpoint import Checkpoint
from flexscale.homogenize.labels import pattern_scalars
from flexscale.homogenize.line import Line
from flexscale.homogenize.native_sheet import NativeSheet, check_bends
from flexscale.homogenize.sweep import SampleEvent, run_lines
from flexscale.mechanics.contact_options import ContactOptions
from flexscale.mechanics.scale_options import ScaleOptions
from flexscale.mechanics.substrate_options import SubstrateOptions
from flexscale.mesh.estimate import require_moderate_sheet
from flexscale.mesh.options import MeshOptions
from flexscale.patterns import Pattern
from flexscale.solve.solver_options import SolverOptions

if TYPE_CHECKING:
    import xarray as xr

#: Variable of the dataset -> entry of a sample, over the sheet's area where it is a density.
_REAL = ("energy_density", "moment", "min_gap")
_COUNTED = ("newton_iterations", "negative_eigenvalues", "contact_pairs")


@checked(
    pattern=checks.PATTERN,
    length=length("sheet length"),
    width=length("sheet width"),
    curvatures=series("mm-1"),
    direction=ANGLE,
    sides=SOME_SIDES,
    mesh=checks.MESH,
    contact=checks.CONTACT,
    substrate=checks.SUBSTRATE,
    scales=checks.SCALES,
    solver=checks.SOLVER,
    checkpoint=checks.CHECKPOINT,
    on_sample=function,
)
def simulate_native_sheet(
    pattern: Pattern,
    *,
    length: float,
    width: float,
    curvatures: Sequence[float],
    direction: float = 0.0,
    sides: Sequence[str] = ("closing", "opening"),
    mesh: MeshOptions | None = None,
    contact: ContactOptions | None = None,
    substrate: SubstrateOptions | None = None,
    scales: ScaleOptions | None = None,
    solver: SolverOptions | None = None,
    checkpoint: Checkpoint | None = None,
    on_sample: Callable[[SampleEvent], None] | None = None,
) -> xr.Dataset:
    """Bend a rectangular sheet of the native model between two end strips (Figs. 13, 14).

    The strips are the scales that the ends cut; the sheet's sides are free. See `NativeSheet`.

    Parameters
    ----------
    pattern : the scale pattern.
    length, width : mm; the sheet is bent along its length.
    curvatures : mm-1, from 0 on, increasing; one number is a series of one.
    direction : degree, of the sheet's length in the pattern's coordinates.
    sides : "closing", "opening", or both.
    mesh, contact, substrate, scales, solver : options, defaults if not given.
    checkpoint : keeps samples as they finish, and gives back those of an interrupted run.
    on_sample : called as samples finish.

    Returns
    -------
    xarray.Dataset of kind native_sheet; samples that did not converge hold NaN and a `status`.

    Raises
    ------
    PatternError, MeshError : the sheet cannot be cut from the pattern, or not be meshed.
    BadInputError : the sheet would run into its own end, an unknown side, or options that only a
        periodic cell has.
    """
    mesh, solver = mesh or MeshOptions(), solver or SolverOptions()
    check_bends(length, curvatures, sides)
    require_moderate_sheet(pattern, mesh, length, width)
    sheet = NativeSheet(
        pattern, length, width, direction, mesh=mesh, contact=contact, substrate=substrate,
        scales=scales, linear_solver=solver.linear_solver,
    )  # fmt: skip
    kappa = tuple(curvatures)
    # The pattern is turned on the sheet, which always bends along its length.
    lines = [Line(side, 0.0, kappa) for side in sides]
    found = run_lines(sheet, lines, solver, checkpoint, on_sample)
    samples = [found[side, 0.0] for side in sides]

    def table(name: str, missing: float) -> np.ndarray:
        return np.array([[s.get(name, missing) for s in row] for row in samples])

    stretch = [[s.get("stretch", np.full(3, np.nan))[0] for s in row] for row in samples]
    arrays: dict[str, Any] = {name: table(name, np.nan) for name in _REAL}
    arrays |= {name: table(name, 0).astype(np.int32) for name in _COUNTED}
    arrays |= {
        "energy": arrays["energy_density"] * sheet.area,
        "slide": (np.array(stretch) - 1.0) * length,
        "status": table("status", 0).astype(np.int8),
        "n_scales": sheet.mesh.n_scales,
        "n_unknowns": len(sheet.active),
    }
    options = {
        "mesh": mesh.to_config(),
        "solver": solver.to_config(),
        "contact": (contact or ContactOptions()).to_config(),
        "substrate": (substrate or SubstrateOptions()).to_config(),
        "scales": (scales or ScaleOptions()).to_config(),
    }
    return build_sheet_dataset(
        sides,
        kappa,
        arrays,
        length=length,
        width=width,
        direction=direction,
        scalars=pattern_scalars(pattern, mesh),
        config={"pattern": pattern.to_config(), **options},
        kind="native_sheet",
    )

"""Native sheets over side and curvature, as a dataset."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from flexscale import checks
from flexscale.checks import ANGLE, checked, function, length, series
from flexscale.datasets.kinds.native_sheet import NATIVE_SHEET
from flexscale.datasets.kinds.sweep import NO_CONTACT_COMMENT
from flexscale.datasets.sheet_variables import build_sheet_dataset
from flexscale.finite.native_sheet import NativeSheet, check_bends
from flexscale.finite.sheet_scales import require_moderate_scales
from flexscale.homogenize.bend_line import Line
from flexscale.homogenize.checkpoint import Checkpoint
from flexscale.homogenize.labels import pattern_scalars
from flexscale.homogenize.native_model import NativeModel, native_model, require_joints
from flexscale.homogenize.run_lines import run_in_turn
from flexscale.homogenize.sweep import SampleEvent, telling
from flexscale.patterns import Pattern
from flexscale.patterns.sheet_outline import sheet_outline
from flexscale.sides import one_side_or_some

if TYPE_CHECKING:
    import xarray as xr

#: Variable of the dataset -> entry of a sample, over the sheet's area where it is a density.
_REAL = ("energy_density", "moment", "min_gap")
_COUNTED = ("newton_iterations", "negative_eigenvalues", "contact_pairs", "outside_range")


@checked(
    pattern=checks.PATTERN,
    length=length("sheet length"),
    width=length("sheet width"),
    curvatures=series("mm-1"),
    direction=ANGLE,
    side=one_side_or_some,
    offset=checks.place,
    outline=sheet_outline,
    model=native_model,
    checkpoint=checks.CHECKPOINT,
    on_sample=function,
)
def simulate_native_sheet(
    pattern: Pattern,
    length: float = 100.0,
    width: float = 50.0,
    *,
    curvatures: Sequence[float],
    direction: float = 0.0,
    side: str | Sequence[str] = ("closing", "opening"),
    offset: Sequence[float] = (0.0, 0.0),
    outline: ArrayLike | None = None,
    model: NativeModel | str = "joints",
    checkpoint: Checkpoint | None = None,
    on_sample: Callable[[SampleEvent], None] | None = None,
) -> xr.Dataset:
    """Bend a sheet of scales on joints between two end strips (Figs. 13, 14).

    The strips are the scales that touch the ends; the sheet's sides are free. See `NativeSheet`.

    Parameters
    ----------
    pattern : the scale pattern.
    length, width : mm; the sheet is bent along its length.
    curvatures : mm-1, from 0 on, increasing; one number is a series of one.
    direction : degree, of the sheet's length in the pattern's coordinates.
    side : "closing", "opening", or both; of one alone, the dataset has no such axis.
    offset : (2,) mm, point of the pattern that lies in the middle of the sheet.
    outline : (n, 2) corners of a sheet that is no rectangle, mm, in either orientation. It fills
        the length and width from the origin on, and has edges at x = 0 and x = length, its ends.
    model : the native model, of joints, or its name with its default options.
    checkpoint : keeps samples as they finish, and gives back those of an interrupted run.
    on_sample : called as samples finish.

    Returns
    -------
    xarray.Dataset of kind native_sheet; samples that did not converge hold NaN and a `status`.

    Raises
    ------
    PatternError : the sheet cannot be cut from the pattern, or joints cannot be computed.
    ConfigError : another native model.
    BadInputError : the sheet would run into its own end, an unknown side, or more scales than
        memory holds.
    """
    native = native_model(model)
    require_joints(native)
    sides = (side,) if isinstance(side, str) else tuple(side)
    check_bends(length, curvatures, sides)
    require_moderate_scales(pattern, length * width)
    sheet = NativeSheet(pattern, length, width, direction, offset, native=native, outline=outline)
    kappa = tuple(curvatures)
    # The pattern is turned on the sheet, which always bends along its length.
    lines = [Line(side, 0.0, kappa) for side in sides]
    found = run_in_turn(sheet, lines, native.solver, checkpoint, telling(on_sample))
    samples = [found[line] for line in lines]

    def table(name: str, missing: float) -> np.ndarray:
        return np.array([[s.get(name, missing) for s in row] for row in samples])

    stretch = [[s.get("stretch", np.full(3, np.nan))[0] for s in row] for row in samples]
    arrays: dict[str, Any] = {name: table(name, np.nan) for name in _REAL}
    arrays |= {name: table(name, 0).astype(np.int32) for name in _COUNTED}
    arrays |= {
        "energy": arrays["energy_density"] * sheet.area,
        "slide": (np.array(stretch) - 1.0) * length,
        "status": table("status", 0).astype(np.int8),
        "n_scales": len(sheet.sheet.laid.tiles),
        "n_unknowns": len(sheet.active),
    }
    dataset = build_sheet_dataset(
        NATIVE_SHEET,
        sides,
        kappa,
        arrays,
        length=length,
        width=width,
        direction=direction,
        scalars=pattern_scalars(pattern, native),
        config={
            "pattern": pattern.to_config(),
            "offset": [float(value) for value in offset],
            **({} if outline is None else {"outline": np.asarray(outline, float).tolist()}),
            **native.to_config(),
            **sheet.facts,
        },
    )
    if not native.contact.enabled:
        dataset["min_gap"].attrs["comment"] = NO_CONTACT_COMMENT
    return dataset.isel(side=0) if isinstance(side, str) else dataset

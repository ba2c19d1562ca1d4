"""A sheet of scales on joints between two end strips on a cylinder (Figs. 13, 14).

Scales that touch the ends are the strips: flat, tangent to the cylinder at the end. Those of the
near end are held; those of the far end are carried along the arc by (1 + Sxx) times the sheet's
length. They keep their place on the cylinder's radius and the cylinder's rotation, and slide along
the arc as one body. All other scales are as those of a cell under the same bend, without a period.

A long sheet that is held so leaves the arc: it becomes shorter along it, and so turns less. `ends`
"turned" instead turns the far strip by curvature times length and leaves it free to move in the
plane of bending, which takes a moment and no force.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from flexscale.arrays import FloatArray, IntArray
from flexscale.errors import BadInputError, PatternError
from flexscale.finite.joint_sheet import JointSheet
from flexscale.finite.sheet_scales import (
    SheetScales,
    find_sheet_scales,
    require_connected,
    require_moderate_scales,
)
from flexscale.homogenize.bend_line import Line
from flexscale.homogenize.line import follow_line
from flexscale.homogenize.native_model import NativeModel
from flexscale.mechanics.load_series import require_bends
from flexscale.patterns.laid import LaidPattern, lay_pattern, on_line
from flexscale.patterns.pattern import Pattern
from flexscale.patterns.sheet_outline import sheet_border
from flexscale.sides import SOME_SIDES
from flexscale.solve.solver_options import SolverOptions


def strips_of(laid: LaidPattern, length: float, width: float) -> list[tuple[IntArray, FloatArray]]:
    """Scales at the near and at the far end, each with the middle of its end (2,), mm.

    Raises
    ------
    PatternError : an end at which no scale is, or a scale that reaches from end to end.
    """
    ends = [np.array([on_line(tile, x) for tile in laid.tiles]) for x in (0.0, length)]
    for at_end, name in zip(ends, ("near", "far"), strict=True):
        if not at_end.any():
            raise PatternError(
                f"No scale touches the {name} end of a sheet of {length:g} x {width:g} mm, which "
                "would be held by nothing: change its length by a few mm, or the pattern's offset."
            )
    if (ends[0] & ends[1]).any() or (ends[0] | ends[1]).all():
        raise PatternError(
            f"A sheet of {length:g} x {width:g} mm has no scale between those that its ends hold: "
            "make it longer, or the tiles smaller."
        )
    return [
        (np.flatnonzero(at_end), np.array([x, 0.5 * width]))
        for at_end, x in zip(ends, (0.0, length), strict=True)
    ]


def require_sheet(
    pattern: Pattern,
    length: float,
    width: float,
    direction: float,
    offset: Sequence[float] = (0.0, 0.0),
    outline: ArrayLike | None = None,
) -> None:
    """Refuse a sheet between strips or hinges that cannot be, before anything is solved.

    Raises
    ------
    BadInputError, PatternError : more scales than memory holds, an outline without both ends, ends
        that hold no scale or all, or parts that no joint connects.
    """
    border = sheet_border(length, width, outline)
    require_moderate_scales(pattern, length * width)
    laid = lay_pattern(pattern, border, direction, offset)
    require_connected(find_sheet_scales(laid, strips_of(laid, length, width), touch=False))


class NativeSheet(JointSheet):
    """A sheet of whole and cut scales between end strips; the same interface as the periodic cell.

    Parameters
    ----------
    pattern : the scale pattern.
    length, width : mm; the sheet is bent along its length.
    direction : degree, of the sheet's length in the pattern's coordinates.
    offset : (2,) mm, point of the pattern that lies in the middle of the sheet.
    ends : "arc" or "turned".
    native : contact and solver; of the model `joints`.
    outline : (n, 2) corners, mm, if the sheet is no rectangle: see `sheet_border`.

    Raises
    ------
    PatternError : the sheet cannot be cut from the pattern, or joints cannot be computed.
    """

    def __init__(
        self,
        pattern: Pattern,
        length: float,
        width: float,
        direction: float = 0.0,
        offset: Sequence[float] = (0.0, 0.0),
        ends: str = "arc",
        native: NativeModel | None = None,
        outline: ArrayLike | None = None,
    ) -> None:
        native = native or NativeModel()
        laid = lay_pattern(pattern, sheet_border(length, width, outline), direction, offset)
        strips = strips_of(laid, length, width)
        scales: SheetScales = find_sheet_scales(laid, strips, native.contact.enabled)
        self.length, self.width, self.ends = length, width, ends
        free = np.ones(6 * scales.scales.n_scales + 3, dtype=bool)
        free[:12] = False  # both strips
        if ends == "turned":
            free[[6, 8]] = True  # along the arc and normal to it
            free[-3:] = False
        else:
            free[-2:] = False  # of S, the slide along the arc is left
        super().__init__(scales, native, free, still=False)


def bend_native_sheet(
    sheet: NativeSheet,
    curvatures: Sequence[float],
    side: str = "closing",
    solver: SolverOptions | None = None,
) -> Iterator[dict[str, Any]]:
    """Bend a native sheet step by step.

    Parameters
    ----------
    curvatures : mm-1, not negative, increasing.
    side : "closing" or "opening".

    Yields
    ------
    dict as of `follow_line`, and `slide` [mm], by which the far end moved away along the arc.

    Raises
    ------
    BadInputError : as of `check_bends`.
    """
    check_bends(sheet.length, curvatures, (side,), sheet.ends)
    line = Line(side, 0.0, tuple(float(k) for k in curvatures))
    for sample in follow_line(sheet, line, solver or SolverOptions()):
        told: dict[str, Any] = dict(sample)
        if "stretch" in sample:
            told["slide"] = float(sample["stretch"][0] - 1.0) * sheet.length
        yield told


def check_bends(
    length: float, curvatures: Sequence[float], sides: Sequence[str], ends: str = "arc"
) -> None:
    """Refuse bends of a sheet of a length [mm] that cannot be made, before anything is built.

    Raises
    ------
    BadInputError : an unknown side, curvatures [mm-1] that do not increase from 0 on, or the sheet
        would run into its own end.
    """
    SOME_SIDES(sides, "sides")
    require_bends(curvatures)
    if ends == "arc" and curvatures[-1] * length >= 2.0 * np.pi:
        raise BadInputError(
            f"At a curvature of {curvatures[-1]:.12g} mm-1 a sheet of {length:.12g} mm runs into "
            f"its own end: stay below {2.0 * np.pi / length:.4g} mm-1."
        )

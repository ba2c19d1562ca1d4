"""Sheets laid exactly on a surface, without a solve, for the tests of what rides on them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from flexscale.macro.fit import fit
from flexscale.sheets.bent_sheet import BendingRig, BentSheet, SheetOptions
from flexscale.sheets.surfaces import Surface, cylinder
from tests.macro.fit_samples import law_sweep, tangent


@cache
def flat_sheet(
    length: float = 60.0,
    width: float = 30.0,
    *,
    element: str = "c1",
    size: float = 5.0,
    direction: float = 0.0,
) -> BentSheet:
    rig = BendingRig(
        fit(law_sweep(), tangent()).sheet_law(), length=length, width=width, direction=direction,
        options=SheetOptions(element, size),
    )  # fmt: skip
    return rig.bend(0.0)


def laid_on(surface: Surface, sheet: BentSheet) -> BentSheet:
    return replace(sheet, rows=sheet.sheet.place(surface))


def on_cylinder(curvature: float, sheet: BentSheet) -> BentSheet:
    return replace(laid_on(cylinder(curvature), sheet), curvature=curvature)


def moved(rotation: np.ndarray, shift: np.ndarray) -> Surface:
    """The plane after a rigid motion."""

    def place(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        flat = np.column_stack([points, np.zeros(len(points))])
        gradients = np.broadcast_to(rotation[:, :2], (len(points), 3, 2))
        return flat @ rotation.T + shift, gradients

    return place

"""All steps and figures; to add one, add its room to this list.

The command line and the workflow engine need only these declarations, and start quickly.
"""

from __future__ import annotations

from flexscale.steps.kinds import (
    cell,
    fit,
    gap_model,
    joint,
    native_rig,
    native_sheet,
    native_turned_sheet,
    rig,
    shape,
    sheet,
    sweep,
    tangent,
    tensor_model,
    tensor_sweep,
    turned_sheet,
)
from flexscale.steps.step import Figure, Step

#: In an order in which every step comes after those whose datasets it takes.
STEPS: dict[str, Step] = {
    step.name: step
    for step in (
        cell.CELL,
        joint.JOINT,
        tangent.TANGENT,
        sweep.SWEEP,
        tensor_sweep.TENSOR_SWEEP,
        shape.SHAPE,
        fit.FIT,
        gap_model.GAP_MODEL,
        tensor_model.TENSOR_MODEL,
        sheet.SHEET,
        turned_sheet.TURNED_SHEET,
        native_sheet.NATIVE_SHEET,
        native_turned_sheet.NATIVE_TURNED_SHEET,
        rig.RIG,
        native_rig.NATIVE_RIG,
    )
}
FIGURES: dict[str, Figure] = {
    figure.name: figure for step in STEPS.values() for figure in step.figures
}

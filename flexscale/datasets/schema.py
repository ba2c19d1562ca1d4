"""All kinds of datasets; a change that readers would notice raises the kind's version."""

from __future__ import annotations

from flexscale.datasets.kinds import (
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
from flexscale.datasets.variables import Schema
from flexscale.errors import UnknownNameError, suggest

SCHEMAS: dict[str, Schema] = {
    schema.kind: schema
    for schema in (
        cell.CELL,
        sweep.SWEEP,
        tangent.TANGENT,
        tensor_sweep.TENSOR_SWEEP,
        shape.SHAPE,
        fit.FIT,
        gap_model.GAP_MODEL,
        tensor_model.TENSOR_MODEL,
        joint.JOINT,
        sheet.SHEET,
        turned_sheet.TURNED_SHEET,
        native_sheet.NATIVE_SHEET,
        native_turned_sheet.NATIVE_TURNED_SHEET,
        rig.RIG,
        native_rig.NATIVE_RIG,
    )
}


def schema_of(kind: str) -> Schema:
    """Table of a kind; UnknownNameError with the closest names for an unknown one."""
    if kind not in SCHEMAS:
        raise UnknownNameError(f"There is no dataset kind {kind!r}. {suggest(kind, SCHEMAS)}")
    return SCHEMAS[kind]

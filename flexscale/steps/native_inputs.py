"""The native model of a task, made of the datasets that its step takes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from flexscale.homogenize.native_model import NativeModel
from flexscale.steps.step import Task

if TYPE_CHECKING:
    import xarray as xr


def native_of(task: Task[Any], inputs: Mapping[str, xr.Dataset]) -> NativeModel:
    """The task's native model, with the law of the joints that were solved for it."""
    if "joint" not in inputs:
        return task.native
    from flexscale.joints.stored import law_of_dataset

    return replace(task.native, law=law_of_dataset(inputs["joint"]))

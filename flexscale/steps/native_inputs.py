"""The native model of a task, made of the datasets that its step takes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from flexscale.homogenize.native_model import NativeModel
from flexscale.steps.step import Task

if TYPE_CHECKING:
    import xarray as xr


def inputs_by_step(datasets: Iterable[tuple[str, xr.Dataset]]) -> dict[str, xr.Dataset]:
    """Input datasets by the steps that made them; further ones of a step are "joint 2", "joint 3"…

    Parameters
    ----------
    datasets : name of the step, and what it made.
    """
    found: dict[str, xr.Dataset] = {}
    for step, dataset in datasets:
        name, number = step, 1
        while name in found:
            number += 1
            name = f"{step} {number}"
        found[name] = dataset
    return found


def native_of(task: Task[Any], inputs: Mapping[str, xr.Dataset]) -> NativeModel:
    """The task's native model, with the laws of the joints that were solved for it."""
    if "joint" not in inputs:
        return task.native
    from flexscale.joints.stored import law_of_dataset

    joints = [dataset for name, dataset in inputs.items() if name.split()[0] == "joint"]
    joints.sort(key=lambda joint: float(joint["gap"]))  # as a model's laws are
    return replace(task.native, law=tuple(law_of_dataset(joint) for joint in joints))

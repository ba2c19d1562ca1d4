"""Step `rig`: the fitted model on the testing devices."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from flexscale.datasets.build_sheets import build_rig_dataset
from flexscale.macro.mandrel import MandrelTest, simulate_mandrel
from flexscale.macro.model import MacroModel
from flexscale.macro.rigs import RigOptions
from flexscale.macro.stage import StageTest, simulate_stage
from flexscale.steps.base import Resources
from flexscale.steps.catalog import MandrelParameters, RigParameters, StageParameters

if TYPE_CHECKING:
    import xarray as xr

#: Variable of the dataset, without its device -> attribute of a test.
_ARRAYS = {
    "force": "force",
    "energy": "energy",
    "largest_curvature": "largest_curvature",
    "newton_iterations": "iterations",
    "negative_eigenvalues": "negative_eigenvalues",
    "status": "status",
}


def compute(
    parameters: RigParameters, inputs: Mapping[str, xr.Dataset], resources: Resources
) -> xr.Dataset:
    """Dataset of kind rig; values are nan where a device's sheet did not converge."""
    model = MacroModel.from_dataset(inputs["fit"])
    options, sides = RigOptions(size=parameters.size), parameters.sides
    devices: dict[str, dict[str, Any]] = {}
    if parameters.mandrel is not None:
        devices["mandrel"] = _mandrel(model, parameters.mandrel, sides, options)
    if parameters.stage is not None:
        devices["stage"] = _stage(model, parameters.stage, sides, options)
    return build_rig_dataset(
        sides, devices, scalars=model.labels, config=parameters.model_dump(mode="json")
    )


def _mandrel(
    model: MacroModel, disc: MandrelParameters, sides: Sequence[str], options: RigOptions
) -> dict[str, Any]:
    settings = disc.model_dump()
    tests = [simulate_mandrel(model, **settings, side=side, options=options) for side in sides]
    return {**_stacked(tests, _ARRAYS), "angle": settings.pop("angles"), **settings}


def _stage(
    model: MacroModel, strip: StageParameters, sides: Sequence[str], options: RigOptions
) -> dict[str, Any]:
    settings = strip.model_dump()
    tests = [simulate_stage(model, **settings, side=side, options=options) for side in sides]
    arrays = _stacked(tests, {**_ARRAYS, "deflection": "deflection"})
    return {**arrays, "shortening": settings.pop("shortenings"), **settings}


def _stacked(
    tests: Sequence[MandrelTest | StageTest], arrays: Mapping[str, str]
) -> dict[str, np.ndarray]:
    """(n_sides, n) of each variable."""
    return {
        name: np.stack([getattr(test, attribute) for test in tests])
        for name, attribute in arrays.items()
    }

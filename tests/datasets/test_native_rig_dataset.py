"""Datasets of scales on the testing devices: numbers exactly where the solve converged."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from flexscale.datasets.checks import check_dataset
from flexscale.datasets.device_variables import build_rig_dataset
from flexscale.datasets.schema import SCHEMAS
from flexscale.errors import SchemaError
from flexscale.status import SolveStatus
from flexscale.steps.summary import failed_samples


@pytest.fixture(scope="module")
def native_rig() -> xr.Dataset:
    """A strip on the stage; the last of its four samples failed."""
    names = ("force", "energy", "deflection", "min_gap")
    counts = ("newton_iterations", "negative_eigenvalues", "contact_pairs", "outside_range")
    stage = {name: np.ones((2, 2)) for name in names}
    stage |= {name: np.zeros((2, 2), dtype=np.int32) for name in (*counts, "status")}
    stage["status"][1, 1] = SolveStatus.max_iterations
    for name in names:
        stage[name][1, 1] = np.nan
    sizes = {"shortening": [1.0, 10.0], "length": 100.0, "width": 50.0, "direction": 30.0}
    sizes |= {"n_scales": 50, "n_unknowns": 300}
    return build_rig_dataset(
        SCHEMAS["native_rig"],
        ("closing", "opening"),
        {"stage": stage | sizes},
        scalars={"family": "IH20", "pattern": "hexagon"},
        config={},
    )


def test_native_strips_have_numbers_where_they_converged(native_rig) -> None:
    check_dataset(native_rig, "native_rig")
    assert len(failed_samples(native_rig)) == 1
    spoiled = native_rig.copy(deep=True)
    spoiled["stage_force"].values[1, 1] = 1.0
    with pytest.raises(SchemaError, match="converged samples only"):
        check_dataset(spoiled, "native_rig")
    with pytest.raises(SchemaError, match="lacks stage: stage_outside_range"):
        check_dataset(native_rig.drop_vars("stage_outside_range"), "native_rig")
    with (
        xr.set_options(keep_attrs=True),
        pytest.raises(SchemaError, match="strictly increasing"),
    ):
        check_dataset(native_rig.isel(shortening=[1, 0]), "native_rig")

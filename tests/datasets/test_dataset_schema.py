"""Builders, schema checks and the sample accessor."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from flexscale.datasets.checks import check_dataset
from flexscale.datasets.given import require_variables
from flexscale.datasets.kinds.sweep import build_sweep_dataset
from flexscale.datasets.kinds.tangent import build_tangent_dataset
from flexscale.datasets.schema import SCHEMAS
from flexscale.errors import MissingDataError, SchemaError, UnknownNameError
from flexscale.status import SolveStatus
from tests.datasets.dataset_samples import SCALARS, cell, shape, sweep, sweep_arrays


def test_built_datasets_pass_their_own_check() -> None:
    check_dataset(sweep(), "sweep")
    check_dataset(sweep(failed=True), "sweep")
    check_dataset(cell(), "cell")


def test_every_number_has_units_and_a_long_name() -> None:
    for dataset in (sweep(), cell()):
        for name, variable in dataset.variables.items():
            assert variable.attrs["long_name"], name
            assert ("units" in variable.attrs) == (variable.dtype.kind in "fi"), name


def test_failed_samples_hold_no_real_numbers_and_the_caller_keeps_his() -> None:
    arrays = sweep_arrays((2, 1, 2), np.array([0.0, 0.01]))
    arrays["status"][1, 0, 1] = 2
    built = build_sweep_dataset(
        ["closing", "opening"], [0.0], [0.0, 0.01], arrays, scalars=SCALARS, config={}
    )
    sample = built.isel(side=1, direction=0, curvature=1)
    assert np.isnan(sample["moment"])
    assert np.isnan(sample["stretch"]).all()
    assert sample["newton_iterations"] == 3
    assert np.isfinite(arrays["moment"]).all()


def test_without_contact_the_gap_is_missing_and_says_why() -> None:
    built = sweep()
    assert np.isnan(built["min_gap"]).all()
    assert "not modeled" in built["min_gap"].attrs["comment"]
    assert (built["contact_pairs"] == 0).all()


def test_axes_are_sorted_together_with_their_values() -> None:
    curvatures = np.array([0.02, 0.0])
    arrays = sweep_arrays((2, 2, 2), curvatures)
    built = build_sweep_dataset(
        ["opening", "closing"], [90.0, 0.0], curvatures, arrays, scalars=SCALARS, config={}
    )
    check_dataset(built, "sweep")
    found = built["moment"].sel(side="opening", direction=90.0, curvature=0.02)
    assert found == arrays["moment"][0, 0, 0]
    assert built["signed_curvature"].sel(side="opening", curvature=0.02) == -0.02


def _without_units(dataset: xr.Dataset) -> None:
    dataset["moment"].attrs["units"] = "N mm"


def _with_a_hole(dataset: xr.Dataset) -> None:
    dataset["moment"].values[0, 1, 2] = np.nan


def _with_a_filled_failure(dataset: xr.Dataset) -> None:
    dataset["status"].values[0, 1, 2] = 1


def _with_wrong_parts(dataset: xr.Dataset) -> None:
    dataset["energy_density_bending"].values[0, 0, 1] *= 1.001


def _with_energy_at_rest(dataset: xr.Dataset) -> None:
    for name in ("energy_density", "energy_density_bending"):
        dataset[name].values[0, 0, 0] += 1e-6


def _with_an_unknown_status(dataset: xr.Dataset) -> None:
    dataset["status"].values[0, 0, 0] = 9


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (_without_units, "moment of the sweep/1 dataset has units 'N mm', not 'N'"),
        (_with_a_hole, "moment is nan at side closing, direction 45 degree, curvature 0.02 mm-1"),
        (_with_a_filled_failure, "where the status is stalled"),
        (_with_wrong_parts, "parts of energy_density"),
        (_with_energy_at_rest, "at curvature 0"),
        (_with_an_unknown_status, "status"),
    ],
)
def test_a_spoiled_sweep_is_refused(spoil, words: str) -> None:
    dataset = sweep()
    spoil(dataset)
    with pytest.raises(SchemaError, match=words):
        check_dataset(dataset, "sweep")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda ds: ds.transpose("direction", "side", ...), "dimensions"),
        (lambda ds: ds.drop_vars("status"), "lacks the variable 'status'"),
        (lambda ds: ds.assign(extra=1.0), "must not hold the variable 'extra'"),
        (lambda ds: ds.assign(status=ds["status"].astype("int64")), "type int64"),
        (lambda ds: ds.isel(direction=[1, 0, 2]), "strictly increasing"),
        (lambda ds: ds.assign_attrs(flexscale_config=""), "not JSON"),
        (lambda ds: ds.assign_attrs(flexscale_schema="sweep/0"), "sweep/0"),
    ],
)
def test_a_changed_sweep_is_refused(change, words: str) -> None:
    with pytest.raises(SchemaError, match=words):
        check_dataset(change(sweep()), "sweep")


def test_mesh_indices_must_stay_in_range() -> None:
    dataset = cell()
    dataset["triangles"].values[1, 2] = 1
    with pytest.raises(SchemaError, match="triangles points outside the 1 entries of vertex"):
        check_dataset(dataset, "cell")


def test_a_shape_may_lack_whole_states_only() -> None:
    dataset = shape()
    check_dataset(dataset, "shape")
    dataset["displacement"].values[1] = np.nan
    check_dataset(dataset, "shape")
    dataset["displacement"].values[0, 2, 1] = np.nan
    with pytest.raises(SchemaError, match="displacement holds values that are not finite"):
        check_dataset(dataset, "shape")


def test_building_names_the_odd_array() -> None:
    arrays = sweep_arrays((1, 1, 2), np.array([0.0, 0.01]))
    with pytest.raises(SchemaError, match="Did you mean 'moment'"):
        build_sweep_dataset(
            ["closing"], [0.0], [0.0, 0.01], {**arrays, "momnt": 0}, scalars=SCALARS, config={}
        )
    del arrays["moment"]
    with pytest.raises(SchemaError, match="needs 'moment'"):
        build_sweep_dataset(["closing"], [0.0], [0.0, 0.01], arrays, scalars=SCALARS, config={})


def test_tangent_of_a_plate_is_the_same_in_every_direction() -> None:
    plate = np.array([[1.0, 0.3, 0.0], [0.3, 1.0, 0.0], [0.0, 0.0, 0.35]])
    tangent = build_tangent_dataset(plate, plate, [0.0, 30.0, 77.0], scalars=SCALARS, config={})
    check_dataset(tangent, "tangent")
    np.testing.assert_allclose(tangent["stiffness"], 1.0, rtol=1e-14)
    tangent["matrix"].values[0, 1] = 0.4
    with pytest.raises(SchemaError, match="symmetric"):
        check_dataset(tangent, "tangent")


def test_sample_picks_stored_samples_and_refuses_what_lies_between() -> None:
    dataset = sweep()
    sample = dataset.fs.sample("moment", side="closing", direction=45, curvature=0.01)
    assert sample == dataset["moment"].sel(side="closing", direction=45.0, curvature=0.01)
    assert "direction 45 degree (asked 45)" in sample.attrs["sampled"]
    assert "sampled" not in dataset["moment"].attrs
    assert dataset.fs.sample("moment", direction=180.0)["direction"] == 0.0
    assert dataset.fs.sample("moment", direction=-135.0)["direction"] == 45.0
    assert dataset.fs.sample("moment", direction=44.99999)["direction"] == 45.0
    for wanted, near in (
        ({"direction": 30.0}, "nearest are 0 and 45 degree"),
        ({"direction": 46.0}, "nearest are 45 and 90 degree"),
        ({"direction": 135.0}, "no sample at direction 135"),
        ({"curvature": 0.011}, "nearest are 0.01 and 0.02 mm-1"),
        ({"curvature": 0.03}, "no sample at curvature 0.03"),
    ):
        with pytest.raises(MissingDataError, match=near):
            dataset.fs.sample("moment", **wanted)
    with pytest.raises(UnknownNameError, match="Did you mean 'moment'"):
        dataset.fs.sample("momnet")
    with pytest.raises(UnknownNameError, match="Did you mean 'closing'"):
        dataset.fs.sample("moment", side="closed")


def test_an_axis_that_has_a_value_twice_tells_nothing_apart() -> None:
    data = sweep()
    doubled = data.isel(side=[0, 0])
    with pytest.raises(SchemaError, match="side of this dataset has a value twice"):
        require_variables(doubled, ["moment"], "A plot", "sweep")
    require_variables(data, ["moment"], "A plot", "sweep")


def test_no_schema_names_a_variable_twice() -> None:
    for schema in SCHEMAS.values():
        names = [item.name for item in (*schema.coordinates, *schema.variables)]
        assert len(names) == len(set(names)), schema.name


def test_partial_variables_may_miss_where_samples_converged():
    """But never hold a number where the sample did not."""
    kappa = np.array([0.0, 0.01, 0.02])
    arrays = sweep_arrays((2, 3, 3), kappa)
    back = np.full((2, 3, 3), np.nan)
    back[0, 1, 1] = 0.3
    for name in ("energy_density_returning", "moment_returning"):
        arrays[name] = back
    axes = (["closing", "opening"], [0.0, 45.0, 90.0], kappa)
    dataset = build_sweep_dataset(*axes, arrays, scalars=SCALARS, config={})
    check_dataset(dataset, "sweep")
    dataset["status"][0, 1, 1] = SolveStatus.stalled
    for name in sorted(set(dataset.data_vars) - {"moment_returning"}):
        if dataset[name].dims[:3] == dataset["status"].dims and dataset[name].dtype.kind == "f":
            dataset[name][0, 1, 1] = np.nan
    with pytest.raises(SchemaError, match=r"moment_returning is 0\.3 .* stalled"):
        check_dataset(dataset, "sweep")

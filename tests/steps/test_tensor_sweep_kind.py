"""Kind `tensor_sweep`: what its datasets refuse, its block in an experiment, its figure."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

import flexscale as fs
from flexscale.datasets.checks import check_dataset
from flexscale.datasets.kinds.tensor_sweep import (
    build_tensor_sweep_dataset,
    ray_moments,
    unit_tensors,
)
from flexscale.errors import BadInputError, ConfigError, SchemaError
from flexscale.plotting.tensor_sweeps import contact_onsets, secant_ratios
from flexscale.steps.experiment import parse_experiment
from flexscale.steps.plan import build_plan
from flexscale.steps.summary import failed_samples

STIFFNESS = np.array([[5.0, -1.0, 0.3], [-1.0, 4.0, 0.2], [0.3, 0.2, 1.5]])
DIRECTIONS, SHAPES = np.array([0.0, 60.0, 120.0]), np.array([-135.0, -45.0, 0.0, 45.0])
CURVATURES = np.linspace(0.0, 0.02, 11)
ONSET = 0.009


def made(**changes: Any) -> xr.Dataset:
    """A linear sheet, twice as stiff in all directions beyond one curvature, where it closes."""
    unit = unit_tensors(DIRECTIONS[:, None], SHAPES) * [1.0, 1.0, 2.0]
    closes = (SHAPES > -45.0)[:, None]
    beyond = np.maximum(CURVATURES - ONSET, 0.0)
    size = CURVATURES + closes * beyond  # (n_shapes, n_curvatures)
    moment = (unit @ STIFFNESS)[:, :, None] * size[:, :, None]
    energy = (
        0.5
        * np.einsum("dsi,ij,dsj->ds", unit, STIFFNESS, unit)[..., None]
        * (CURVATURES**2 + closes * beyond**2)
    )
    shape = energy.shape
    arrays = {
        "energy_density": energy,
        **{f"moment_{name}": moment[..., k] for k, name in enumerate(("xx", "yy", "xy"))},
        **{f"stretch_{name}": np.ones(shape) for name in ("xx", "yy", "xy")},
        **dict.fromkeys(("min_gap", "contact_force", "residual_norm"), np.zeros(shape)),
        **dict.fromkeys(
            ("newton_iterations", "negative_eigenvalues", "outside_range", "status"),
            np.zeros(shape),
        ),
        "contact_pairs": np.broadcast_to(closes & (beyond > 0.0), shape),
        "symmetry_source": np.broadcast_to(DIRECTIONS[:, None], shape[:2]),
        "tangent": STIFFNESS,
    }
    options = {"in_plane": "free", "scalars": {"family": "IH20", "pattern": "hexagon"}}
    return build_tensor_sweep_dataset(
        (DIRECTIONS, SHAPES, CURVATURES), arrays | changes, config={}, **options
    )


@pytest.fixture(scope="module")
def dataset() -> xr.Dataset:
    return made()


def test_tensors_turn_with_the_direction_and_have_their_principal_curvatures() -> None:
    for shape in SHAPES:
        xx, yy, xy = unit_tensors(30.0, shape)
        found, axes = np.linalg.eigh([[xx, xy], [xy, yy]])
        ends = np.cos(np.radians(shape)), np.sin(np.radians(shape))
        assert found == pytest.approx([min(ends), max(ends)])
        if ends[0] > ends[1] + 1e-9:
            assert abs(axes[:, 1] @ [np.cos(np.pi / 6), np.sin(np.pi / 6)]) == pytest.approx(1.0)


def test_a_dataset_keeps_its_schema(dataset: xr.Dataset) -> None:
    check_dataset(dataset, "tensor_sweep")
    rate = np.gradient(dataset["energy_density"].values, CURVATURES, axis=-1)
    assert ray_moments(dataset)[..., 1:4] == pytest.approx(rate[..., 1:4])
    tensor = [dataset[f"curvature_{name}"].sel(shape=0.0, direction=60.0) for name in ("xx", "xy")]
    assert tensor[0].values == pytest.approx(0.25 * CURVATURES)
    assert tensor[1].values == pytest.approx(np.sqrt(3.0) / 4.0 * CURVATURES)


def _swapped(data: xr.Dataset) -> None:
    xx, yy = data["moment_xx"].values.copy(), data["moment_yy"].values.copy()
    data["moment_xx"].values[:], data["moment_yy"].values[:] = yy, xx


def _one_less(data: xr.Dataset, name: str) -> None:
    data[name].values[1, 1, 1] -= 1.0


SPOILT = {
    "at another rate": _swapped,
    "below that at rest": lambda data: _one_less(data, "energy_density"),
    "0, not 0": lambda data: data["energy_density"].values.__iadd__(1.0),
    "must be symmetric": lambda data: data["tangent"].values.__setitem__((0, 1), 9.0),
    "numbers belong to converged": lambda data: data["status"].values.__setitem__((0, 0, 3), 1),
    "is free or held, not 'fixed'": lambda data: data.__setitem__(
        "in_plane", data["in_plane"].copy(data=np.array("fixed"))
    ),
}


@pytest.mark.parametrize("said", SPOILT)
def test_values_that_cannot_be_are_refused(dataset: xr.Dataset, said: str) -> None:
    wrong = dataset.copy(deep=True)
    SPOILT[said](wrong)
    with pytest.raises(SchemaError, match=said):
        check_dataset(wrong, "tensor_sweep")


def test_axes_and_responses_that_cannot_be_are_refused(dataset: xr.Dataset) -> None:
    for wrong, said in (
        (dataset.assign_coords(direction=dataset["direction"] + 90.0), r"\[0, 180\)"),
        (dataset.assign_coords(shape=dataset["shape"] + 1.0), r"\[-135, 45\]"),
        (dataset.drop_vars("stretch_xy"), "free in its plane needs stretch_xy"),
    ):
        for name in ("direction", "shape"):
            wrong[name].attrs = dataset[name].attrs
        with pytest.raises(SchemaError, match=said):
            check_dataset(wrong, "tensor_sweep")


def test_a_jump_is_data_and_not_refused() -> None:
    """Where a sheet snaps, the energy falls."""
    energy = made()["energy_density"].values.copy()
    energy[0, 1, 6:] *= 0.9
    check_dataset(made(energy_density=energy), "tensor_sweep")


def test_failed_samples_of_rays_that_were_solved_are_told() -> None:
    status = np.zeros((3, 4, 11))
    status[:, 1, 10] = 1
    source = np.broadcast_to([[0.0], [0.0], [120.0]], (3, 4))
    told = failed_samples(made(status=status, symmetry_source=source))
    assert [line.split(", ")[0] for line in told] == [
        "stalled: direction 0 degree",
        "stalled: direction 120 degree",
    ]
    assert "shape -45 degree" in told[0]


def test_an_experiment_plans_it_on_joints() -> None:
    content = {"patterns": {"hexagon": {"named": "hexagon"}}, "tensor_sweep": {}}
    jobs = {job.step: job for job in build_plan(parse_experiment(content, "file"))}
    assert set(jobs) == {"joint", "tensor_sweep"}
    job = jobs["tensor_sweep"]
    assert job.inputs == (jobs["joint"].id,)
    # Directions of 0, 10, 20 and 30 degree, nineteen shapes that have one, and two that have none.
    assert job.n_samples == (4 * 19 + 2) * 31


@pytest.mark.parametrize(
    ("block", "said"),
    [
        ({"shapes": [0, 60]}, r"shapes lie in \[-135, 45\] degree"),
        ({"shapes": [0, -45]}, "must increase"),
        ({"curvatures": [0.001]}, "must be 0"),
        ({"curvatures": [0, 0.3]}, "stay below 0.25"),
        ({"in_plane": "fixed"}, "'free' or 'held'"),
    ],
)
def test_blocks_that_cannot_be_are_refused(block: dict[str, Any], said: str) -> None:
    content = {"patterns": {"hexagon": {"named": "hexagon"}}, "tensor_sweep": block}
    with pytest.raises(BadInputError, match=said):
        build_plan(parse_experiment(content, "file"))


def test_other_native_models_are_refused() -> None:
    content = {"patterns": {"hexagon": {"named": "hexagon"}}, "tensor_sweep": {}}
    with pytest.raises(ConfigError, match="Tensor sweeps are of scales on joints"):
        parse_experiment(content | {"native": "shell"}, "file")


def test_ratios_and_onsets_are_those_of_the_law(dataset: xr.Dataset) -> None:
    ratio = secant_ratios(dataset)
    assert ratio[:, :2, 1:] == pytest.approx(1.0)
    assert ratio[:, 2:, -1] == pytest.approx(1.0 + (0.011 / 0.02) ** 2)
    onset = contact_onsets(dataset)
    assert np.isnan(onset[:, :2]).all()
    assert onset[:, 2:] == pytest.approx(0.009)


def test_its_figure_tells_what_is_missing(dataset: xr.Dataset) -> None:
    figure = fs.plot.tensor_sweep(dataset, 0.012)
    left, right = figure.axes[:2]
    assert "at 0.012 mm⁻¹" in left.get_title()
    assert "first contact" in right.get_title()
    (cells,) = left.collections
    assert cells.get_array().shape == (4, 3)
    assert cells.get_array().max() == pytest.approx(1.0 + 0.25**2)
    said = " ".join(text.get_text() for text in figure.texts)
    assert "no contact met up to 0.02" in str([figure._supxlabel.get_text(), said])
    assert "saddle\n-45°" in [label.get_text() for label in left.get_yticklabels()]
    with pytest.raises(BadInputError, match=r"no sample at curvature 0\.05"):
        fs.plot.tensor_sweep(dataset, 0.05)


def test_one_ray_without_contact_is_drawn_too(dataset: xr.Dataset) -> None:
    one = dataset.isel(direction=[0], shape=[1]).drop_vars("contact_pairs")
    figure = fs.plot.tensor_sweep(one)
    assert not figure.axes[1].axison

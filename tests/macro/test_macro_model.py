"""The macro model on the flat cell's stiffness: what it takes from where, tensors, refusals."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import flexscale as fs
from flexscale.datasets.checks import check_dataset
from flexscale.datasets.kinds.tangent import build_tangent_dataset
from flexscale.errors import BadInputError, SchemaError, UnitRangeError, UnknownNameError
from flexscale.homogenize.tangent import TangentStiffness
from flexscale.macro.biaxial import default_w_biaxial
from flexscale.macro.rest_stiffness import tangent_of_sweep
from flexscale.macro.tensor_law import N_TABLE
from tests.macro.fit_samples import a_of, b_of, fit_law, kappa_0_of, law_sweep, no_contact, tangent

BETWEEN = np.arange(3.7, 180.0, 7.0)
SOFTENING = 6.0


@pytest.fixture(scope="module")
def model() -> fs.MacroModel:
    sweep = law_sweep(opening=lambda d: 0.8 * kappa_0_of(d), softening=SOFTENING, touches=True)
    return fs.fit(sweep, tangent())


def uniaxial(curvature: float, direction: float) -> np.ndarray:
    n = np.array([np.cos(np.deg2rad(direction)), np.sin(np.deg2rad(direction))])
    return curvature * np.outer(n, n)


def test_a_is_that_of_the_flat_cell_and_the_rest_is_fitted(model: fs.MacroModel) -> None:
    law = model.parameters(BETWEEN)
    np.testing.assert_allclose(law.a, a_of(BETWEEN), rtol=1e-12)
    np.testing.assert_allclose(law.b, b_of(BETWEEN), rtol=1e-4)
    np.testing.assert_allclose(law.kappa_0, kappa_0_of(BETWEEN), rtol=1e-4)
    assert law.softening == pytest.approx(SOFTENING, rel=1e-4)
    assert model.n_parameters == 7 + 2 * 14


def test_softening_is_not_confused_with_contact() -> None:
    """No contact and no softening give none; contact alone gives none either."""
    for sweep in (law_sweep(closing=no_contact), law_sweep(touches=True)):
        assert fs.fit(sweep, tangent()).polar.softening == pytest.approx(0.0, abs=1e-6)


def test_tensor_in_one_direction_is_the_uniaxial_law(model: fs.MacroModel) -> None:
    for side, sign in (("closing", 1.0), ("opening", -1.0)):
        for direction in BETWEEN:
            for kappa in (0.004, 0.012, 0.03):
                tensor = uniaxial(sign * kappa, direction)
                energy = model.energy(kappa, direction, side)
                assert model.tensor_energy(tensor) == pytest.approx(energy, rel=1e-12)
                along = np.sum(model.tensor_moment(tensor) * uniaxial(1.0, direction))
                expected = sign * model.moment(kappa, direction, side)
                assert along == pytest.approx(expected, rel=1e-12)


def test_tensor_moment_is_the_derivative_of_the_energy(model: fs.MacroModel) -> None:
    rng, step = np.random.default_rng(3), 1e-7
    tensors = 0.01 * rng.standard_normal((2, 5, 2, 2))
    tensors += np.swapaxes(tensors, -1, -2)
    rate = rng.standard_normal((2, 2))
    rate += rate.T
    up, down = (model.tensor_energy(tensors + sign * step * rate) for sign in (1.0, -1.0))
    moment = model.tensor_moment(tensors)
    assert up.shape == (2, 5)
    assert moment.shape == tensors.shape
    along = np.sum(moment * rate, axis=(-2, -1))
    np.testing.assert_allclose((up - down) / (2.0 * step), along, rtol=1e-5)


@pytest.mark.parametrize("variant", ["tangent", "paper"])
def test_dataset_holds_the_sheet(variant: str) -> None:
    found = fs.fit(law_sweep(softening=SOFTENING), tangent(), variant=variant, w_biaxial=700.0)  # type: ignore[arg-type]
    dataset = found.to_dataset()
    check_dataset(dataset, "fit")
    again = fs.MacroModel.from_dataset(dataset)
    assert repr(again) == repr(found)
    assert (again.variant, again.w_biaxial) == (variant, 700.0)
    np.testing.assert_array_equal(again.law_parameters(), found.law_parameters())
    assert len(found.law_parameters()) == N_TABLE
    xr.testing.assert_identical(again.to_dataset(), dataset)


def test_check_refuses_a_tangent_that_is_not_that_of_a(model: fs.MacroModel) -> None:
    dataset = model.to_dataset()
    dataset["tangent"].values[0, 0] *= 1.01
    with pytest.raises(SchemaError, match="does not follow from the tangent"):
        check_dataset(dataset, "fit")
    dataset["in_plane"].values[:] = np.nan
    with pytest.raises(SchemaError, match="in_plane must be 3 by 3 and finite"):
        check_dataset(dataset.assign(tangent=model.to_dataset()["tangent"]), "fit")


def test_tangent_may_be_a_dataset(model: fs.MacroModel) -> None:
    known = tangent()
    labels = {"family": "IH20", "pattern": "hexagon"}
    dataset = build_tangent_dataset(
        known.matrix, known.in_plane, [0.0, 45.0], scalars=labels, config={}
    )
    sweep = law_sweep(softening=SOFTENING)
    same = [fs.fit(sweep, given).law_parameters() for given in (known, dataset)]
    np.testing.assert_array_equal(*same)


def test_tangent_comes_from_the_recipe_of_a_sweep() -> None:
    coarse = fs.MeshOptions(scale_size=10, scale_layers=1, scale_order=1, scale_strips=0)
    pattern = fs.Pattern(fs.Tiling("IH76"))
    config = {
        "pattern": pattern.to_config(),
        "native": "shell",
        "mesh": coarse.to_config(),
        "substrate": fs.SubstrateOptions().to_config(),
        "scales": fs.ScaleOptions().to_config(),
    }
    found = tangent_of_sweep(law_sweep(config=config))
    assert found is not None
    known = fs.tangent_stiffness(pattern, model=fs.NativeModel("shell", mesh=coarse))
    np.testing.assert_allclose(found.matrix, known.matrix, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(found.in_plane, known.in_plane, rtol=1e-12, atol=1e-12)
    assert tangent_of_sweep(law_sweep()) is None


def test_one_sided_sweep_marks_the_model() -> None:
    found = fs.fit(law_sweep(opening=None), tangent())
    assert found.sides == ("closing",)
    assert "one-sided: opening was not sampled" in repr(found)
    opened = found.tensor_energy(uniaxial(-0.03, 20.0))
    assert opened == pytest.approx(0.5 * a_of(np.array(20.0)) * 0.03**2, rel=1e-9)
    with pytest.raises(UnknownNameError, match="no side of the model 'opening'"):
        found.moment(0.01, 0.0, "opening")


def test_refusals_of_tangents() -> None:
    sweep, known = law_sweep(), tangent()
    with pytest.raises(BadInputError, match=r"does not say which pattern.*variant='paper'"):
        fs.fit(sweep)
    with pytest.raises(UnknownNameError, match="Did you mean 'paper'"):
        fs.fit(sweep, known, variant="papr")  # type: ignore[arg-type]
    other = TangentStiffness(3.0 * known.matrix, known.in_plane)
    with pytest.raises(BadInputError, match=r"0\.333 times those of the tangent"):
        fs.fit(sweep, other)
    unstable = TangentStiffness(known.matrix, known.in_plane - 200.0 * np.eye(3))
    with pytest.raises(BadInputError, match="in-plane stiffness of the flat cell is not positive"):
        fs.fit(sweep, unstable)
    with pytest.raises(SchemaError, match="has no matrix, in_plane"):
        fs.fit(sweep, sweep)
    with pytest.raises(UnitRangeError, match="w_biaxial is -1 N mm3"):
        fs.fit(sweep, known, w_biaxial=-1.0)


def test_refusals_of_tensors(model: fs.MacroModel) -> None:
    with pytest.raises(UnitRangeError, match="symmetric 2 by 2 matrix"):
        model.tensor_energy([0.01, 0.0, 0.01])
    with pytest.raises(UnitRangeError, match="are symmetric"):
        model.tensor_moment([[0.01, 0.002], [0.001, 0.0]])
    with pytest.raises(UnitRangeError, match="finite"):
        model.tensor_energy([[np.nan, 0.0], [0.0, 0.0]])


def test_a_model_without_a_cell_bends_but_is_no_sheet() -> None:
    found = fit_law(law_sweep())
    assert found.tensor_energy(uniaxial(0.01, 30.0)) > 0.0
    assert found.w_biaxial == 0.0
    assert "in plane not known" in repr(found)
    with pytest.raises(BadInputError, match=r"in-plane stiffness.*fs\.tangent_stiffness"):
        found.law_parameters()


def test_default_w_biaxial_is_that_of_a_round_isotropic_tile() -> None:
    """Stresses of the docstring: they balance, have a free edge, and this mean energy."""
    young, nu, radius, gaussian = 12.0, 0.4, 5.0, 1e-4  # Young's modulus times thickness, N mm-1
    plane = young / (1.0 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])
    w = default_w_biaxial(plane, np.pi * radius**2)
    r = np.linspace(0.0, radius, 20001)
    radial = young * gaussian * (radius**2 - r**2) / 16.0
    hoop = young * gaussian * (radius**2 - 3.0 * r**2) / 16.0
    np.testing.assert_allclose(np.gradient(r * radial, r)[1:-1], hoop[1:-1], atol=1e-9)
    density = (radial**2 + hoop**2 - 2.0 * nu * radial * hoop) / (2.0 * young)
    mean = np.trapezoid(2.0 * r * density, r) / radius**2
    assert 0.5 * w * gaussian**2 == pytest.approx(mean, rel=1e-6)

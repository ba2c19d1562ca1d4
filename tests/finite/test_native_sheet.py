"""Sheets of scales on joints between end strips: energies, convergence to the cell, refusals."""

from __future__ import annotations

import numpy as np
import pytest

import flexscale as fs
from flexscale.embedding.bends import Bend
from flexscale.errors import BadInputError, ConfigError, PatternError
from flexscale.finite.native_sheet import NativeSheet, bend_native_sheet
from flexscale.finite.sheet_scales import find_sheet_scales, require_moderate_scales
from flexscale.patterns.laid import lay_pattern, rectangle
from flexscale.solve.newton import solve_equilibrium
from tests.derivatives import directional_difference, relative_error

CHEVRON = fs.named_pattern("chevron")


def small(ends: str = "arc") -> NativeSheet:
    return NativeSheet(CHEVRON, 50.0, 25.0, 20.0, ends=ends)


def test_gradient_and_hessian_are_exact_in_contact() -> None:
    sheet = small()
    samples = list(bend_native_sheet(sheet, (0.01, 0.02)))
    z, bend = samples[-1]["state"], Bend(0.02, 0.0)
    assert samples[-1]["contact_pairs"] > 0
    bent = sheet.bent(bend)
    state = bent.evaluate(z)
    way = np.zeros_like(z)
    way[sheet.active] = np.random.default_rng(0).normal(size=len(sheet.active))

    def gradient(s: float) -> np.ndarray:
        return bent.evaluate(z + s * way).gradient

    values = bent.hessian_values(state)
    product = np.zeros(len(sheet.active))
    np.add.at(product, sheet.rows, values * way[sheet.active][sheet.columns])
    beside = sheet.rows != sheet.columns
    np.add.at(
        product, sheet.columns[beside], values[beside] * way[sheet.active][sheet.rows[beside]]
    )
    assert relative_error(product, directional_difference(gradient, 1e-8)) < 1e-5
    slope = directional_difference(lambda s: bent.evaluate(z + s * way).energy, 1e-8)
    assert abs(state.gradient @ way[sheet.active] - slope) < 1e-5 * np.linalg.norm(product)


@pytest.mark.parametrize("ends", ["arc", "turned"])
def test_moment_is_the_derivative_of_the_energy(ends: str) -> None:
    """Before and in contact, with one barrier."""
    sheet = small(ends)
    for sample in bend_native_sheet(sheet, (0.012, 0.019)):
        kappa = sample["curvature"]
        if sample["contact_pairs"]:
            assert sheet.contact is not None
            sheet.contact.stiffness = sample["barrier_stiffness"]

        def energy(s: float, kappa: float = kappa, x: dict = sample) -> float:
            z = x["state"] + s * x["rate"]
            bent = sheet.bent(Bend(kappa + s, 0.0))
            return solve_equilibrium(bent, z, fs.SolverOptions()).evaluation.energy / sheet.area

        assert directional_difference(energy, 1e-6) == pytest.approx(sample["moment"], rel=1e-5)


def test_wide_sheets_of_squares_bend_as_the_cell_does() -> None:
    """Of seven rows of whole squares, six joints turn; joints end at free sides as at corners."""
    square, kappa = fs.named_pattern("square"), 0.004
    cell = fs.sweep(square, [0.0], [0.0, kappa * 70.0 / 60.0], ("closing",))
    dense = float(cell.energy_density[0, 0, 1]) * 60.0
    errors = []
    for rows in (2, 6, 18):
        sheet = NativeSheet(square, 70.0, 10.0 * rows, offset=(0.0, 5.0 * (rows % 2 == 0)))
        assert all(sheet.sheet.laid.whole)
        (sample,) = bend_native_sheet(sheet, (kappa,))
        errors.append(sample["energy_density"] * 70.0 / dense - 1.0)
    assert errors == pytest.approx([0.0] * 3, abs=0.005)


def test_a_sheet_does_not_depend_on_where_its_scales_are_counted_from() -> None:
    moved = CHEVRON.lattice[0] + CHEVRON.lattice[1]
    densities = []
    for offset in ((1.0, 2.0), tuple(np.array([1.0, 2.0]) + moved)):
        sheet = NativeSheet(CHEVRON, 50.0, 25.0, offset=offset)
        densities.append([s["energy_density"] for s in bend_native_sheet(sheet, (0.01, 0.02))])
    assert densities[1] == pytest.approx(densities[0], rel=1e-9)


def test_energies_of_scales_add_up_to_that_of_the_sheet() -> None:
    sheet = small()
    (sample,) = bend_native_sheet(sheet, (0.02,))
    bend = Bend(0.02, 0.0)
    state = sheet.bent(bend).evaluate(sample["state"])
    found = sheet.scales_at(state, bend)
    assert found.energy.sum() == pytest.approx(state.energy, rel=1e-12)
    assert (found.contact_force >= 0.0).all()
    assert (found.contact_force > 0.0).any()
    assert np.allclose(np.linalg.det(found.turns), 1.0)


def test_a_dataset_holds_what_was_computed() -> None:
    data = fs.simulate_native_sheet(CHEVRON, 50.0, 25.0, curvatures=[0.0, 0.01])
    assert dict(data.sizes) == {"side": 2, "curvature": 2}
    one = fs.simulate_native_sheet(CHEVRON, 50.0, 25.0, curvatures=[0.0, 0.01], side="opening")
    assert one.energy_density.dims == ("curvature",)
    assert one.energy_density.values == pytest.approx(
        data.energy_density.sel(side="opening").values
    )
    assert float(data.energy_density.sel(side="closing")[1]) > 0.0


def test_deformed_scales_are_written(tmp_path) -> None:
    shape = fs.deform_native_sheet(CHEVRON, 50.0, 25.0, curvature=0.015)
    for name in ("scales.obj", "scales.vtu"):
        shape.write(tmp_path / name)
        assert (tmp_path / name).stat().st_size > 1000
    # Prisms keep their volume wherever they are.
    corners = shape.vertices[shape.triangles]
    volume = np.einsum("nc,nc->n", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0
    of_one = np.bincount(shape.triangle_scale, volume)
    largest = CHEVRON.scale_height * 100.0
    assert (of_one > 0.0).all()
    assert of_one.max() < largest
    with pytest.raises(BadInputError, match=r"must end in \.obj or \.vtu"):
        shape.write(tmp_path / "scales.stl")


def test_what_cannot_be_is_refused() -> None:
    with pytest.raises(BadInputError, match="runs into its own end"):
        fs.simulate_native_sheet(CHEVRON, 50.0, 25.0, curvatures=[0.2])
    with pytest.raises(ConfigError, match="native: joints"):
        fs.simulate_native_sheet(CHEVRON, 50.0, 25.0, curvatures=[0.01], model="shell")
    with pytest.raises(PatternError, match="slivers"):
        NativeSheet(CHEVRON, 2.0, 2.0)
    with pytest.raises(PatternError, match="between those that its ends hold"):
        NativeSheet(CHEVRON, 12.0, 25.0)
    with pytest.raises(BadInputError, match=r"GB of memory"):
        require_moderate_scales(CHEVRON, 1e12)


def test_two_scales_of_one_body_have_no_joint() -> None:
    laid = lay_pattern(fs.named_pattern("square"), rectangle(40.0, 20.0), offset=(5.0, 5.0))
    assert len(laid.tiles) == 8
    near = np.array([k for k, tile in enumerate(laid.tiles) if tile[:, 0].max() < 11.0])
    apart = find_sheet_scales(laid, [])
    joined = find_sheet_scales(laid, [(near, np.array([5.0, 10.0]))])
    assert len(apart.joints) == 10
    # The joint between both near ones is gone, and those to their neighbors are of one pair each.
    assert len(joined.joints) == 9
    assert joined.scales.n_scales == 7
    assert joined.held_together()

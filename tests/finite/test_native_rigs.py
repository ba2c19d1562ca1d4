"""Scales on joints on the testing devices: work is energy, symmetry, a closed form, refusals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import flexscale as fs
from flexscale.errors import BadInputError, PatternError, UnitRangeError
from flexscale.finite.driven_sheet import Driven, DrivenSheet, follow_loads
from flexscale.finite.native_disc import NativeDisc, symmetry_center
from flexscale.finite.native_stage import NativeStage
from flexscale.solve.newton import solve_equilibrium
from tests.derivatives import directional_difference, relative_error

HEXAGON, SQUARE = fs.named_pattern("hexagon"), fs.named_pattern("square")


def energy_near(sheet: DrivenSheet, sample: dict[str, Any], change: float) -> float:
    """N mm, of the equilibrium at a load that differs from a sample's, with the same barrier."""
    if sample["contact_pairs"]:
        assert sheet.contact is not None
        sheet.contact.stiffness = sample["barrier_stiffness"]
    z = sheet.moved(sample["state"] + change * sample["rate"], sample["load"] + change)
    return float(solve_equilibrium(Driven(sheet), z, fs.SolverOptions()).evaluation.energy)


def test_force_is_the_derivative_of_the_energy_on_the_stage() -> None:
    """Closing, before and in contact: the machine's work is the energy that the strip holds."""
    stage = NativeStage(HEXAGON, 100.0, 30.0)
    start = stage.clear_arc(0.5, 1.0)
    for sample in follow_loads(stage, (0.5, 3.0), fs.SolverOptions(), start=start):
        slope = directional_difference(lambda s, x=sample: energy_near(stage, x, s), 1e-4)
        assert slope == pytest.approx(sample["force"], rel=1e-5)
    assert sample["contact_pairs"] > 0


def test_a_strip_of_squares_buckles_at_eulers_load() -> None:
    """Rigid links of 10 mm on hinges of stiffness k buckle at 4 k / 10 mm sin^2(pi / 2 n).

    Joints turn about an axis above the hinges: what that adds to one side it takes from the other.
    """
    n, width = 8, 40.0
    stage = NativeStage(SQUARE, 10.0 * n, width, offset=(5.0, 5.0))
    assert all(stage.sheet.laid.whole)
    forces = []
    for sign in (1.0, -1.0):
        start = stage.arc(0.05, sign)
        (sample,) = follow_loads(stage, (0.05,), fs.SolverOptions(), start=start)
        forces.append(sample["force"])
    hinge = fs.tangent_stiffness(SQUARE).stiffness(0.0) * width / 10.0
    euler = 4.0 * hinge / 10.0 * np.sin(0.5 * np.pi / n) ** 2
    assert np.mean(forces) == pytest.approx(euler, rel=0.005)


def test_force_is_the_derivative_of_the_energy_on_the_mandrel() -> None:
    disc = NativeDisc(HEXAGON, 40.0, 8.0)
    disc.probe(10.0, 1.0)
    (sample,) = follow_loads(disc, (4.0,), fs.SolverOptions())
    slope = directional_difference(lambda s: energy_near(disc, sample, s), 1e-3)
    assert slope == pytest.approx(sample["force"], rel=1e-6)


def test_a_disc_has_the_symmetry_of_its_pattern() -> None:
    disc = NativeDisc(HEXAGON, 40.0, 8.0)
    assert disc.rotation_order == 6
    forces = []
    for angle in (15.0, 45.0, 75.0, 135.0, 195.0):
        disc.probe(angle, -1.0)
        (sample,) = follow_loads(disc, (3.0,), fs.SolverOptions())
        forces.append(sample["force"])
    # Turned by 60 degree, and mirrored at 30.
    assert forces == pytest.approx([forces[0]] * len(forces), rel=1e-8)


def test_moving_the_anchor_of_the_scale_that_is_pushed_changes_nothing_else() -> None:
    disc = NativeDisc(HEXAGON, 40.0, 8.0)
    disc.probe(0.0, 1.0)
    (first,) = follow_loads(disc, (2.0,), fs.SolverOptions())
    for angle in (50.0, 200.0, 0.0):
        disc.probe(angle, 1.0)
    (again,) = follow_loads(disc, (2.0,), fs.SolverOptions())
    assert again["force"] == pytest.approx(first["force"], rel=1e-9)
    assert again["energy"] == pytest.approx(first["energy"], rel=1e-9)


def test_hessian_of_a_driven_sheet_is_exact() -> None:
    stage = NativeStage(HEXAGON, 50.0, 25.0)
    z, driven = stage.arc(1.0, -1.0), Driven(stage)
    way = np.zeros_like(z)
    way[stage.active] = np.random.default_rng(0).normal(size=len(stage.active))
    way[stage.driven] = 0.0
    state = driven.evaluate(z)
    values, part = driven.hessian_values(state), way[stage.active]
    product = np.zeros(len(part))
    np.add.at(product, stage.rows, values * part[stage.columns])
    beside = stage.rows != stage.columns
    np.add.at(product, stage.columns[beside], values[beside] * part[stage.rows[beside]])
    slope = directional_difference(lambda s: driven.evaluate(z + s * way).gradient, 1e-5)
    assert relative_error(product, slope) < 1e-7


@pytest.mark.parametrize(
    ("name", "order"), [("hexagon", 6), ("square", 4), ("threefold", 3), ("brick", 2)]
)
def test_discs_are_centered_on_turns_of_the_highest_order(name: str, order: int) -> None:
    pattern = fs.named_pattern(name)
    center, found = symmetry_center(pattern)
    assert found == order
    turn = np.radians(360.0 / order)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    corner = rotation @ (pattern.tiles[0][0] - center) + center
    shifts = np.concatenate(pattern.tiles) - corner
    steps = shifts @ np.linalg.inv(pattern.lattice)
    assert np.abs(steps - np.rint(steps)).max(axis=1).min() < 1e-6


def test_datasets_of_both_devices() -> None:
    stage = fs.simulate_native_stage(HEXAGON, length=60.0, width=30.0, shortenings=[1.0, 2.0])
    assert stage.stage_force.dims == ("side", "shortening")
    assert (stage.stage_status == 0).all()
    told = []
    angles = [0.0, 60.0, 90.0]
    disc = fs.simulate_native_mandrel(
        HEXAGON, radius=40.0, hub=8.0, indentation=3.0, angles=angles, on_sample=told.append
    )
    force = disc.mandrel_force.values
    assert force[:, 0] == pytest.approx(force[:, 1], rel=1e-12)  # one of them is solved
    assert abs(force[0, 2] / force[0, 0] - 1.0) > 1e-3
    assert [event.done for event in told] == [1, 2, 3, 4, 5, 6]
    assert {(event.device, event.unit) for event in told} == {("mandrel", "degree")}


def test_what_cannot_be_is_refused() -> None:
    with pytest.raises(BadInputError, match="leaves nothing"):
        NativeDisc(HEXAGON, 20.0, 30.0)
    with pytest.raises(PatternError, match="holds every scale"):
        NativeDisc(HEXAGON, 12.0, 11.0)
    with pytest.raises(UnitRangeError, match="below 360"):
        fs.simulate_native_mandrel(HEXAGON, radius=40.0, angles=[0.0, 400.0])
    with pytest.raises(BadInputError, match="more than a strip"):
        fs.simulate_native_stage(HEXAGON, length=50.0, width=25.0, shortenings=[60.0])

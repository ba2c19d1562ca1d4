"""The section of a joint: derivatives, symmetries, slide, and the linear joint's stiffness."""

from __future__ import annotations

import numpy as np
import pytest

from flexscale.joints.pose import place, place_bends, place_rates
from flexscale.joints.section import Section
from flexscale.joints.section_mesh import Grading, SectionShape, build_section_mesh
from flexscale.joints.states import SectionState, follow, rest_state
from flexscale.patterns.material import NeoHookean
from tests.derivatives import directional_difference, relative_error

COARSE = Grading(0.1, 2.0, 0.7)
RATIO = 0.48
PETG = NeoHookean(2020.0 / 26.0, 0.35)


def section(*, elastic: bool = False, slides: bool = True) -> Section:
    shape = SectionShape(1.0, 3.0, 5.0 if elastic else None)
    mesh = build_section_mesh(shape, COARSE)
    return Section(mesh, RATIO, PETG if elastic else None, slides=slides)


def reached(found: Section, pose: np.ndarray, n: int = 6) -> SectionState:
    states = list(follow(found, rest_state(found), np.outer(np.arange(1, n + 1) / n, pose)))
    assert len(states) == n
    return states[-1]


def test_rates_and_bends_of_places_agree_with_differences() -> None:
    rng = np.random.default_rng(1)
    rest, pose = rng.normal(size=(5, 2)), np.array([0.3, -0.2, 0.5, 0.3])
    for side in (-1.0, 1.0):
        for k in range(4):
            unit = np.eye(4)[k]
            rate = directional_difference(
                lambda step, unit=unit, side=side: place(rest, side, pose + step * unit), 1e-3
            )
            assert np.allclose(place_rates(rest, side, pose)[:, :, k], rate, atol=1e-10)
        bend = directional_difference(
            lambda step, side=side: place_rates(rest, side, pose + step * np.eye(4)[3])[:, :, 3],
            1e-3,
        )
        assert np.allclose(place_bends(rest, side, pose), bend, atol=1e-10)


def test_tops_approach_one_another_as_the_joint_closes() -> None:
    tops = np.array([[-0.5, 10.0]]), np.array([[0.5, 10.0]])
    pose = np.array([0.0, 0.0, 0.0, 0.05])
    a, b = place(tops[0], -1.0, pose)[0], place(tops[1], 1.0, pose)[0]
    assert 0.0 < b[0] - a[0] < 1.0
    assert b[0] - a[0] == pytest.approx(1.0 - 10.5 * 0.05, abs=1e-3)
    opened = place(tops[1], 1.0, np.array([0.2, 0.3, 0.4, 0.0]))
    assert opened[0] == pytest.approx([0.6, 0.2, 10.15])


@pytest.mark.parametrize("elastic", [False, True])
def test_gradient_and_hessian_of_a_section_agree_with_differences(elastic: bool) -> None:
    rng = np.random.default_rng(2)
    found = section(elastic=elastic)
    pose = np.array([0.2, 0.1, 0.2, 0.1])
    z = found.put(found.rest(), 0.1 * pose)
    z[found.active] += 1e-3 * rng.normal(size=len(found.active))
    along = np.zeros_like(z)
    along[found.active] = rng.normal(size=len(found.active))
    state = found.evaluate(z)
    energy = directional_difference(lambda step: found.evaluate(z + step * along).energy, 1e-5)
    assert relative_error(state.full_gradient @ along, energy) < 1e-6
    gradient = directional_difference(lambda step: found.evaluate(z + step * along).gradient, 1e-5)
    values = found.hessian_values(state)
    assert relative_error(found.multiply(values, along[found.active]), gradient) < 1e-6


@pytest.mark.parametrize("elastic", [False, True])
def test_forces_and_tangent_are_derivatives_of_the_least_energy(elastic: bool) -> None:
    found = section(elastic=elastic)
    pose = np.array([0.3, 0.2, 0.3, 0.12])
    state, step = reached(found, pose), 2e-3
    for k in range(4):
        unit = np.eye(4)[k]

        def at(share: float, unit: np.ndarray = unit) -> SectionState:
            return next(iter(follow(found, state, [pose + share * unit])))

        energy = directional_difference(lambda share: at(share).energy, step)
        assert state.forces[k] == pytest.approx(energy, rel=1e-6, abs=1e-8)
        forces = directional_difference(lambda share: at(share).forces, step)
        assert np.allclose(state.tangent[k], forces, rtol=1e-6, atol=1e-6)


def test_rest_has_no_energy_and_no_forces() -> None:
    for elastic in (False, True):
        rest = rest_state(section(elastic=elastic))
        assert rest.energy == pytest.approx(0.0, abs=1e-25)
        assert np.abs(rest.forces).max() < 1e-10
        assert np.linalg.eigvalsh(rest.tangent).min() > 0.0


def test_energy_is_even_in_shift_and_in_slide() -> None:
    found = section()
    pose = np.array([0.2, 0.3, 0.4, 0.1])
    energies = [
        reached(found, pose * [1.0, shift, slide, 1.0]).energy
        for shift in (-1.0, 1.0)
        for slide in (-1.0, 1.0)
    ]
    assert np.ptp(energies) < 1e-9 * energies[0]


@pytest.mark.parametrize("elastic", [False, True])
def test_slide_adds_half_a_constant_stiffness_times_its_square(elastic: bool) -> None:
    found = section(elastic=elastic)
    stiffness = rest_state(found).tangent[2, 2]
    plane = reached(found, np.array([0.4, 0.2, 0.0, 0.1]))
    slid = reached(found, np.array([0.4, 0.2, 0.7, 0.1]))
    assert slid.energy - plane.energy == pytest.approx(0.5 * stiffness * 0.49, rel=1e-9)
    assert slid.forces == pytest.approx(plane.forces + 0.7 * stiffness * np.eye(4)[2], abs=1e-8)
    in_plane = section(elastic=elastic, slides=False)
    same = reached(in_plane, np.array([0.4, 0.2, 0.0, 0.1]))
    assert same.energy == pytest.approx(plane.energy, rel=1e-9)


def test_a_turn_of_the_whole_section_costs_nothing() -> None:
    found = section(elastic=True)
    z = found.rest().reshape(-1, 3)
    turned = z.copy()
    turned[:, 0] = np.cos(0.7) * z[:, 0] - np.sin(0.7) * z[:, 2]
    turned[:, 2] = np.sin(0.7) * z[:, 0] + np.cos(0.7) * z[:, 2]
    state = found.evaluate(turned.ravel())
    assert state.energy == pytest.approx(0.0, abs=1e-20)
    assert np.abs(state.full_gradient).max() < 1e-10

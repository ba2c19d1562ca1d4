"""Wedges of a solid substrate: their functions, and energies of fields that they hold."""

from __future__ import annotations

import numpy as np
import pytest

from flexscale.mechanics.neo_hookean_wedges import NeoHookeanWedges, wedge_shape_gradients
from flexscale.simplices import TRIANGLE_EDGES
from tests.derivatives import full_hessian

MU, LAMBDA = 8.78, 210.8
CORNERS = np.array([[[0.0, 0.0], [1.0, 0.1], [0.2, 0.9]]])
UPPER, LOWER = np.array([0.0]), np.array([-0.4])


def node_places(corners: np.ndarray, upper: float, lower: float) -> np.ndarray:
    """(18, 3) of one wedge, level by level."""
    flat = np.concatenate([corners, corners[np.array(TRIANGLE_EDGES)].mean(axis=1)])
    levels = (upper, 0.5 * (upper + lower), lower)
    return np.concatenate([np.column_stack([flat, np.full(6, z)]) for z in levels])


def build_wedges() -> tuple[NeoHookeanWedges, np.ndarray]:
    """One wedge, with a triangle that is not regular."""
    rest = node_places(CORNERS[0], 0.0, -0.4)
    rows = np.arange(18)[None]
    return NeoHookeanWedges(CORNERS, UPPER, LOWER, rows, MU, LAMBDA), rest


def quadratic_field(x: np.ndarray) -> np.ndarray:
    """(n, 3) displacements of a function that a wedge holds, in each direction another one."""
    return np.stack(
        [x[:, 0] * x[:, 2], x[:, 1] ** 2 - x[:, 2] ** 2, x[:, 0] * x[:, 1] + x[:, 2]], axis=1
    )


def test_gradients_of_quadratic_fields_are_exact() -> None:
    """At every quadrature point, from values at the nodes; and the weights fill the volume."""
    gradients, weights = wedge_shape_gradients(CORNERS, UPPER, LOWER)
    rest = node_places(CORNERS[0], 0.0, -0.4)
    area = 0.5 * np.linalg.det(CORNERS[0, 1:] - CORNERS[0, :1])
    assert weights.sum() == pytest.approx(0.4 * area, rel=1e-14)
    # The places of the quadrature points follow from the mean of x over them, and from x^2.
    slopes = np.einsum("qad,ac->qcd", gradients[0], quadratic_field(rest))
    z = slopes[:, 0, 0]  # d(x z)/dx
    x = slopes[:, 0, 2]
    assert slopes[:, 1, 2] == pytest.approx(-2.0 * z, abs=1e-12)
    assert slopes[:, 2, 1] == pytest.approx(x, abs=1e-12)
    assert slopes[:, 1, 1] == pytest.approx(2.0 * slopes[:, 2, 0], abs=1e-12)
    assert slopes[:, 2, 2] == pytest.approx(1.0, abs=1e-12)
    assert weights[0] @ x == pytest.approx(0.4 * area * CORNERS[0, :, 0].mean(), rel=1e-13)
    # The mean of z^2 over a height t from 0 down is t^2/3; of x^2 that of the middles of edges.
    middles = CORNERS[0][np.array(TRIANGLE_EDGES)].mean(axis=1)
    assert weights[0] @ z**2 == pytest.approx(0.4 * area * 0.16 / 3.0, rel=1e-13)
    assert weights[0] @ x**2 == pytest.approx(0.4 * area * (middles[:, 0] ** 2).mean(), rel=1e-13)


def test_six_motions_alone_are_free() -> None:
    """One element on its own has no modes without energy beside those of a rigid body."""
    wedges, rest = build_wedges()
    values = np.linalg.eigvalsh(full_hessian(wedges, rest))
    assert np.abs(values[:6]).max() < 1e-9 * values[-1]
    assert values[6] > 1e-4 * values[-1]


def test_an_even_stretch_has_the_energy_of_the_law() -> None:
    wedges, rest = build_wedges()
    stretch = np.array([[1.2, 0.1, 0.0], [0.0, 0.9, 0.2], [0.1, 0.0, 1.1]])
    volume = 0.2 * np.linalg.det(CORNERS[0, 1:] - CORNERS[0, :1])
    log_j = np.log(np.linalg.det(stretch))
    density = 0.5 * MU * (np.sum(stretch**2) - 3.0 - 2.0 * log_j) + 0.5 * LAMBDA * log_j**2
    assert wedges.energy_parts(rest @ stretch.T)[0] == pytest.approx(volume * density, rel=1e-13)


def test_turned_over_wedges_have_infinite_energy() -> None:
    wedges, rest = build_wedges()
    assert np.isinf(wedges.energy_parts(rest * [1.0, 1.0, -1.0])).all()

"""Where the points of a deformed sheet go."""

from __future__ import annotations

import numpy as np
import pytest

from flexscale.errors import BadInputError
from tests.sheets.bent_sheets import flat_sheet, laid_on, on_cylinder

POINTS = np.random.default_rng(2).uniform(0.0, 1.0, (300, 2)) * [60.0, 30.0]


def cubic(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    u, v = points.T
    one, zero = np.ones_like(u), np.zeros_like(u)
    height = 1e-4 * (u**3 - 2.0 * u * v**2) + 0.01 * u * v
    slope_u = 1e-4 * (3.0 * u**2 - 2.0 * v**2) + 0.01 * v
    slope_v = -4e-4 * u * v + 0.01 * u
    gradient = np.stack([np.stack([one, zero, slope_u], 1), np.stack([zero, one, slope_v], 1)], 2)
    return np.stack([u, v, height], axis=1), gradient


def test_smooth_triangles_reproduce_cubic_surfaces():
    """HCT elements hold all cubics, whatever directions their derivatives are taken along."""
    sheet = laid_on(cubic, flat_sheet(size=7.0))
    np.testing.assert_allclose(sheet.at(POINTS), cubic(POINTS)[0], atol=1e-9)


@pytest.mark.parametrize(("element", "order"), [("c1", 4), ("edge_angle", 2)])
def test_points_on_a_cylinder_converge_at_the_element_s_order(element, order):
    angle = 0.02 * POINTS[:, 0]
    exact = np.stack([np.sin(angle), 0.02 * POINTS[:, 1], 1.0 - np.cos(angle)], axis=1) / 0.02
    errors = [
        abs(on_cylinder(0.02, flat_sheet(element=element, size=size)).at(POINTS) - exact).max()
        for size in (10.0, 5.0)
    ]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.4)


def test_points_outside_are_refused():
    with pytest.raises(BadInputError, match=r"\(61, 10\) mm lies outside the sheet"):
        flat_sheet().at(np.array([[5.0, 5.0], [61.0, 10.0]]))

"""Macro sheets against published shell problems and closed forms, on cheap meshes.

`benchmarks/macro_shell.py` has the same problems on finer ones, with rates.
"""

from __future__ import annotations

import pytest

from benchmarks.shell_problems import (
    cantilever,
    hemisphere,
    orthotropic_plate,
    roll_up,
    slit_annulus,
)
from flexscale.status import SolveStatus


def values_of(outcome) -> dict[str, float]:
    assert all(step.status == SolveStatus.converged for step in outcome.steps)
    assert outcome.steps[-1].negative_eigenvalues == 0
    return outcome.values


@pytest.mark.parametrize("element", ["c1", "edge_angle"])
def test_cantilever_under_end_shear(element):
    """Elastica at PL^2/EI = 4: Sze, Liu and Lo's 3.2894 and 6.6996; 32 and 66 faces give 0.1 %."""
    values = values_of(cantilever(element, 8))
    assert values["U"] == pytest.approx(3.2894, rel=2e-3)
    assert values["W"] == pytest.approx(6.6996, rel=2e-3)


@pytest.mark.parametrize(("element", "n", "gap"), [("c1", 8, 0.02), ("edge_angle", 16, 0.05)])
def test_end_moment_rolls_a_strip_to_a_circle(element, n, gap):
    """M = 2 pi E I/L: one whole turn, ends meet; 0.1 % of the turn on these meshes."""
    values = values_of(roll_up(element, n))
    assert values["turn"] == pytest.approx(1.0, abs=5e-3)
    assert values["gap"] < gap


def test_slit_annulus():
    """Sze, Liu and Lo's 13.891 and 17.528; 128 faces are 2 % below, and twice as fine is four times
    closer."""
    coarse, fine = (values_of(slit_annulus("c1", cells)) for cells in ((1, 8), (2, 16)))
    for name, expected in (("inner", 13.891), ("outer", 17.528)):
        errors = [abs(values[name] / expected - 1.0) for values in (coarse, fine)]
        assert errors[1] < 0.025
        assert errors[1] < 0.25 * errors[0]


def test_pinched_hemisphere_in_the_linear_range():
    """With a hole the linear answer is 0.0935 (MacNeal and Harder quote 0.0940 for it, and 0.0924
    without a hole); 256 faces of a quarter are 1 % stiff."""
    values = values_of(hemisphere(8, force=1e-3))
    assert values["outward"] == pytest.approx(0.0935, rel=0.015)
    assert values["inward"] == pytest.approx(values["outward"], rel=1e-3)


@pytest.mark.parametrize(
    ("element", "sizes", "limit", "rate"),
    [("c1", (2, 4), 5e-4, 3.5), ("edge_angle", (4, 8), 0.02, 1.8)],
)
def test_orthotropic_plate_against_naviers_series(element, sizes, limit, rate):
    """Fourth order for C1 triangles, second for edge angles."""
    errors = [abs(values_of(orthotropic_plate(element, n))["deflection"] - 1.0) for n in sizes]
    assert errors[1] < limit
    assert errors[1] < 2.0**-rate * errors[0]


@pytest.mark.parametrize("element", ["c1", "edge_angle"])
def test_a_plate_drawn_turned_is_the_same_plate(element):
    """Hinges along slanted sides, and the material's axes with them."""
    straight, turned = (orthotropic_plate(element, 4, turn=turn) for turn in (0.0, 0.7))
    assert turned.values["deflection"] == pytest.approx(straight.values["deflection"], rel=1e-7)

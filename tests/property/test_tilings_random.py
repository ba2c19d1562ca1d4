"""Random members of random families cover the plane, and are found again from their corners."""

from __future__ import annotations

import numpy as np
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from flexscale.errors import TilingError
from flexscale.tilings import Family, Tiling, families, fit_parameters
from tests.tilings.tiling_checks import assert_covers_plane

MANY = settings(
    max_examples=150,
    deadline=None,
    suppress_health_check=[HealthCheck.filter_too_much, HealthCheck.too_slow],
)
SHAPE = st.floats(-0.45, 0.45)
BUMP = st.floats(-0.2, 0.2)


def random_curve(draw: st.DrawFn, kind: str) -> list[tuple[float, float]]:
    """Zigzag as long as the kind asks."""
    places = {"J": (0.2, 0.45, 0.8), "S": (0.15, 0.3), "U": (0.1, 0.3, 0.5)}[kind]
    end = {"J": [(1.0, 0.0)], "S": [(0.5, 0.0)], "U": []}[kind]
    return [(0.0, 0.0), *((x, draw(BUMP)) for x in places), *end]


@st.composite
def tilings(draw: st.DrawFn, curved: bool) -> Tiling:
    """Any valid member of any family."""
    family: Family = draw(st.sampled_from(families()))
    parameters = [draw(SHAPE) for _ in range(family.n_parameters)]
    kinds = family.curve_kinds().items() if curved else ()
    curves = {letter: random_curve(draw, kind) for letter, kind in kinds if kind != "I"}
    try:
        tiling = Tiling(family.name, parameters, curves)
    except TilingError:
        assume(False)
    # Coordinates grow when a tile is nearly without area; tolerances below are for common ones.
    assume(np.abs(tiling.corners).max() < 10.0)
    return tiling


@MANY
@given(tilings(curved=False))
def test_straight_tiles_cover_the_plane(tiling: Tiling) -> None:
    assert_covers_plane(tiling)


@MANY
@given(tilings(curved=True))
def test_curved_tiles_cover_the_plane(tiling: Tiling) -> None:
    assert_covers_plane(tiling)


@MANY
@given(tilings(curved=False), st.floats(0.0, 6.3), st.floats(0.1, 50.0))
def test_similar_corners_have_the_same_parameters(
    tiling: Tiling, angle: float, size: float
) -> None:
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    found = fit_parameters(tiling.family, size * tiling.corners @ turn + (size, -3.0))
    assert np.allclose(found, tiling.parameters, rtol=0, atol=1e-7)

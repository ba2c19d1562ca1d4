"""Overlays of areas whose edges all but coincide."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from flexscale.patterns import overlay


def test_slivers_count_where_edges_all_but_coincide() -> None:
    """GEOS takes all of the first for what it shares with the second, which it only touches."""
    one = shapely.Polygon([(446, -207), (315, -75.99999999999999), (557, -76)])
    other = shapely.Polygon([(184, -207), (315, -76), (446, -207), (315, -338)])
    assert overlay.intersection(one, other).area == 0.0
    assert overlay.difference(one, other).area == pytest.approx(one.area)
    both = overlay.union([one, other])
    assert both.area == pytest.approx(one.area + other.area)
    assert overlay.symmetric_difference(one, other).area == pytest.approx(both.area)
    pair = overlay.intersection(np.array([one, shapely.box(200, -300, 400, 0)]), other)
    assert pair[0].area == 0.0
    assert pair[1].equals(shapely.intersection(shapely.box(200, -300, 400, 0), other))
    assert overlay.intersection(shapely.Polygon(), shapely.Polygon()).is_empty

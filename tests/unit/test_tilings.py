"""Tiling families: areas, orientation, refusals."""

from __future__ import annotations

import numpy as np
import pytest

from flexscale.errors import TilingError
from flexscale.patterns.cell import polygon_area
from flexscale.tilings import Tiling, families


@pytest.mark.parametrize("family", [family.name for family in families()])
def test_tiles_have_unit_area_and_fill_the_cell(family: str) -> None:
    tiling = Tiling(family)
    areas = [polygon_area(tile) for tile in tiling.tiles]
    assert areas == pytest.approx([1.0] * len(areas), rel=1e-13)
    assert np.linalg.det(tiling.lattice) == pytest.approx(sum(areas), rel=1e-13)


def test_walls_of_the_hexagon_face_its_six_neighbors() -> None:
    tiling = Tiling("IH20")
    t1, t2 = tiling.lattice
    assert np.degrees(np.arctan2(t1[1], t1[0])) == 0.0
    assert np.degrees(np.arctan2(t2[1], t2[0])) == pytest.approx(60.0)
    walls = np.roll(tiling.tiles[0], -1, axis=0) - tiling.tiles[0]
    normals = np.degrees(np.arctan2(-walls[:, 0], walls[:, 1])) % 360.0
    assert np.allclose(np.sort(normals), np.arange(0.0, 360.0, 60.0))


def test_side_of_the_square_lies_along_x() -> None:
    assert np.array_equal(Tiling("IH76").lattice, np.eye(2))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"family": "IH94"}, ["'IH94'", "does not exist"]),
        ({"family": "ih20"}, ["Did you mean 'IH20'"]),
        ({"family": "IH20", "parameters": [0.1]}, ["has 0 free shape parameter", "1 were given"]),
        ({"family": "IH76", "edges": {"a": [(0, 0), (1, 0)]}}, ["'a'", "mirrors"]),
    ],
)
def test_refusals_say_what_to_do(arguments: dict, words: list[str]) -> None:
    with pytest.raises(TilingError) as caught:
        Tiling(**arguments)
    assert all(word in str(caught.value) for word in words)

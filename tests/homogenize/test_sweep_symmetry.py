"""Sweeps solve one of all equivalent directions and fill in the rest."""

from __future__ import annotations

import numpy as np
import pytest

import flexscale as fs
from flexscale.errors import MeshError
from flexscale.homogenize.bend_line import Line
from flexscale.homogenize.symmetry import check_line, find_sources, symmetry_error, turn_stretch

COARSE = fs.MeshOptions(along=2.5, corner=1.0, scale_size=5.0, scale_corner=2.5, scale_layers=1)


def solved(pattern: fs.Pattern, directions: range) -> list[float]:
    return [source.direction for source in find_sources(pattern, directions, symmetric=True)]


def test_sources_of_hexagons_squares_and_bricks():
    every = range(0, 180, 15)
    assert solved(fs.named_pattern("hexagon"), every) == [0, 15, 30, 15] * 3
    assert solved(fs.named_pattern("square"), every) == [0, 15, 30, 45, 30, 15] * 2
    brick = [0, 15, 30, 45, 60, 75, 90]
    assert solved(fs.named_pattern("brick"), every) == [*brick, *brick[5:0:-1]]


def test_rotations_alone_repeat_directions():
    """Pinwheels have no mirrors: with three-fold centers 60 degrees are needed, with four 90."""
    assert set(solved(fs.named_pattern("pinwheel3"), range(0, 180, 20))) == {0, 20, 40}
    assert set(solved(fs.named_pattern("pinwheel4"), range(0, 180, 30))) == {0, 30, 60}


def test_without_symmetry_every_direction_is_its_own_source():
    sources = find_sources(fs.named_pattern("hexagon"), [0.0, 60.0], symmetric=False)
    assert [source.direction for source in sources] == [0.0, 60.0]


def test_filled_directions_are_what_solving_them_gives():
    directions, curvatures = [0.0, 30.0, 60.0, 90.0, 150.0], [0.0, 0.004]
    arguments = (fs.Pattern(fs.Tiling("IH76")), directions, curvatures, ["closing"])
    filled = fs.sweep(*arguments, workers=1, model=fs.NativeModel("shell", mesh=COARSE))
    full = fs.sweep(
        *arguments, workers=1, symmetry=False, model=fs.NativeModel("shell", mesh=COARSE)
    )
    assert filled.symmetry_source.values[0].tolist() == [0.0, 30.0, 30.0, 0.0, 30.0]
    assert full.symmetry_source.values[0].tolist() == directions
    for name in ("energy_density", "moment", "stretch", "min_gap"):
        np.testing.assert_allclose(filled[name], full[name], rtol=1e-6, atol=1e-9)
    assert np.ptp(filled.stretch.sel(component="xx").values) > 1e-7  # so that turning it matters
    assert "checked in direction 60 degree" in filled.symmetry_source.attrs["comment"]


def test_stretch_turns_along():
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])
    assert turn_stretch([1.1, 0.9, 0.02], turn) == pytest.approx([0.9, 1.1, -0.02])


def test_a_mesh_without_the_symmetry_is_refused():
    pattern, directions = fs.named_pattern("square"), [0.0, 90.0]
    sources = find_sources(pattern, directions, symmetric=True)
    line = check_line(["closing"], directions, sources, 0.001)
    assert line == Line("closing", 90.0, (0.001,))
    samples = {
        ("closing", 90.0): [{"curvature": 0.001, "energy_density": 1.02}],
        ("closing", 0.0): [{"curvature": 0.0}, {"curvature": 0.001, "energy_density": 1.0}],
    }
    with pytest.raises(MeshError, match=r"90 and 0 degree.*differ by 2 %"):
        symmetry_error(line, directions, sources, samples)
    samples["closing", 90.0][0]["energy_density"] = 1.001
    assert symmetry_error(line, directions, sources, samples) == pytest.approx(0.001)

"""The catalog of named patterns: complete, with the symmetry each entry promises."""

from __future__ import annotations

import numpy as np
import pytest

import flexscale as fs
from flexscale.errors import PatternError, UnknownNameError
from flexscale.mesh import MeshOptions, build_mesh
from flexscale.patterns.cell import polygon_area
from flexscale.patterns.junctions import turning_angles
from flexscale.tilings.drawn_symmetry import drawn_symmetry
from tests.property.mesh_symmetry import assert_symmetric

# name -> family, drawn group, scales in the primitive cell
PROMISED = {
    "hexagon": ("IH20", "p6m", 1),
    "square": ("IH76", "p4m", 1),
    "brick": ("IH17", "cmm", 1),
    "rhombus": ("IH74", "cmm", 1),
    "chevron": ("IH64", "pm", 1),
    "pinwheel3": ("IH10", "p3", 1),
    "pinwheel4": ("IH62", "p4", 1),
    "s_curve": ("IH57", "p2", 1),
    "arrowhead": ("IH69", "pmg", 2),
    "threefold": ("IH07", "p3", 3),
    "pentagon": ("IH28", "p4", 4),
    "fish_scale": ("IH68", "cm", 1),
}
CONVEX = {"hexagon", "square", "brick", "rhombus", "threefold", "pentagon"}
NAMES = pytest.mark.parametrize("name", PROMISED)


def test_catalog_is_complete() -> None:
    found = {entry.name: entry.family for entry in fs.named_patterns()}
    assert found == {name: family for name, (family, _, _) in PROMISED.items()}
    for entry in fs.named_patterns():
        assert entry.what.endswith(".")
        assert ". " not in entry.what
        assert set(entry.shape) <= {"parameters", "edges"}


@NAMES
def test_named_pattern_is_what_it_says(name: str) -> None:
    family, group, n_scales = PROMISED[name]
    pattern = fs.named_pattern(name)
    assert (pattern.name, pattern.family, pattern.n_scales) == (name, family, n_scales)
    assert pattern.symmetry().group == group
    assert pattern.symmetry().n_primitive_cells == 1
    assert pattern.tiling is not None
    assert drawn_symmetry(pattern.tiling.tiles, pattern.tiling.lattice).group == group
    areas = [polygon_area(tile) for tile in pattern.tiles]
    assert areas == pytest.approx([100.0] * n_scales, rel=1e-9)
    convex = all((turning_angles(tile) > -1e-9).all() for tile in pattern.tiles)
    assert convex == (name in CONVEX)


@NAMES
def test_mesh_of_a_named_pattern_has_its_symmetry(name: str) -> None:
    pattern = fs.named_pattern(name)
    mesh = build_mesh(pattern, MeshOptions(scale_order=1))
    for operation in pattern.symmetry().operations:
        assert_symmetric(mesh, operation)


def test_sizes_and_materials_are_those_asked_for() -> None:
    pattern = fs.named_pattern("pinwheel3", gap=0.6, tile_area=50.0, scale_material=fs.TPU)
    assert (pattern.gap, pattern.tile_area, pattern.scale_material) == (0.6, 50.0, fs.TPU)
    assert fs.Pattern.from_config(pattern.to_config()) == pattern
    assert fs.named_pattern("square") == fs.Pattern(fs.Tiling("IH76"))


def test_shapes_that_have_a_number() -> None:
    corners = fs.named_pattern("brick").tiles[0]
    assert np.ptp(corners, axis=0) == pytest.approx([200**0.5, 50**0.5], rel=1e-12)
    rhombus = turning_angles(fs.named_pattern("rhombus").tiles[0])
    assert np.sort(np.rad2deg(rhombus)) == pytest.approx([60, 60, 120, 120], rel=1e-12)
    chevron = np.rad2deg(turning_angles(fs.named_pattern("chevron").tiles[0]))
    assert np.sort(chevron) == pytest.approx([-60, 60, 60, 60, 120, 120], rel=1e-12)
    dart = np.rad2deg(turning_angles(fs.named_pattern("arrowhead").tiles[0]))
    flank, notch = np.rad2deg(np.arctan2([14, 4], 6))
    turns = [-2 * notch, 2 * flank, 180 - flank + notch, 180 - flank + notch]
    assert np.sort(dart) == pytest.approx(turns, rel=1e-12)


@pytest.mark.parametrize("name", ["pinwheel3", "pinwheel4", "s_curve", "fish_scale"])
def test_curves_look_smooth(name: str) -> None:
    """No corner but the tiling's vertices turns by 20 degrees or more."""
    pattern = fs.named_pattern(name)
    assert pattern.tiling is not None
    sharp = pattern.prototiles[0].sharp
    assert sharp.sum() == len(pattern.tiling.corners)


def test_refusals_say_what_to_do() -> None:
    with pytest.raises(UnknownNameError, match=r"'pinweel3'\. Did you mean 'pinwheel3'"):
        fs.named_pattern("pinweel3")
    with pytest.raises(PatternError, match=r"no size 'gapp'\. Did you mean 'gap'"):
        fs.named_pattern("square", gapp=0.4)
    with pytest.raises(PatternError, match="no size 'parameters'"):
        fs.named_pattern("square", parameters=[])
    with pytest.raises(PatternError, match="too wide"):
        fs.named_pattern("arrowhead", gap=9.0)

"""Solids of printable sheets, checked as an STL reader sees them."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import shapely

import flexscale as fs
from flexscale.cli.tiling_gallery import generic_tiling
from flexscale.fabricate import Disc, Grooves, Layout, PrintableSheet, Rectangle, printable_sheet
from flexscale.fabricate.hinges import hinge_axes
from flexscale.fabricate.solids import section, without_needles
from flexscale.fabricate.stl import stl_bytes
from flexscale.fabricate.walls import GRID, smallest_wall
from flexscale.tilings.families import find_family
from tests.fabricate.printable_checks import (
    crosses_itself,
    level,
    n_open_edges,
    read_stl,
    smallest_distance,
    volume_of,
)
from tests.sampling import every

SHAPES = [Rectangle(40.0, 30.0), Disc(22.0, hub=6.0)]
NAMES = [entry.name for entry in fs.named_patterns()]


def surfaces(sheet: PrintableSheet) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    return {solid.name: read_stl(stl_bytes(solid, "test")) for solid in sheet.solids}


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: shape.name)
@pytest.mark.parametrize("name", every(3, NAMES))
def test_every_pattern_makes_sound_solids(name: str, shape: Rectangle | Disc) -> None:
    sheet = printable_sheet(fs.named_pattern(name), shape, layout=Layout(direction=20.0))
    expected = sheet.expected_volumes()
    for part, (vertices, faces) in surfaces(sheet).items():
        assert n_open_edges(faces) == 0
        assert not crosses_itself(vertices, faces)
        # Both are the same polygons times the same heights; 32-bit heights round by 1e-7.
        assert volume_of(vertices, faces) == pytest.approx(expected[part], rel=1e-6)
        on_grid = vertices[:, :2] / GRID
        assert np.array_equal(on_grid, np.rint(on_grid))


@pytest.mark.parametrize("name", every(3, ["hexagon", "arrowhead", "fish_scale"]))
def test_walls_and_gaps_of_the_solids_can_be_printed(name: str) -> None:
    grooves = Grooves(width=0.6, pitch=1.1, depth=0.2)
    sheet = printable_sheet(fs.named_pattern(name), SHAPES[0], grooves=grooves)
    parts = surfaces(sheet)
    above, between = level(*parts["scales"], 2.0), level(*parts["scales"], 0.3)
    assert smallest_wall(above, 0.4) >= 0.4
    assert smallest_distance(above) == pytest.approx(0.4, abs=2 * GRID)
    assert smallest_wall(between, 0.4) >= 0.6 - GRID
    sheet_level = level(*parts["substrate"], 0.3)
    assert smallest_wall(sheet_level, 0.4) >= 0.4
    hidden = shapely.union_all(between)
    overlap = shapely.intersection(hidden, shapely.union_all(sheet_level))
    assert overlap.area < 1e-2 * GRID * hidden.length
    together = hidden.area + sum(area.area for area in sheet_level)
    assert together == pytest.approx(sheet.plan.sheet.area, rel=1e-6)


def test_grooves_lie_at_their_depth_and_the_rest_is_plain() -> None:
    sheet = printable_sheet(fs.named_pattern("square"), SHAPES[0], grooves=Grooves(depth=0.3))
    parts = surfaces(sheet)
    assert sorted({round(float(z), 4) for z in parts["substrate"][0][:, 2]}) == [0.0, 0.1, 0.4]
    assert parts["scales"][0][:, 2].min() == pytest.approx(0.1)
    plain = printable_sheet(fs.named_pattern("square"), SHAPES[0], grooves=Grooves(depth=0.0))
    assert plain.scales.bounds[0, 2] == pytest.approx(0.4)
    assert plain.substrate.volume == pytest.approx(plain.plan.sheet.area * 0.4, rel=1e-6)


def test_hinges_take_the_pin_at_their_axes() -> None:
    shape = Rectangle(40.0, 30.0, pin=2.0, clearance=0.3, barrel_wall=1.0)
    sheet = printable_sheet(fs.named_pattern("square"), shape)
    axes = hinge_axes(shape, 0.4, 0.4)
    radius = 2.15
    wanted = np.array([[-20.4 - radius, 0.4 + radius], [20.4 + radius, 0.4 + radius]])
    assert axes == pytest.approx(wanted, abs=GRID)
    cut = section(sheet.scales, 3.3)
    for axis in axes:
        rings = [ring for ring in cut if abs(ring[:, 0].mean() - axis[0]) < 0.5]
        outer = max(rings, key=lambda ring: shapely.Polygon(ring).area)
        hole = min(rings, key=lambda ring: shapely.Polygon(ring).area)
        pin = shapely.Point(axis).buffer(1.15 - 2 * GRID)
        assert shapely.covers(shapely.Polygon(hole), pin)
        assert shapely.Polygon(hole).area == pytest.approx(np.pi * 1.15**2, rel=0.01)
        wall = shapely.distance(shapely.LinearRing(outer), shapely.LinearRing(hole))
        assert wall == pytest.approx(1.0, abs=0.01)
    width = sheet.scales.bounds[1] - sheet.scales.bounds[0]
    assert width == pytest.approx([2 * (20.4 + 2 * radius), 30.0, 0.2 + 2 * radius], abs=1e-3)
    without = printable_sheet(fs.named_pattern("square"), dataclasses.replace(shape, pin=None))
    assert without.substrate.bounds[1, 0] == 20.0


def test_needles_give_way_and_the_surface_stays_closed() -> None:
    # A tetrahedron with a corner more in the middle of an edge, once in a triangle without area.
    vertices = np.array([[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2], [1, 0, 0]], dtype=float)
    faces = np.array([[0, 2, 1], [0, 1, 4], [0, 4, 3], [4, 1, 3], [0, 3, 2], [1, 2, 3]])
    assert n_open_edges(faces) == 0
    mended = without_needles(vertices, faces)
    assert n_open_edges(mended) == 0
    assert volume_of(vertices, mended) == pytest.approx(8.0 / 6.0)
    corners = vertices[mended]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.linalg.norm(normals, axis=1).min() > 0.5


def test_needles_beside_needles_stay_sound() -> None:
    pattern = fs.Pattern(generic_tiling(find_family("IH31")))
    layout = Layout(direction=13.0, center=(2.0, 1.0))
    sheet = printable_sheet(pattern, Disc(28.0, hub=5.0), layout=layout)
    for vertices, faces in surfaces(sheet).values():
        assert n_open_edges(faces) == 0
        assert not crosses_itself(vertices, faces)


def test_a_section_shows_teeth_that_fit() -> None:
    sheet = printable_sheet(fs.named_pattern("square"), Rectangle(30.0, 30.0, pin=None))
    areas = [
        sum(shapely.Polygon(ring).area for ring in section(solid, 0.3)) for solid in sheet.solids
    ]
    # The cut passes through scales of 9.6 mm and gaps of 0.4 mm, over 30 mm of sheet.
    assert sum(areas) == pytest.approx(30.0 * 0.4 + 28.8 * 4.0, rel=1e-4)
    assert areas[0] < 30.0 * 0.4 - 1.0

"""Gaps of their own for the scales of a pattern: outlines, symmetry, what is kept and refused."""

from __future__ import annotations

import numpy as np
import pytest

import flexscale as fs
from flexscale.errors import BadInputError, PatternError
from flexscale.mesh.options import MeshOptions
from flexscale.mesh.solid_options import SolidOptions
from flexscale.mesh.torus import build_mesh
from flexscale.patterns import Pattern
from flexscale.patterns.cell import polygon_area
from flexscale.patterns.joint_lines import joints_between
from flexscale.patterns.laid import lay_pattern, rectangle

SQUARE = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]])
PAIR = [SQUARE, SQUARE + np.array([10.0, 0.0])]


def pair(gap: object, **sizes: object) -> Pattern:
    return Pattern.from_polygons(PAIR, [20.0, 0.0], [0.0, 10.0], gap=gap, **sizes)


def checkerboard(gap: object) -> Pattern:
    return Pattern.from_polygons(PAIR, [20.0, 0.0], [10.0, 10.0], gap=gap)


def test_every_scale_ends_half_its_gap_within_its_tile() -> None:
    pattern = pair([0.4, 0.8])
    for outline, gap in zip(pattern.outlines(), (0.4, 0.8), strict=True):
        assert polygon_area(outline) == pytest.approx((10.0 - gap) ** 2)
    assert pattern.gaps == (0.4, 0.8)
    assert len(pattern.prototiles) == 2
    assert "gap 0.4 to 0.8 mm" in repr(pattern)


def test_the_narrowest_gap_is_that_of_tiles_that_meet() -> None:
    """In rows a scale meets its own kind; on a board of this kind only across corners."""
    assert pair([0.4, 0.8]).gap == 0.4
    assert checkerboard([0.4, 0.8]).gap == 0.4
    three = [SQUARE + np.array([10.0 * k, 0.0]) for k in range(3)]
    brick = Pattern.from_polygons(three, [30.0, 0.0], [15.0, 10.0], gap=[0.4, 0.8, 1.0])
    assert brick.gap == pytest.approx(0.6)  # that of 0.4 lies among the others


def test_what_is_kept_makes_it_again() -> None:
    pattern = pair((0.4, 0.8))
    assert pattern.to_config()["gap"] == [0.4, 0.8]
    assert Pattern.from_config(pattern.to_config()) == pattern
    assert pattern.with_(scale_height=3.0).gaps == (0.4, 0.8)
    assert pattern.with_(gap=0.5).to_config() == pair(0.5).to_config()
    assert pattern.symmetrize().gaps == (0.4, 0.8)
    assert pattern != pair((0.8, 0.4))
    assert pair([0.5, 0.5]).to_config() == pair(0.5).to_config()
    assert pair(np.array([0.4, 0.8])) == pattern


def test_symmetry_keeps_the_gaps() -> None:
    """Rows of pairs have mirrors along and across, but no quarter turns; a board has all."""
    assert pair(0.4).symmetry().group == "p4m"
    rows = pair([0.4, 0.8]).symmetry()
    assert (rows.group, rows.n_primitive_cells) == ("pmm", 1)
    board = checkerboard([0.4, 0.8]).symmetry()
    assert (board.group, board.n_primitive_cells) == ("p4m", 1)
    assert pair(0.4).symmetry().n_primitive_cells == 2


@pytest.mark.parametrize("solid", [None, SolidOptions(edge=0.1)], ids=["shell", "solid"])
def test_meshes_have_them_too(solid: SolidOptions | None) -> None:
    pattern = pair([0.4, 0.8])
    options = MeshOptions(along=3.0, corner=1.0, scale_size=5.0, scale_layers=1, scale_order=1)
    mesh = build_mesh(pattern, options, solid)
    u, v = (
        mesh.positions[mesh.triangles[:, k]]
        + mesh.triangle_offsets[:, k] @ mesh.lattice
        - mesh.positions[mesh.triangles[:, 0]]
        - mesh.triangle_offsets[:, 0] @ mesh.lattice
        for k in (1, 2)
    )
    areas = 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    for scale, gap in enumerate((0.4, 0.8)):
        covered = areas[mesh.triangle_scale == scale].sum()
        assert covered == pytest.approx((10.0 - gap) ** 2)
    assert areas.sum() == pytest.approx(200.0)


def test_sheets_have_them_also_where_the_border_cuts_tiles() -> None:
    laid = lay_pattern(pair([0.4, 0.8]), rectangle(38.0, 28.0))
    assert not laid.whole.all()
    assert set(laid.gaps) == {0.4, 0.8}
    for tile, outline, gap in zip(laid.tiles, laid.outlines, laid.gaps, strict=True):
        assert np.ptp(outline, axis=0) == pytest.approx(np.ptp(tile, axis=0) - gap)
    joints = joints_between(laid.tiles, laid.gaps, np.arange(len(laid.tiles)))
    for joint in joints:
        assert joint.gaps == pytest.approx(0.5 * (laid.gaps[joint.first] + laid.gaps[joint.second]))
    assert {round(float(joint.gaps[0]), 9) for joint in joints} == {0.4, 0.6, 0.8}


@pytest.mark.parametrize(
    ("gap", "said"),
    [
        ([0.4], r"gaps given are 1, but the polygons are 2: give one gap for each polygon"),
        ([0.4, 0.8, 0.4], r"gaps given are 3, but the polygons are 2"),
        ([], r"gaps given are 0, but the polygons are 2"),
        ([0.4, 0.0], r"gap 1 is 0 mm, but must be positive"),
        ([0.4, -0.1], r"gap 1 is -0\.1 mm, but must be positive"),
        ([0.4, float("nan")], r"gap 1 is nan mm"),
        ([0.4, "wide"], r"gap 1 must be a number in mm, not 'wide'"),
        ([0.4, [0.8]], r"gap 1 must be a number in mm"),
        ([0.4, 12.0], r"A gap of 12 mm is too wide for tile 1 \(100 mm²\): its scale vanishes"),
    ],
)
def test_gaps_that_make_no_pattern_are_refused(gap: object, said: str) -> None:
    with pytest.raises(BadInputError, match=said):
        pair(gap)


def test_families_have_one_gap() -> None:
    with pytest.raises(PatternError, match=r"a family has one gap .*from_polygons"):
        fs.named_pattern("square", gap=[0.4])
    with pytest.raises(PatternError, match=r"a family has one gap"):
        fs.named_pattern("chevron").with_(gap=(0.4, 0.8))

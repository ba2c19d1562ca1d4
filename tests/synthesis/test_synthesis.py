"""Scales on bent sheets: where they are, that they do not overlap, and what is written of them."""

from __future__ import annotations

import logging
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import flexscale as fs
from flexscale.errors import BadInputError, FabricationError, UnitRangeError
from flexscale.sheets.surfaces import cylinder
from flexscale.status import SolveStatus
from tests.mesh.test_mesh_vtu import read
from tests.physics.intersections import surfaces_intersect
from tests.sheets.bent_sheets import flat_sheet, laid_on, moved, on_cylinder

SQUARE, PITCH = fs.named_pattern("square"), 10.0


def intersect(scaled: fs.ScaledSheet) -> bool:
    """Whether surfaces of different scales cross, by exact tests of edges against triangles."""
    surfaces = scaled.scale_surfaces
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in surfaces)])
    triangles = [t + start for (_, t), start in zip(surfaces, starts[:-1], strict=True)]
    bodies = np.repeat(np.arange(len(surfaces)), np.diff(starts))
    points = np.concatenate([vertices for vertices, _ in surfaces])
    return surfaces_intersect(points, np.concatenate(triangles), bodies)


@pytest.mark.parametrize("element", ["c1", "edge_angle"])
def test_scales_follow_a_rigid_motion_exactly(element):
    turn, shift = Rotation.random(rng=3).as_matrix(), np.array([4.0, -7.0, 30.0])
    sheet = laid_on(moved(turn, shift), flat_sheet(element=element))
    scaled = fs.synthesize_scales(fs.named_pattern("arrowhead"), sheet)
    np.testing.assert_allclose(
        scaled.placement.rotations, np.tile(turn, (scaled.n_scales, 1, 1)), atol=1e-9
    )
    np.testing.assert_allclose(
        scaled.placement.translations, np.tile(shift, (scaled.n_scales, 1)), atol=1e-7
    )
    assert scaled.fit_residuals.max() < 1e-9
    assert scaled.overlap_before.deepest == 0.0


def test_pattern_lies_in_the_direction_of_the_sheet():
    """Chevrons, turned with the sheet: a scale's outline is the pattern's, turned back."""
    pattern = fs.named_pattern("chevron")
    for direction in (0.0, 30.0):
        scaled = fs.synthesize_scales(pattern, flat_sheet(direction=direction))
        whole = next(scale for scale in scaled.scales if scale.whole)
        turn = Rotation.from_euler("z", direction, degrees=True).as_matrix()[:2, :2]
        back = whole.outline @ turn.T
        home = pattern.outlines()[whole.tile]
        found, wanted = back - back.mean(axis=0), home - home.mean(axis=0)
        nearest = np.linalg.norm(found[:, None] - wanted, axis=2).min(axis=1)
        assert nearest.max() < 1e-3


@pytest.mark.parametrize("curvature", [0.0125, 0.02])
def test_overlap_of_squares_on_a_cylinder_is_the_closed_form(curvature):
    """Squares of width w at a pitch P, the middle of each base at the mean distance rho = (2 /
    (kappa^2 w)) sin(kappa w / 2) of its arc from the axis: base edges of neighbors, which are
    tilted by kappa P, are 2 (rho sin(kappa P / 2) - w / 2 cos(kappa P / 2)) apart."""
    scaled = fs.synthesize_scales(
        SQUARE, on_cylinder(curvature, flat_sheet()), remove_overlap=False
    )
    width, height, angle = PITCH - SQUARE.gap, SQUARE.scale_height, curvature * PITCH
    rho = 2.0 * np.sin(0.5 * curvature * width) / (curvature**2 * width)
    gap = 2.0 * (rho * np.sin(0.5 * angle) - 0.5 * width * np.cos(0.5 * angle))
    expected = height * np.sin(angle) - gap * np.cos(0.5 * angle)
    # The elements themselves are 1e-5 mm off the cylinder.
    assert scaled.overlap_before.deepest == pytest.approx(expected, abs=2e-4)
    assert expected == pytest.approx(height * curvature * PITCH - SQUARE.gap, rel=0.1, abs=0.02)
    assert intersect(scaled)
    assert not scaled.converged


@pytest.mark.parametrize("name", ["square", "arrowhead"])
def test_opening_sheets_do_not_overlap_and_nothing_moves(name):
    sheet = on_cylinder(-0.02, flat_sheet())
    scaled = fs.synthesize_scales(fs.named_pattern(name), sheet)
    assert scaled.overlap_before.deepest == scaled.overlap.deepest == 0.0
    assert scaled.converged
    assert scaled.iterations == 0
    assert scaled.largest_motion == 0.0


@pytest.mark.parametrize("name", ["square", "hexagon", "arrowhead"])
def test_overlap_is_removed_with_little_motion(name):
    """Bound: scales slide apart along the arc by the deepest overlap, column by column, at least
    half a tile's side apart: no motion less than the least may be more than this one."""
    sheet = on_cylinder(0.02, flat_sheet())
    scaled = fs.synthesize_scales(fs.named_pattern(name), sheet)
    deepest = scaled.overlap_before.deepest
    assert deepest > 0.2
    assert scaled.converged
    assert scaled.overlap.deepest == 0.0
    assert not intersect(scaled)
    columns = 60.0 / PITCH + 1.0
    sliding = (deepest + scaled.clearance) * np.sqrt((columns**2 - 1.0) / 12.0)
    assert 0.25 * deepest < scaled.rms_motion < 0.9 * sliding
    turns = scaled.placement.rotations @ scaled.fitted.rotations.transpose(0, 2, 1)
    np.testing.assert_allclose(np.linalg.det(turns), 1.0, atol=1e-12)


def test_scales_turn_less_if_turning_weighs_more():
    sheet = on_cylinder(0.02, flat_sheet())
    largest = []
    for weight in (1.0, 100.0):
        scaled = fs.synthesize_scales(SQUARE, sheet, turn_weight=weight)
        assert scaled.converged
        turns = scaled.placement.rotations @ scaled.fitted.rotations.transpose(0, 2, 1)
        largest.append(Rotation.from_matrix(turns).magnitude().max())
    assert largest[1] < 0.3 * largest[0]


def test_overlap_that_stays_is_told(caplog, monkeypatch):
    monkeypatch.setattr("flexscale.synthesis.remove_overlap.MOST_ITERATIONS", 1)
    with caplog.at_level(logging.WARNING):
        scaled = fs.synthesize_scales(SQUARE, on_cylinder(0.02, flat_sheet()))
    assert not scaled.converged
    assert scaled.overlap.deepest > 0.0
    assert "still overlap by up to" in caplog.text


@pytest.fixture(scope="module")
def overlapping():
    return fs.synthesize_scales(SQUARE, on_cylinder(0.02, flat_sheet()), remove_overlap=False)


def test_obj_file_comes_back(overlapping, tmp_path):
    overlapping.write(tmp_path / "sheet.obj")
    vertices, groups = [], {}
    for line in (tmp_path / "sheet.obj").read_text().splitlines():
        word, *values = line.split()
        if word == "v":
            vertices.append([float(value) for value in values])
        elif word == "g":
            faces = groups.setdefault(values[0], [])
        elif word == "f":
            faces.append([int(value) - 1 for value in values])
    np.testing.assert_allclose(vertices, overlapping.vertices, atol=1e-6)
    assert list(groups) == ["substrate", *(f"scale_{k}" for k in range(overlapping.n_scales))]
    assert [face for faces in groups.values() for face in faces] == overlapping.triangles.tolist()
    corners = np.array(vertices)[np.array(groups["scale_0"])]
    volume = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0
    x, y = overlapping.scales[0].outline.T
    area = 0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1))
    assert volume == pytest.approx(area * SQUARE.scale_height, rel=1e-6)


def test_vtu_file_comes_back(overlapping, tmp_path):
    overlapping.write(tmp_path / "sheet.vtu")
    arrays = read(tmp_path / "sheet.vtu")
    np.testing.assert_array_equal(arrays["points"].reshape(-1, 3), overlapping.vertices)
    np.testing.assert_array_equal(arrays["connectivity"].reshape(-1, 3), overlapping.triangles)
    np.testing.assert_array_equal(arrays["scale"], overlapping.triangle_scale)
    assert arrays["overlap"].max() == overlapping.overlap.deepest
    assert (arrays["overlap"][arrays["scale"] < 0] == 0.0).all()


def test_picture_shows_which_scales_overlap(overlapping):
    """Two of them do here: they get a color of their own."""
    some = overlapping.overlap
    two = replace(overlapping, overlap=replace(some, pairs=some.pairs[:1]))
    figure = fs.plot.scaled_sheet(two)
    shown = {patch.get_label(): patch.get_facecolor() for patch in figure.legends[0].get_patches()}
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["substrate", "scales", "scales that overlap"]
    assert len(set(shown.values())) == 3
    assert figure.get_suptitle() == two.title
    image = figure.axes[0].images[0].get_array()
    opaque = image[image[..., 3] > 0.5][:, :3]
    assert 0.1 < len(opaque) / image[..., 3].size < 0.9
    red = opaque[:, 0] > 3.0 * opaque[:, 1]
    assert 0.005 < red.mean() < 0.2


def test_bad_input_is_refused(overlapping, tmp_path):
    sheet = overlapping.sheet
    with pytest.raises(BadInputError, match=r"must end in \.obj or \.vtu"):
        overlapping.write(tmp_path / "sheet.stl")
    with pytest.raises(BadInputError, match="There is no folder"):
        overlapping.write(tmp_path / "none" / "sheet.obj")
    with pytest.raises(BadInputError, match=r"0\.02 mm-1 did not converge \(stalled"):
        fs.synthesize_scales(SQUARE, replace(sheet, status=SolveStatus.stalled))
    with pytest.raises(UnitRangeError, match="clearance is 0"):
        fs.synthesize_scales(SQUARE, sheet, clearance=0.0)
    with pytest.raises(UnitRangeError, match="turn weight is -1"):
        fs.synthesize_scales(SQUARE, sheet, turn_weight=-1.0)
    with pytest.raises(FabricationError, match="holds no whole scale of pattern 'square'"):
        fs.synthesize_scales(SQUARE, flat_sheet(12.0, 8.0))


def test_a_scale_on_its_own_stays():
    """One tile as large as the sheet: no neighbors, no contacts."""
    alone = SQUARE.with_(tile_area=400.0, gap=1.0)
    scaled = fs.synthesize_scales(alone, laid_on(cylinder(0.02), flat_sheet(20.0, 20.0)))
    assert scaled.n_scales == 1
    assert scaled.converged

"""Pictures of cells: lattice images against the curvature map, and what the pixels show."""

from __future__ import annotations

import numpy as np
import pytest

from flexscale.errors import BadInputError, SchemaError
from flexscale.plotting import cell, raster
from flexscale.plotting.cell_geometry import cell_offsets, lattice_motions, pattern_surfaces
from flexscale.plotting.raster import Surfaces, View, render
from flexscale.plotting.scene import draw_pattern
from flexscale.plotting.style import new_figure
from tests.plotting.plotting_data import bend, flat_cell, prism_shape


@pytest.mark.parametrize(("direction", "curvature"), [(0.0, 0.02), (37.0, -0.013), (90.0, 1e-9)])
def test_images_of_the_bent_cell_are_the_bent_images(direction: float, curvature: float) -> None:
    random = np.random.default_rng(1)
    points = random.uniform(-5.0, 5.0, (20, 3))
    shifts = np.array([[0.0, 0.0], [10.1, 0.2], [-3.0, 8.0]])
    rotations, translations = lattice_motions(shifts, direction, curvature)
    home = bend(points, direction, curvature)
    for shift, rotation, translation in zip(shifts, rotations, translations, strict=True):
        expected = bend(points + np.append(shift, 0.0), direction, curvature)
        # 1/curvature = 1e9 mm cancels in the test's own map, hence its tolerance there.
        tolerance = 1e-12 if abs(curvature) > 1e-6 else 1e-6
        np.testing.assert_allclose(home @ rotation.T + translation, expected, atol=tolerance)
        np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-14)


def test_flat_images_are_plain_shifts() -> None:
    rotations, translations = lattice_motions(np.array([[3.0, -2.0]]), 30.0, 0.0)
    np.testing.assert_allclose(rotations[0], np.eye(3), atol=1e-15)
    np.testing.assert_allclose(translations[0], [3.0, -2.0, 0.0], atol=1e-15)


def test_view_axes_are_right_handed_and_z_points_up() -> None:
    axes = View(25.0, 40.0).axes
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    assert axes[1, 2] > 0.0
    np.testing.assert_allclose(View(-90.0, 90.0).axes, np.eye(3), atol=1e-15)


def square(depth: float, half: float = 1.0) -> np.ndarray:
    a, b, c, d = ([x * half, y * half, depth] for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1)))
    return np.array([[a, b, c], [a, c, d]])


def test_the_nearest_surface_is_seen_even_where_two_cross() -> None:
    tilted = square(0.0)
    tilted[..., 2] = tilted[..., 0]  # depth x: in front of the flat one on the right
    red, green = [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]
    surfaces = Surfaces(
        np.concatenate([square(0.0), tilted]),
        np.array([red, red, green, green]),
        np.array([0, 0, 1, 1]),
        np.zeros(4, dtype=bool),
    )
    image = render(surfaces, (-1.0, 1.0, -1.0, 1.0), 20.0, shaded=False)
    assert image.shape == (40, 40, 4)
    np.testing.assert_allclose(image[:, :19, :3], np.broadcast_to(red, (40, 19, 3)))
    np.testing.assert_allclose(image[:, 21:, :3], np.broadcast_to(green, (40, 19, 3)))


def test_first_row_is_the_top_and_empty_is_transparent() -> None:
    corners = square(0.0, 0.5) + np.array([0.5, 0.5, 0.0])  # upper right quarter
    surfaces = Surfaces(corners, np.zeros((2, 3)), np.zeros(2, dtype=int), np.zeros(2, dtype=bool))
    alpha = render(surfaces, (-1.0, 1.0, -1.0, 1.0), 10.0)[..., 3]
    np.testing.assert_array_equal(alpha[:10, 10:], 1.0)
    assert alpha.sum() == 100.0


def test_back_of_a_solid_is_not_drawn_but_a_sheet_has_two_sides() -> None:
    back = square(0.0)[:, ::-1]
    for solid, share in ((True, 0.0), (False, 1.0)):
        surfaces = Surfaces(back, np.ones((2, 3)), np.zeros(2, dtype=int), np.full(2, solid))
        assert render(surfaces, (-1.0, 1.0, -1.0, 1.0), 5.0)[..., 3].mean() == share


def test_outlines_between_bodies_are_inked() -> None:
    aside = np.array([0.5, 0.0, 0.0])
    two = np.concatenate([square(0.0, 0.5) - aside, square(0.0, 0.5) + aside])
    body = np.array([0, 0, 1, 1])
    plain = Surfaces(two, np.ones((4, 3)), np.zeros(4, dtype=int), np.ones(4, dtype=bool))
    split = Surfaces(two, np.ones((4, 3)), body, np.ones(4, dtype=bool))
    window = (-1.0, 1.0, -0.5, 0.5)
    middle_plain = render(plain, window, 10.0)[5, 9:11, 0].min()
    middle_split = render(split, window, 10.0)[5, 9:11, 0].min()
    assert middle_split < 0.8 * middle_plain


def test_panels_share_one_length_scale_and_say_what_they_show() -> None:
    figure = cell(prism_shape(6, [(90.0, 0.02), (90.0, -0.01), (0.0, 0.0)]))
    titles = [axes.get_title() for axes in figure.axes]
    assert titles == [
        "closing 0.02 mm⁻¹, direction 90°",
        "opening 0.01 mm⁻¹, direction 90°",
        "flat",
    ]
    extents = {tuple(axes.images[0].get_extent()) for axes in figure.axes}
    assert len(extents) == 1
    assert all(axes.get_aspect() == 1.0 for axes in figure.axes)
    assert any("10 mm" in text.get_text() for text in figure.axes[0].texts)


def test_more_cells_show_more_and_the_home_cell_stands_out() -> None:
    shape = prism_shape(4, [(0.0, 0.02)])
    one, many = (cell(shape, 0, n_cells=n).axes[0].images[0] for n in (1, 3))
    assert np.ptp(many.get_extent()[:2]) > 2.5 * np.ptp(one.get_extent()[:2])
    pixels = np.asarray(many.get_array())
    seen = pixels[pixels[..., 3] == 1.0][:, :3]
    saturation = seen.max(axis=1) - seen.min(axis=1)
    strong = np.mean(saturation > 0.6)  # the home cell's orange
    assert 0.03 < strong < 0.2


def test_a_sample_without_result_says_so() -> None:
    figure = cell(prism_shape(4, [(0.0, 0.02), (0.0, 0.03)], failed=(1,)))
    assert len(figure.axes[0].images) == 1
    assert len(figure.axes[1].images) == 0
    assert any("not converged" in text.get_text() for text in figure.axes[1].texts)
    everything_failed = cell(prism_shape(4, [(0.0, 0.02)], failed=(0,)))
    assert not everything_failed.axes[0].images


def test_bad_choices_are_refused() -> None:
    shape = prism_shape(4, [(0.0, 0.02), (45.0, -0.01)])
    with pytest.raises(BadInputError, match=r"0: closing 0\.02 mm⁻¹, direction 0°; 1: opening"):
        cell(shape, [0, 2])
    with pytest.raises(BadInputError, match="n_cells"):
        cell(shape, n_cells=0)
    with pytest.raises(SchemaError, match="displacement"):
        cell(shape.drop_vars("displacement"))


@pytest.mark.parametrize("n_corners", [4, 6])
def test_pattern_from_above_shows_scales_and_gaps_in_their_shares(n_corners: int) -> None:
    dataset = flat_cell(n_corners)
    surfaces = pattern_surfaces(dataset, 1)
    edges = np.diff(surfaces.corners[..., :2], axis=1)
    area = 0.5 * (edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0])
    scale_share = area[dataset["triangle_scale"].values >= 0].sum() / area.sum()
    axes = new_figure(2.0, 2.0).add_subplot()
    draw_pattern(axes, dataset, 3)
    pixels = np.asarray(axes.images[0].get_array())
    seen = pixels[pixels[..., 3] == 1.0]
    # Red tells the orange scales (0.90) from the blue substrate (0.34).
    assert np.mean(seen[:, 0] > 0.62) == pytest.approx(scale_share, abs=0.015)


def test_cell_offsets_surround_the_home_cell() -> None:
    offsets = cell_offsets(3)
    assert offsets.shape == (9, 2)
    np.testing.assert_array_equal(offsets.sum(axis=0), 0)
    np.testing.assert_array_equal(cell_offsets(1), [[0, 0]])


def test_small_triangles_are_drawn_as_large_ones_are(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those drawn together in batches give the very pixels of those drawn one by one."""
    random = np.random.default_rng(5)
    middle = random.uniform(-3.0, 3.0, (300, 1, 3))
    corners = middle + random.normal(size=(300, 3, 3)) * random.uniform(0.02, 1.0, (300, 1, 1))
    surfaces = Surfaces(
        corners, random.uniform(size=(300, 3)), np.arange(300) % 7, random.uniform(size=300) > 0.5
    )
    window = (-3.0, 3.0, -3.0, 3.0)
    together = render(surfaces, window, 20.0)
    monkeypatch.setattr(raster, "_SMALL", 0)
    np.testing.assert_array_equal(together, render(surfaces, window, 20.0))
    monkeypatch.setattr(raster, "_SMALL", 1000)
    monkeypatch.setattr(raster, "_CHUNK", 7)
    np.testing.assert_allclose(together, render(surfaces, window, 20.0), atol=1e-12)

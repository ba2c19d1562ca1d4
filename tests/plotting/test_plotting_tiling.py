"""Pictures of tilings: what is marked on a tile, which tiles are drawn, and where outlines meet."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from flexscale.errors import BadInputError
from flexscale.plotting.outline_contacts import outline_contacts
from flexscale.plotting.picture_file import write_picture
from flexscale.plotting.style import FAILED_COLOR
from flexscale.plotting.tiling import TilingPicture, cell_corner, tiling
from flexscale.plotting.tiling_edges import TileEdge, tick_marks
from flexscale.plotting.tiling_gallery import GalleryPanel, gallery
from flexscale.plotting.tiling_shapes import aspect_looks, tiles_in_window

SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
STRAIGHT = np.array([(0.0, 0.0), (1.0, 0.0)])


def edges_of(corners: np.ndarray, kinds: str, **options: bool) -> tuple[TileEdge, ...]:
    """Straight edges, each of a class of its own."""
    ends = np.roll(corners, -1, axis=0)
    return tuple(
        TileEdge("abcdef"[k], kind, np.stack([corners[k], ends[k]]), **options)
        for k, kind in enumerate(kinds)
    )


def two_squares(**options: object) -> TilingPicture:
    """A square and its mirror image, on a cell of two squares."""
    lattice = np.array([(2.0, 0.0), (0.0, 1.0)])
    tiles = (SQUARE, SQUARE + np.array([1.0, 0.0]))
    edges = edges_of(SQUARE, "JUSI")
    return TilingPicture(("two squares",), edges, tiles, (False, True), lattice, **options)  # type: ignore[arg-type]


def polygons(figure: Figure) -> list[np.ndarray]:
    """Filled polygons of the left panel."""
    filled = [
        collection
        for collection in figure.axes[0].collections
        if isinstance(collection, PolyCollection) and len(collection.get_facecolor())
    ]
    return [path.vertices for collection in filled for path in collection.get_paths()]


@pytest.mark.parametrize(
    "mirrored",
    [
        (False, True),
        (False,) * 7,
        (False, True) * 4,
        (False,) * 6 + (True,) * 6,
        (False, *(True,) * 6, *(False,) * 5),
    ],
)
def test_every_aspect_looks_different(mirrored: tuple[bool, ...]) -> None:
    looks = aspect_looks(mirrored)
    assert len({(look.color, look.striped) for look in looks}) == len(mirrored)
    assert [look.striped for look in looks] == list(mirrored)


@pytest.mark.parametrize(
    ("kind", "backward", "outside", "expected"),
    [
        ("J", False, False, {(1, 1)}),
        ("J", True, False, {(2, 1)}),
        ("J", True, True, {(2, -1)}),
        ("U", False, True, {(1, -1), (2, -1)}),
        ("S", False, False, {(1, 1), (2, -1)}),
        ("S", True, True, {(1, 1), (2, -1)}),
        ("S", False, True, {(1, -1), (2, 1)}),
        ("I", False, False, set()),
    ],
)
def test_ticks_have_the_symmetry_of_the_class(
    kind: str, backward: bool, outside: bool, expected: set[tuple[int, int]]
) -> None:
    marks = tick_marks(TileEdge("a", kind, STRAIGHT, backward, outside))
    found = {(round(3 * foot[0]), int(np.sign(tip[1]))) for foot, tip in marks}
    assert found == expected
    assert len(marks) == len(expected)
    for foot, tip in marks:
        assert foot[0] * 3 == pytest.approx(round(3 * foot[0]))
        assert tip[0] == pytest.approx(foot[0])


def test_ticks_are_placed_by_length_along_a_curve() -> None:
    bent = np.array([(0.0, 0.0), (0.0, 2.0), (1.0, 2.0)])
    ((foot, tip),) = tick_marks(TileEdge("a", "J", bent))
    np.testing.assert_allclose(foot, (0.0, 1.0))
    assert tip[0] < 0.0
    assert tip[1] == pytest.approx(1.0)


def test_outlines_that_meet_themselves() -> None:
    pairs, points = outline_contacts(np.array([(0, 0), (2, 0), (2, 2), (1, -1), (0, 2)]) * 1.0)
    assert {frozenset(pair) for pair in pairs.tolist()} == {frozenset({0, 2}), frozenset({0, 3})}
    np.testing.assert_allclose(sorted(points[:, 0]), (2 / 3, 4 / 3))
    np.testing.assert_allclose(points[:, 1], 0.0, atol=1e-12)
    assert outline_contacts(SQUARE)[0].shape == (0, 2)


def test_outlines_that_touch_themselves() -> None:
    pairs, points = outline_contacts(np.array([(0, 0), (2, 0), (2, 2), (1, 0), (0, 2)]) * 1.0)
    assert (points == (1.0, 0.0)).all()
    assert [0, 3] in pairs.tolist()
    spike = np.array([(0, 0), (1, 0), (1, 1), (1, 3), (1, 1.5), (0, 1)]) * 1.0
    assert [2, 4] in outline_contacts(spike)[0].tolist()


def test_window_is_filled() -> None:
    rng = np.random.default_rng(3)
    lattice = np.array([(1.0, 0.3), (-0.2, 1.1)])
    tile = SQUARE @ lattice + np.array([40.0, 7.0])
    images = tiles_in_window(tile, lattice, (-2.0, 2.0, -1.0, 3.0))
    corners = np.array([image[0] for image in images])
    for point in rng.uniform((-2.0, -1.0), (2.0, 3.0), (200, 2)):
        inside = (point - corners) @ np.linalg.inv(lattice)
        assert np.count_nonzero(((inside >= 0.0) & (inside < 1.0)).all(axis=1)) == 1
    assert len(images) < 40


def test_cell_starts_at_a_vertex_and_lies_about_the_middle() -> None:
    lattice = np.array([(2.0, 0.0), (0.5, 1.0)])
    corner = cell_corner(SQUARE, lattice, np.array([8.3, 4.4]))
    steps = (corner - SQUARE) @ np.linalg.inv(lattice)
    assert np.abs(steps - np.rint(steps)).max(axis=1).min() < 1e-12
    assert np.linalg.norm(corner + 0.5 * lattice.sum(axis=0) - (8.3, 4.4)) < 0.8


def test_patch_shows_every_tile_of_every_cell_once() -> None:
    figure = tiling(two_squares(), 3)
    assert len(figure.axes) == 2
    found = {tuple(np.round(polygon.min(axis=0), 6)) for polygon in polygons(figure)}
    assert found == {(float(x), float(y)) for x in range(-2, 4) for y in (-1, 0, 1)}
    assert len(polygons(figure)) == 18
    assert {text.get_text() for text in figure.axes[0].texts} >= {"0", "1", "t1", "t2"}
    assert {text.get_text() for text in figure.axes[1].texts} == set("abcd0123")
    styles = {line.get_linestyle() for line in figure.axes[1].lines if len(line.get_xdata()) == 2}
    assert len(figure.legends[0].get_texts()) == 4
    assert len(styles) >= 2


def test_number_of_cells() -> None:
    assert len(polygons(tiling(two_squares(), 1))) == 2
    assert len(polygons(tiling(two_squares()))) == 18
    with pytest.raises(BadInputError, match="0 cells"):
        tiling(two_squares(), 0)


def test_what_is_no_tile_is_drawn_alone_with_its_fault_in_red() -> None:
    edges = edges_of(SQUARE[[0, 2, 1, 3]], "JJJJ", wrong=True)
    picture = TilingPicture(("none",), edges, crossings=np.array([(0.5, 0.5)]))
    figure = tiling(picture)
    (axes,) = figure.axes
    red = [line for line in axes.lines if to_hex(line.get_color()).upper() == FAILED_COLOR]
    assert any(line.get_xydata().tolist() == [[0.5, 0.5]] for line in red)
    assert sum(len(line.get_xdata()) == 2 for line in red) == 8  # edges and ticks
    assert figure.legends[0].get_texts()[-1].get_text() == "at fault"


def test_gallery_has_a_panel_for_each() -> None:
    panel = GalleryPanel("squares", (SQUARE,), (False,), np.eye(2))
    figure = gallery([panel] * 14, ("remark",))
    assert [axes.get_title() for axes in figure.axes] == ["squares"] * 14
    assert figure.get_supxlabel() == "remark"


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_equal_pictures_have_equal_bytes(ending: str, tmp_path: Path) -> None:
    contents = []
    for name in ("one", "two"):
        path = tmp_path / f"{name}.{ending}"
        write_picture(tiling(two_squares()), path)
        contents.append(path.read_bytes())
    assert contents[0] == contents[1]
    assert len(list(tmp_path.iterdir())) == 2


def test_palette_makes_a_png_smaller(tmp_path: Path) -> None:
    paths = [tmp_path / "all.png", tmp_path / "few.png"]
    for path, n_colors in zip(paths, (None, 16), strict=True):
        write_picture(tiling(two_squares()), path, n_colors=n_colors)
    sizes = [path.stat().st_size for path in paths]
    assert sizes[1] < 0.6 * sizes[0]


def test_pictures_that_cannot_be_written(tmp_path: Path) -> None:
    figure = tiling(two_squares())
    with pytest.raises(BadInputError, match=r"x\.pgn must end .* Did you mean 'png'"):
        write_picture(figure, tmp_path / "x.pgn")
    with pytest.raises(BadInputError, match="There is no folder"):
        write_picture(figure, tmp_path / "none" / "x.png")
    assert list(tmp_path.iterdir()) == []

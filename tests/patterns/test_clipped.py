"""Places of a pattern on a sheet: one that does not suit does not end the search."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

import flexscale as fs
from flexscale.errors import PatternError
from flexscale.patterns import clipped, overlay, strip
from flexscale.patterns.cell import TiledCell, build_cell
from flexscale.patterns.clipped import SheetTiles, clip_pattern
from flexscale.patterns.strip import clip_strip


def assert_covers(tiles: SheetTiles) -> None:
    """Scaled and bare pieces together are the sheet, once."""
    pieces = [
        copy.placement.apply(tiles.prototiles[copy.prototile].polygon) for copy in tiles.copies
    ] + [polygon for polygon, _ in tiles.bare]
    areas = shapely.area([shapely.Polygon(piece) for piece in pieces])
    assert areas.sum() == pytest.approx(tiles.length * tiles.width, rel=1e-9)
    assert len(tiles.copies) > 0


@pytest.mark.parametrize(
    ("name", "sizes", "direction"),
    [
        ("hexagon", (60.0, 30.0), 45.0),
        ("rhombus", (60.0, 30.0), 45.0),
        pytest.param("fish_scale", (100.0, 50.0), 0.0, marks=pytest.mark.slow),
        pytest.param("fish_scale", (100.0, 50.0), 90.0, marks=pytest.mark.slow),
    ],
)
def test_sheets_whose_first_places_do_not_suit(
    name: str, sizes: tuple[float, float], direction: float
) -> None:
    """Of some of the places that come first, corners on opposite sides nearly meet."""
    assert_covers(clip_pattern(fs.named_pattern(name), *sizes, direction))


@pytest.mark.parametrize("n_refused", [1, 26])
def test_a_refused_place_is_not_the_last(monkeypatch: pytest.MonkeyPatch, n_refused: int) -> None:
    calls = []

    def refuses_some(*arguments: object) -> TiledCell:
        calls.append(arguments)
        if len(calls) <= n_refused:
            raise PatternError("The tiles do not cover the plane.")
        return build_cell(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(clipped, "build_cell", refuses_some)
    assert_covers(clip_pattern(fs.named_pattern("square"), 20.0, 20.0, 20.0))
    assert len(calls) > n_refused
    calls.clear()
    assert_covers(clip_strip(fs.named_pattern("square"), 25.0))
    assert len(calls) == n_refused + 1
    calls.clear()
    monkeypatch.setattr(clipped, "MOST_TRIES", n_refused)
    with pytest.raises(PatternError, match=rf"{n_refused} places .*: The tiles do not cover .* mm"):
        clip_pattern(fs.named_pattern("square"), 20.0, 20.0)


def test_no_place_is_told_with_its_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    """A ribbon little wider than the gap carries no scale, wherever the pattern lies."""
    monkeypatch.setattr(strip, "MOST_TRIES", 3)
    with pytest.raises(PatternError, match=r"0\.45 mm .* 3 places .*no piece with a scale"):
        clip_strip(fs.named_pattern("square"), 0.45)
    with pytest.raises(PatternError, match=r"The border leaves .* 0\.00999 mm.* the center or the"):
        clip_strip(fs.named_pattern("square"), 20.0, center=(0.0, 4.99))
    for call in (
        lambda: clip_pattern(fs.named_pattern("square"), 300.0, 0.35),
        lambda: clip_strip(fs.named_pattern("square"), 0.35),
    ):
        with pytest.raises(PatternError, match=r"0\.35 mm is no wider than the gap of 0\.4 mm"):
            call()


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

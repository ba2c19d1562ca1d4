"""Curves on the edges of tiles, and what is refused."""

from __future__ import annotations

import json

import numpy as np
import pytest

from flexscale.errors import TilingError
from flexscale.patterns import Pattern
from flexscale.tilings import Tiling, fit_parameters, outline_of
from flexscale.tilings.curves import CURVE_POINTS
from flexscale.tilings.outline import signed_area


def edge_points(tiling: Tiling, edge: int) -> np.ndarray:
    """Points of an edge in its own frame, from (0, 0) to (1, 0), the tile above."""
    points = [tuple(point) for point in tiling.prototile]
    corners = tiling.corners
    first = points.index(tuple(corners[edge]))
    last = points.index(tuple(corners[(edge + 1) % len(corners)]))
    cut = [*points[first:], *points[:first]][: (last - first) % len(points) + 1]
    along = complex(*(corners[(edge + 1) % len(corners)] - corners[edge]))
    places = (np.array(cut) - corners[edge]) @ [1.0, 1.0j] / along
    return np.stack([places.real, places.imag], axis=1)


CURVE = np.array([(0.0, 0.0), (0.3, 0.1), (0.6, 0.02), (1.0, 0.0)])
SPUR = np.array([(0.0, 0.0), (1.5, 0.5), (1.0, 0.0)])  # out over the next edge


@pytest.mark.parametrize(
    ("family", "letter", "followers"),
    [
        # Shifted copy: the partner bulges out where the edge bulges in.
        ("IH01", "a", {0: (False, False), 3: (True, True)}),
        # Glide: edges b, c run the same way.
        ("IH02", "b", {1: (False, False), 2: (False, True)}),
        # Tile with a mirror: its other half, and the shifted copies of both.
        ("IH68", "a", {0: (False, False), 1: (True, False), 2: (True, True), 3: (False, True)}),
    ],
)
def test_partners_follow(family: str, letter: str, followers: dict) -> None:
    tiling = Tiling(family, edges={letter: CURVE})
    for edge, (mirror_x, mirror_y) in followers.items():
        expected = CURVE * (1.0, -1.0 if mirror_y else 1.0)
        if mirror_x:
            expected = (expected * (-1.0, 1.0) + (1.0, 0.0))[::-1]
        assert np.allclose(edge_points(tiling, edge), expected, atol=1e-14)
    for edge in set(range(len(tiling.corners))) - set(followers):
        assert np.allclose(edge_points(tiling, edge), [(0, 0), (1, 0)], atol=1e-14)
    assert signed_area(tiling.prototile) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize(
    ("family", "letter", "half"),
    [
        ("IH04", "b", [(0, 0), (0.3, 0.1), (0.5, 0)]),
        ("IH12", "a", [(0, 0), (0.3, 0.1), (0.5, 0.2)]),
    ],
)
def test_halves_and_wholes(family: str, letter: str, half: list) -> None:
    sign = -1.0 if half[-1][1] == 0 else 1.0
    whole = [*half, (0.7, 0.1 * sign), (1, 0)]
    from_half = Tiling(family, edges={letter: half})
    from_whole = Tiling(family, edges={letter: whole})
    assert np.allclose(from_half.prototile, from_whole.prototile, atol=1e-15)
    edge = [edge.letter for edge in from_half.edge_classes].index(letter)
    assert np.allclose(edge_points(from_half, edge), whole, atol=1e-14)


def test_functions_are_sampled() -> None:
    tiling = Tiling("IH01", edges={"b": lambda t: (t, 0.1 * np.sin(np.pi * t))})
    t = np.linspace(0.0, 1.0, CURVE_POINTS)
    assert np.allclose(tiling.edges["b"], np.stack([t, 0.1 * np.sin(np.pi * t)], axis=1))
    assert len(tiling.prototile) == 6 + 2 * (CURVE_POINTS - 2)
    half = Tiling("IH46", edges={"a": lambda t: (0.5 * t, 0.1 * np.sin(np.pi * t))})
    assert len(half.prototile) == 4 + 2 * (CURVE_POINTS - 1) - 1


def test_a_pattern_keeps_its_curves() -> None:
    curves = {"c": lambda t: (t, 0.1 * np.sin(np.pi * t)), "a": CURVE}
    pattern = Pattern(Tiling("IH01", [0.1, 0.0, 0.05, 0.0], curves))
    config = json.loads(json.dumps(pattern.to_config()))
    assert list(config["edges"]) == ["a", "c"]
    again = Pattern.from_config(config)
    assert again == pattern
    assert again != Pattern(Tiling("IH01", [0.1, 0.0, 0.05, 0.0], {"a": CURVE}))
    assert all(np.array_equal(a, b) for a, b in zip(again.tiles, pattern.tiles, strict=True))
    assert "edges" not in Pattern(Tiling("IH01")).to_config()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"family": "IH94"}, ["'IH94'", "IH01 to IH93"]),
        ({"family": "ih20"}, ["Did you mean 'IH20'"]),
        ({"family": "IH20", "parameters": [0.1]}, ["IH20", "has 0 free", "1 were given"]),
        (
            {"family": "IH17", "parameters": [0.1, 0.2, 0.3]},
            ["IH17", "has 2 free", "stretch, vertex 0 outward", "3 were given"],
        ),
        ({"family": "IH17", "parameters": ["a", "b"]}, ["IH17", "must be finite numbers"]),
        ({"family": "IH17", "parameters": [np.nan, 0]}, ["IH17", "finite"]),
        ({"family": "IH76", "edges": {"a": CURVE}}, ["'a'", "IH76", "mirrors", "straight"]),
        ({"family": "IH01", "edges": {"d": CURVE}}, ["'d'", "a (J), b (J), c (J)"]),
        ({"family": "IH01", "edges": {"a": [(0, 0)]}}, ["'a'", "IH01", "2 to 100000 points"]),
        ({"family": "IH01", "edges": {"a": [(0, 0), (0.5, 0.1)]}}, ["(1, 0)", "(0.5, 0.1)"]),
        ({"family": "IH01", "edges": {"a": [(0, 0.2), (1, 0)]}}, ["(0, 0)", "(0, 0.2)"]),
        (
            {"family": "IH01", "edges": {"a": [(0, 0), (np.inf, 0), (1, 0)]}},
            ["'a'", "IH01", "has the point (inf, 0), number 1: give two finite numbers."],
        ),
        (
            {"family": "IH01", "edges": {"a": lambda t: (t, 0.1 if t < 0.9 else np.nan)}},
            ["(0.90625, nan), number 29", "finite"],
        ),
        ({"family": "IH01", "edges": {"a": [(0, 0), ("x", 0), (1, 0)]}}, ["all finite", "'x'"]),
        ({"family": "IH01", "edges": {"a": [(0, 0), (0, 0), (1, 0)]}}, ["twice", "0 and 1"]),
        ({"family": "IH04", "edges": {"b": CURVE}}, ["'b' (S)", "half turn", "first half"]),
        ({"family": "IH04", "edges": {"b": [(0, 0), (0.5, 0.1)]}}, ["(0.5, 0)", "(0.5, 0.1)"]),
        (
            {"family": "IH12", "edges": {"a": CURVE}},
            ["'a' (U)", "bisector", "(0.3, 0.1) is 0.1 from"],
        ),
        ({"family": "IH12", "edges": {"a": [(0, 0), (0.4, 0.1)]}}, ["x = 0.5", "(0.4, 0.1)"]),
        (
            {"family": "IH41", "edges": {"a": SPUR}},
            ["IH41", "edges 0 (class 'a') and 1 (class 'b')", "(0, 0)", "outline_of"],
        ),
        (
            {
                "family": "IH41",
                "edges": {"a": [(0, 0), (0.7, 0.1), (0.7, -0.1), (0.3, 0.1), (1, 0)]},
            },
            ["edge 0 (class 'a')", "itself"],
        ),
        ({"family": "IH41", "parameters": [0.9, 0]}, ["IH41", "(0.9, 0)", "clockwise"]),
        (
            {"family": "IH01", "parameters": [0, 0, 3, 0]},
            ["IH01", "(0, 0, 3, 0)", "cross or touch"],
        ),
    ],
)
def test_refusals_say_what_to_do(arguments: dict, words: list[str]) -> None:
    with pytest.raises(TilingError) as caught:
        Tiling(**arguments)
    assert [word for word in words if word not in str(caught.value)] == [], str(caught.value)


def test_outline_of_what_is_no_tile() -> None:
    outline = outline_of("IH41", edges={"a": SPUR})
    assert np.allclose(outline[1] - outline[0], SPUR[1])
    assert signed_area(outline) == pytest.approx(1.0)
    assert np.array_equal(outline_of("IH41", [0.1, 0.0]), Tiling("IH41", [0.1, 0.0]).prototile)


@pytest.mark.parametrize(
    ("family", "corners", "words"),
    [
        ("IH76", [(0, 0), (2, 0), (2, 1), (0, 1)], ["IH76", "away"]),
        ("IH01", [(0, 0), (1, 0), (1, 1)], ["6 vertices", "(3, 2)"]),
        ("IH41", [(0, 0), (1, 0), (2, 0), (3, 0)], ["IH41", "no area"]),
    ],
)
def test_polygons_that_do_not_fit(family: str, corners: list, words: list[str]) -> None:
    with pytest.raises(TilingError) as caught:
        fit_parameters(family, corners)
    assert all(word in str(caught.value) for word in words)

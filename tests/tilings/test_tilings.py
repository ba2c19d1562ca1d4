"""Families of tilings: what the list of types says, tiles that cover the plane, parameters."""

from __future__ import annotations

import json
from importlib.resources import files

import numpy as np
import pytest

from flexscale.tilings import Family, Tiling, families, fit_parameters
from flexscale.tilings.geometry import family_geometry
from flexscale.tilings.group import edge_motion
from flexscale.tilings.outline import signed_area
from flexscale.tilings.shape_space import build_shape_space
from tests.tilings.tiling_checks import assert_covers_plane, flat_curves

ALL = pytest.mark.parametrize("family", families(), ids=lambda family: family.name)
TABLE = json.loads(files("flexscale.tilings").joinpath("isohedral_types.json").read_text())
POINT_GROUP_ORDERS = {
    "p1": 1, "p2": 2, "pm": 2, "pg": 2, "cm": 2, "pmm": 4, "pmg": 4, "pgg": 4, "cmm": 4, "p3": 3,
    "p3m1": 6, "p31m": 6, "p4": 4, "p4m": 8, "p4g": 8, "p6": 6, "p6m": 12,
}  # fmt: skip


def small_parameters(family: Family, seed: int) -> np.ndarray:
    """Parameters that move the vertices visibly, but far less than they are apart."""
    return np.random.default_rng(seed).uniform(-0.08, 0.08, family.n_parameters)


@ALL
def test_symbol_gives_what_the_list_says(family: Family) -> None:
    entry = TABLE[family.name]
    geometry = family_geometry(family.name)
    assert len(geometry.space.names) == entry["parameters"] == family.n_parameters
    assert "".join(edge.kind for edge in family.edge_classes) == entry["edge_classes"]
    turns_only = int(entry["stabiliser"][1:])
    order = turns_only if entry["stabiliser"][0] == "c" else 2 * turns_only
    assert len(geometry.group.symmetries) == order
    assert len(geometry.group.linear_parts) == POINT_GROUP_ORDERS[entry["group"]]
    assert len(geometry.group.aspects) * order == POINT_GROUP_ORDERS[entry["group"]]
    reflects = any(part.reverses for part in geometry.group.linear_parts)
    assert reflects == (entry["group"] not in ("p1", "p2", "p3", "p4", "p6"))


def test_list_of_families() -> None:
    names = [family.name for family in families()]
    assert names == [f"IH{number:02d}" for number in range(1, 94)]
    marked = [family.name for family in families() if family.needs_marking]
    assert [int(name[2:]) for name in marked] == [
        19, 35, 48, 60, 63, 65, 70, 75, 80, 87, 89, 92,
    ]  # fmt: skip
    assert repr(families()[63]) == (
        "<Family IH64: pm, net 4.4.4.4, edges a:I b:U a:I b:U, 1 parameter(s)>"
    )


@ALL
def test_default_tiles_cover_the_plane(family: Family) -> None:
    tiling = Tiling(family.name)
    assert tiling.parameters == (0.0,) * family.n_parameters
    assert len(tiling.corners) == len(family.net)
    # Laves tile: interior angles 2π/degree.
    forward = np.roll(tiling.corners, -1, axis=0) - tiling.corners
    backward = np.roll(forward, 1, axis=0)
    turns = np.arctan2(
        backward[:, 0] * forward[:, 1] - backward[:, 1] * forward[:, 0],
        np.sum(backward * forward, axis=1),
    )
    assert np.allclose(180.0 - np.degrees(turns), 360.0 / np.array(family.net), atol=1e-11)
    assert_covers_plane(tiling)


@ALL
def test_curved_tiles_cover_the_plane(family: Family) -> None:
    tiling = Tiling(family.name, small_parameters(family, 1), flat_curves(family))
    assert_covers_plane(tiling)
    for aspect, tile in zip(tiling.aspects, tiling.tiles, strict=True):
        image = aspect.apply(tiling.prototile)
        assert np.array_equal(tile, image[::-1] if aspect.reverses else image)
        assert signed_area(tile) > 0.0
    corners = {tuple(point) for point in tiling.prototile}
    assert all(tuple(corner) in corners for corner in tiling.corners)


def test_lattice_is_reduced() -> None:
    for family in families():
        t1, t2 = Tiling(family.name, small_parameters(family, 2)).lattice
        assert np.linalg.norm(t1) <= np.linalg.norm(t2) + 1e-12
        assert abs(t1 @ t2) <= 0.5 * t1 @ t1 + 1e-12
        assert t1[0] * t2[1] - t1[1] * t2[0] > 0.0


def test_hexagon_and_square_stand_as_they_always_did() -> None:
    hexagon, square = Tiling("IH20"), Tiling("IH76")
    assert np.array_equal(square.lattice, np.eye(2))
    assert np.array_equal(square.tiles[0], [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
    inradius = np.sqrt(1.0 / (2.0 * np.sqrt(3.0)))
    lattice = inradius * np.array([(2.0, 0.0), (1.0, np.sqrt(3.0))])
    assert np.allclose(hexagon.lattice, lattice, rtol=0, atol=1e-15)
    assert hexagon.lattice[0, 1] == 0.0
    angles = np.degrees(np.arctan2(*hexagon.corners.T[::-1])) % 360.0
    assert np.allclose(np.sort(angles), np.arange(30.0, 360.0, 60.0))
    assert (hexagon.pattern_name, square.pattern_name) == ("hexagon", "square")
    assert Tiling("IH07").pattern_name == "IH07"


@ALL
def test_x_runs_along_a_lattice_vector(family: Family) -> None:
    tiling = Tiling(family.name)
    steps = np.array([(p, q) for p in range(-4, 5) for q in range(-4, 5) if p or q])
    vectors = steps @ tiling.lattice
    level = np.abs(vectors[:, 1]) < 1e-12
    assert (level & (vectors[:, 0] > 0.0)).any()
    linear_parts = family_geometry(family.name).group.linear_parts
    axes = [7.5 * part.turn for part in linear_parts if part.reverses]
    assert not axes or any(axis % 90.0 == 0.0 for axis in axes)
    # Not only for parameters 0: the directions of mirrors and glides belong to the family.
    if family.group in ("pm", "pg", "pmm", "pmg", "pgg"):
        changed = Tiling(family.name, small_parameters(family, 3)).lattice
        assert np.abs(changed).min(axis=1).max() < 1e-12


@ALL
def test_patterns_of_the_parameters(family: Family) -> None:
    space = family_geometry(family.name).space
    patterns = space.patterns
    flat = patterns.reshape(-1, 2 * len(family.net)) / np.sqrt(len(family.net))
    assert np.allclose(flat @ flat.T, np.eye(len(patterns)), atol=1e-12)
    assert np.allclose(patterns.sum(axis=1), 0.0, atol=1e-12)
    assert np.allclose(flat @ space.laves.ravel(), 0.0, atol=1e-12)
    assert np.allclose(flat @ space.projector, flat, atol=1e-12)


@ALL
def test_patterns_do_not_hang_on_linear_algebra(family: Family) -> None:
    """Conditions in another order and weight give another basis of the same null space."""
    geometry = family_geometry(family.name)
    motions = [
        (edges, edge_motion(family.net, geometry.facing, edges))
        for edges in geometry.symbol.edge_motions
    ]
    again = build_shape_space(geometry.space.laves, [*motions[::-1], *motions[:2]])
    assert again.names == geometry.space.names
    assert np.allclose(again.patterns, geometry.space.patterns, rtol=0, atol=1e-11)


def test_stretch_and_shear_of_a_square() -> None:
    """Corners (±1/2, ±1/2) move by (x, -y) √2 per unit of stretch, by (y, x) √2 of shear."""
    wide = Tiling("IH41", [0.1, 0.0])
    ratio = (1.0 + 0.1 * np.sqrt(2.0)) / (1.0 - 0.1 * np.sqrt(2.0))
    assert wide.parameter_names == ("stretch", "shear")
    assert np.ptp(wide.corners, axis=0) == pytest.approx([ratio**0.5, ratio**-0.5])
    leaning = Tiling("IH41", [0.0, 0.1])
    diagonals = leaning.corners[2:] - leaning.corners[:2]
    assert sorted(np.linalg.norm(diagonals, axis=1) ** 2) == pytest.approx(
        [2.0 / ratio, 2.0 * ratio]
    )


def test_parameters_are_a_tenth_of_the_size() -> None:
    """The moved vertices are 0.1 from where they were in the root mean square, before scaling."""
    for family in families():
        space = family_geometry(family.name).space
        for k in range(family.n_parameters):
            moved = space.vertices(tuple(0.1 * np.eye(family.n_parameters)[k])) - space.laves
            assert np.sqrt(np.mean(np.sum(moved**2, axis=1))) == pytest.approx(0.1, rel=1e-12)


def test_brick_from_its_corners() -> None:
    brick = [(2, 0), (2, 1), (1, 1), (0, 1), (0, 0), (1, 0)]
    tiling = Tiling("IH17", fit_parameters("IH17", brick))
    assert np.allclose(tiling.corners * np.sqrt(2.0), np.array(brick) - (1.0, 0.5), atol=1e-12)
    assert np.allclose(np.abs(tiling.lattice) * np.sqrt(2.0), [(1, 1), (1, 1)], atol=1e-12)


@ALL
def test_parameters_found_again_from_corners(family: Family) -> None:
    parameters = small_parameters(family, 4)
    corners = Tiling(family.name, parameters).corners
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    placed = 7.0 * corners @ turn.T + (3.0, -50.0)
    assert np.allclose(fit_parameters(family.name, placed), parameters, atol=1e-9)
    assert np.allclose(fit_parameters(family.name, placed * (-1.0, 1.0)), parameters, atol=1e-9)

"""The drawn symmetry does not depend on how a tiling is given, and directions obey it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from flexscale.tilings import Family, Tiling, families
from flexscale.tilings.bravais import multiply, reduced_lattice
from flexscale.tilings.drawn_symmetry import drawn_symmetry, primitive_cell
from tests.sampling import every
from tests.tilings.drawn_tilings import DRAWN
from tests.tilings.wallpaper_samples import AXES, GENERATORS, orbit_tiling

MANY = settings(max_examples=50, deadline=None, suppress_health_check=list(HealthCheck))
FEW = settings(MANY, max_examples=3)
#: Where the curve of an edge has its points; of S and U edges its first half.
CURVE_X = {"J": (0.0, 0.3, 0.6, 1.0), "S": (0.0, 0.2, 0.33, 0.5), "U": (0.0, 0.2, 0.33, 0.5)}
SEEDS = st.integers(0, 2**32 - 1)
CELLS = st.lists(st.integers(-2, 2), min_size=4, max_size=4).filter(
    lambda m: 0 < abs(m[0] * m[3] - m[1] * m[2]) <= 3
)


def given_otherwise(tiles, lattice, cell, rng):
    """The tiling turned, moved, on a supercell, with other first corners and representatives."""
    angle = rng.uniform(0.0, 360.0)
    c, s = np.cos(np.deg2rad(angle)), np.sin(np.deg2rad(angle))
    lattice = np.array(lattice, dtype=float) @ np.array([[c, s], [-s, c]])
    move = rng.uniform(-30.0, 30.0, 2)
    wide = np.reshape(cell, (2, 2))
    n_copies = abs(round(np.linalg.det(wide)))
    copies = []
    for step in np.mgrid[-8:9, -8:9].reshape(2, -1).T:
        inside = step @ np.linalg.inv(wide) + 1e-9
        if np.all(np.floor(inside) == 0):
            copies.append(step)
    assert len(copies) == n_copies
    drawn = []
    for tile in tiles:
        for step in copies:
            polygon = np.array(tile, dtype=float) @ np.array([[c, s], [-s, c]]) + move
            polygon += step @ lattice + rng.integers(-2, 3, 2) @ wide @ lattice
            at = rng.integers(len(polygon))
            extra = polygon[at - 1] + rng.uniform(0.1, 0.9) * (polygon[at] - polygon[at - 1])
            polygon = np.roll(np.insert(polygon, at, extra, axis=0), rng.integers(9), axis=0)
            drawn.append(polygon[:: rng.choice([-1, 1])])
    order = rng.permutation(len(drawn))
    return [drawn[k] for k in order], wide @ lattice, lattice, angle


def check_however_given(group: str, seed: int, cell: list[int]) -> None:
    rng = np.random.default_rng(seed)
    tiles, lattice = orbit_tiling(group, rng.random((3, 2)))
    centerings = 2 if group in ("cm", "cmm") else 1
    drawn, wide, lattice, angle = given_otherwise(tiles, lattice, cell, rng)
    symmetry = drawn_symmetry(drawn, wide)
    assert symmetry.group == group
    copies = len(drawn) // len(tiles)
    assert symmetry.n_primitive_cells == centerings * copies
    whole = lattice @ np.linalg.inv(symmetry.primitive_lattice)
    assert np.allclose(whole, np.rint(whole), atol=1e-7)
    assert round(np.linalg.det(whole)) == centerings
    for found, expected in zip(
        (symmetry.mirror_axes, symmetry.glide_axes), AXES.get(group, ([], [])), strict=True
    ):
        turned = np.sort((np.array(expected, dtype=float) + angle) % 180.0)
        apart = np.array(found) - turned
        assert len(found) == len(turned)
        assert np.all(np.abs((apart + 90.0) % 180.0 - 90.0) < 1e-7)
    kept, primitive = primitive_cell(drawn, wide)
    assert len(kept) * centerings * copies == len(drawn)
    again = drawn_symmetry(kept, primitive)
    assert (again.group, again.n_primitive_cells) == (group, 1)
    assert np.allclose(again.primitive_lattice, symmetry.primitive_lattice)


@pytest.mark.parametrize("group", GENERATORS)
@FEW
@given(SEEDS, CELLS)
def test_however_given(group: str, seed: int, cell: list[int]) -> None:
    check_however_given(group, seed, cell)


@pytest.mark.slow
@pytest.mark.parametrize("group", GENERATORS)
@MANY
@given(SEEDS, CELLS)
def test_however_given_many_times(group: str, seed: int, cell: list[int]) -> None:
    check_however_given(group, seed, cell)


def check_generic_tiles(family: Family, seed: int) -> None:
    """Random shapes and curves leave 81 types just their own group, and the 12 others more."""
    rng = np.random.default_rng(seed)
    curves = {
        letter: np.stack([CURVE_X[kind], [0.0, *rng.uniform(-0.05, 0.05, 2), 0.0]], axis=1)
        for letter, kind in family.curve_kinds().items()
        if kind != "I"
    }
    tiling = Tiling(family.name, rng.uniform(-0.05, 0.05, family.n_parameters), curves)
    symmetry = drawn_symmetry(tiling.tiles, tiling.lattice)
    as_typed = symmetry.group == family.group and symmetry.n_primitive_cells == 1
    assert as_typed == (not family.needs_marking)
    for aspect in tiling.aspects:
        apart = [np.abs(aspect.linear - o.linear).max() for o in symmetry.operations]
        operation = symmetry.operations[int(np.argmin(apart))]
        assert min(apart) < 1e-9
        steps = (aspect.translation - operation.translation) @ np.linalg.inv(
            symmetry.primitive_lattice
        )
        # An aspect may map the tile by another of its own symmetries: then it is no translate.
        if family.stabiliser == "c1" and as_typed:
            assert np.allclose(steps, np.rint(steps), atol=1e-6)


@pytest.mark.parametrize("family", every(4, families()), ids=lambda family: family.name)
@settings(FEW, max_examples=1)
@given(SEEDS)
def test_generic_tiles_show_the_group_of_their_type(family: Family, seed: int) -> None:
    check_generic_tiles(family, seed)


@pytest.mark.slow
@pytest.mark.parametrize("family", families(), ids=lambda family: family.name)
@settings(MANY, max_examples=10)
@given(SEEDS)
def test_many_generic_tiles_show_the_group_of_their_type(family: Family, seed: int) -> None:
    check_generic_tiles(family, seed)


@pytest.mark.parametrize("name", DRAWN)
@FEW
@given(SEEDS, st.lists(st.floats(0.0, 180.0), min_size=3, max_size=3))
def test_equivalent_directions_see_the_same_edges(
    name: str, seed: int, directions: list[float]
) -> None:
    """Σ |e·n|³ over the cell's edges e changes with the direction n unless symmetry forbids it."""
    tiles, lattice, *_ = DRAWN[name]
    rng = np.random.default_rng(seed)
    drawn, wide, _, _ = given_otherwise(tiles, lattice, [1, 0, 0, 1], rng)
    symmetry = drawn_symmetry(drawn, wide)
    arms = [np.roll(tile, -1, axis=0) - tile for tile in merged(drawn)]
    edges = np.concatenate(arms)

    def seen(direction: float) -> float:
        n = (np.cos(np.deg2rad(direction)), np.sin(np.deg2rad(direction)))
        return float(np.sum(np.abs(edges @ n) ** 3))

    for direction in directions:
        assert seen(symmetry.equivalent(direction)[0]) == pytest.approx(seen(direction))
        for image in symmetry.expand([direction]):
            assert seen(image.direction) == pytest.approx(seen(direction))


def merged(tiles):
    """Tiles without corners on straight edges."""
    for tile in tiles:
        arms = np.roll(tile, -1, axis=0) - tile
        before = np.roll(arms, 1, axis=0)
        cross = before[:, 0] * arms[:, 1] - before[:, 1] * arms[:, 0]
        yield tile[np.abs(cross) > 1e-9]


@pytest.mark.parametrize(
    "name", ["hexagons", "squares", "cairo", "cubes", "running bond, two rows"]
)
@FEW
@given(SEEDS, st.floats(-7.0, -4.0))
def test_noise_near_the_tolerance_still_leaves_a_group(
    name: str, seed: int, exponent: float
) -> None:
    tiles, lattice, group, *_ = DRAWN[name]
    rng = np.random.default_rng(seed)
    size = np.sqrt(abs(np.linalg.det(np.array(lattice))) / len(tiles))
    noise = size * 10.0**exponent
    noisy = [np.array(tile) + rng.normal(0.0, noise, np.shape(tile)) for tile in tiles]
    symmetry = drawn_symmetry(noisy, lattice)
    assert symmetry.group in GENERATORS
    basis = reduced_lattice(symmetry.primitive_lattice)
    matrices = {
        tuple(map(tuple, np.rint(basis @ o.linear.T @ np.linalg.inv(basis)).astype(int).tolist()))
        for o in symmetry.operations
    }
    assert all(multiply(one, two) in matrices for one in matrices for two in matrices)
    if exponent < -6.7:
        assume(np.abs(np.concatenate(noisy) - np.concatenate(tiles)).max() < 0.2e-6 * size)
        assert symmetry.group == group

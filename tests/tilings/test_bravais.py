"""Plane lattices: reduced bases, superlattices, point groups."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from flexscale.tilings.bravais import (
    closed_part,
    common_axis,
    lattice_operations,
    multiply,
    reduced_lattice,
    row_basis,
)

LATTICES = {  # name -> (reduced basis, order of its point group)
    "oblique": ([(1.0, 0.0), (0.23, 1.1)], 2),
    "rectangular": ([(1.0, 0.0), (0.0, 1.37)], 4),
    "long centered": ([(1.0, 0.0), (0.5, 1.9)], 4),
    "rhombic": ([(1.0, 0.0), (0.28, 0.96)], 4),
    "square": ([(1.0, 0.0), (0.0, 1.0)], 8),
    "hexagonal": ([(1.0, 0.0), (0.5, 0.5 * np.sqrt(3.0))], 12),
}


@pytest.mark.parametrize("name", LATTICES)
@pytest.mark.parametrize(
    "change",
    [[(1, 0), (0, 1)], [(0, 1), (1, 0)], [(1, 1), (0, 1)], [(-1, 0), (7, 1)], [(5, 3), (3, 2)],
     [(-89, 144), (55, -89)]],
)  # fmt: skip
def test_reduced_basis_does_not_depend_on_the_given_one(name: str, change) -> None:
    basis = np.array(LATTICES[name][0])
    assert np.allclose(reduced_lattice(np.array(change) @ basis), basis, atol=1e-10)


def test_reduced_basis_is_exact_where_nothing_is_to_do() -> None:
    basis = np.array(LATTICES["hexagonal"][0]) * np.pi
    assert np.array_equal(reduced_lattice(basis), basis)
    assert np.array_equal(reduced_lattice(basis[::-1]), basis)


@pytest.mark.parametrize("name", LATTICES)
@pytest.mark.parametrize("degrees", [0.0, 30.0, 77.7])
def test_point_groups(name: str, degrees: float) -> None:
    basis, order = np.array(LATTICES[name][0]), LATTICES[name][1]
    c, s = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
    basis = reduced_lattice(basis @ np.array([[c, s], [-s, c]]))
    found = lattice_operations(basis, 1e-9)
    assert len(found) == order
    assert found[0].matrix == ((1, 0), (0, 1))
    known = {operation.matrix: operation for operation in found}
    for one, other in itertools.product(found, repeat=2):
        product = known[multiply(one.matrix, other.matrix)]
        assert np.allclose(other.linear @ one.linear, product.linear, atol=1e-14)
    for operation in found:
        image = np.array(operation.matrix) @ basis
        assert np.allclose(basis @ operation.linear.T, image, atol=1e-12)


def test_almost_square_is_not_square() -> None:
    basis = np.array([(1.0, 0.0), (0.0, 1.001)])
    assert len(lattice_operations(basis, 1e-6)) == 4
    assert len(lattice_operations(basis, 1e-2)) == 8


@pytest.mark.parametrize("seed", range(20))
def test_a_tolerance_as_wide_as_the_distortion_still_leaves_a_group(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for name in ("square", "hexagonal"):
        basis = reduced_lattice(np.array(LATTICES[name][0]) + rng.normal(0.0, 1e-3, (2, 2)))
        for tolerance in np.geomspace(1e-4, 1e-2, 30):
            matrices = {operation.matrix for operation in lattice_operations(basis, tolerance)}
            assert all(multiply(one, two) in matrices for one in matrices for two in matrices)


@pytest.mark.parametrize(
    ("rows", "basis"),
    [
        ([(4, 0), (0, 4)], ((4, 0), (0, 4))),
        ([(2, 2), (4, 0), (0, 4)], ((2, 2), (0, 4))),
        ([(0, 3), (3, 0), (0, 6), (6, 0)], ((3, 0), (0, 3))),
        ([(6, 4), (9, 1), (12, 0), (0, 12)], None),
    ],
)
def test_row_basis(rows, basis) -> None:
    found = np.array(row_basis(rows))
    if basis:
        assert abs(np.linalg.det(found)) == pytest.approx(abs(np.linalg.det(np.array(basis))))
    combos = np.array(rows) @ np.linalg.inv(found)
    assert np.allclose(combos, np.rint(combos))
    minors = [a * d - b * c for (a, b), (c, d) in itertools.combinations(rows, 2)]
    assert abs(round(np.linalg.det(found))) == np.gcd.reduce(minors)


def test_closed_part_drops_what_does_not_close() -> None:
    def add(one: int, other: int) -> int:
        return (one + other) % 12

    assert closed_part([0, 3, 6, 9], add) == [0, 3, 6, 9]
    assert closed_part([0, 3, 4, 8], add) == [0, 4, 8]
    assert closed_part([0, 3, 9], add) == [0]


def test_common_axis() -> None:
    assert common_axis([0.0, 60.0, 119.99999999999999], 60.0) == 0.0
    assert common_axis([59.9999, 0.0001], 60.0) == pytest.approx(0.0, abs=1e-9)
    assert common_axis([17.2, 62.2, 107.2], 45.0) == pytest.approx(17.2)

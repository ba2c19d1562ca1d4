"""The symmetry of a tiling as drawn: of its outlines, whatever they are called.

An isometry of the tiling keeps the lattice of all its translations, so its linear part is one of
the few that this primitive lattice has. It carries the first tile onto some tile of the cell, which
fixes its translation up to lattice vectors. Each such candidate is checked on all tiles. The
translations themselves come first: a shift that is not a lattice vector moves every tile class to
another, so its order divides their number N, and it is a whole multiple of 1/N of the lattice.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from flexscale.arrays import BoolArray, FloatArray, IntArray
from flexscale.errors import TilingError
from flexscale.tilings.bravais import (
    LatticeOperation,
    closed_part,
    lattice_operations,
    multiply,
    reduced_lattice,
    row_basis,
)
from flexscale.tilings.congruence import PlacedTiles
from flexscale.tilings.wallpaper import DrawnSymmetry, Reflection, SymmetryOperation, group_name
from flexscale.units import require_positive

TOLERANCE = 1e-6  # of the root of a tile's mean area
AREA_TOLERANCE = 1e-3  # relative: a tile too many or too few
JUST_BELOW = 1e-9  # a fraction this little below 1 is 1


def drawn_symmetry(
    tiles: Sequence[ArrayLike],
    lattice: ArrayLike,
    *,
    tolerance: float = TOLERANCE,
    marks: Sequence[float] | None = None,
) -> DrawnSymmetry:
    """Find the wallpaper group of a tiling from the shapes of its tiles alone.

    Parameters
    ----------
    tiles : simple polygons (n_i, 2), one per lattice class, in either orientation; corners on
        straight edges do not count, curved edges come as many corners.
    lattice : (2, 2) rows t1, t2.
    tolerance : how far an image may lie off, in roots of a tile's mean area.
    marks : one for each tile, which a symmetry keeps; None if there are none.

    Raises
    ------
    TilingError : no polygons, no lattice, or areas that do not add up to that of the cell.
    UnitRangeError : the tolerance is not a positive number.
    """
    _, given = _checked(tiles, lattice, marks)
    cell = _primitive(given, tolerance)
    basis = cell.placed.lattice
    shifts: dict[LatticeOperation, FloatArray] = {}
    for candidate in lattice_operations(basis, cell.placed.tolerance):
        moves = cell.placed.centroids - candidate.linear @ cell.placed.centroids[0]
        for shift in moves[cell.placed.may_be_kept(candidate.linear, moves)]:
            if cell.placed.are_kept(candidate.linear, shift):
                shifts[candidate] = shift
                break
    by_matrix = {candidate.matrix: candidate for candidate in shifts}
    group = [by_matrix[matrix] for matrix in closed_part(list(by_matrix), multiply)]
    cosets = [_reflection(one, shifts[one], basis) if one.reverses else None for one in group]
    reflections = [coset for coset in cosets if coset]
    return DrawnSymmetry(
        group=group_name(len(group) - len(reflections), reflections),
        primitive_lattice=basis,
        n_primitive_cells=cell.n_cells,
        operations=tuple(
            SymmetryOperation(
                one.linear,
                _into_cell(shifts[one], basis),
                coset.kind if coset else "rotation",
                one.angle,
            )
            for one, coset in zip(group, cosets, strict=True)
        ),
        mirror_axes=tuple(coset.axis for coset in reflections if coset.has_mirrors),
        glide_axes=tuple(coset.axis for coset in reflections if coset.has_glides),
    )


def primitive_cell(
    tiles: Sequence[ArrayLike], lattice: ArrayLike, *, tolerance: float = TOLERANCE
) -> tuple[tuple[FloatArray, ...], FloatArray]:
    """The same tiling on its primitive cell: fewer tiles if the given cell repeats itself.

    Parameters and errors as in `drawn_symmetry`.

    Returns
    -------
    tiles : the first of every class of tiles, where and as it was given.
    lattice : (2, 2) reduced basis, right-handed. A cell that is primitive keeps its lattice.
    """
    polygons, given = _checked(tiles, lattice)
    cell = _primitive(given, tolerance)
    kept = tuple(polygons[tile] for tile in cell.kept)
    return kept, (given.lattice if cell.n_cells == 1 else cell.placed.lattice)


@dataclass(frozen=True, eq=False)
class _PrimitiveCell:
    """Tiles on the primitive lattice, which of the given ones they are, how many such cells fit."""

    placed: PlacedTiles
    kept: list[int]
    n_cells: int


def _primitive(given: PlacedTiles, tolerance: float) -> _PrimitiveCell:
    n = len(given)
    size = float(np.sqrt(abs(np.linalg.det(given.lattice)) / n))
    basis = reduced_lattice(given.lattice)
    placed = given.on(basis, require_positive(tolerance, "tolerance", "") * size)
    rows = _translations(placed)
    if not rows:
        return _PrimitiveCell(placed, list(range(n)), 1)
    whole = np.array(row_basis([*rows, (n, 0), (0, n)]))
    primitive = reduced_lattice(whole @ basis / n)
    repeated = placed.on(primitive, placed.tolerance)
    kept: list[int] = []
    known: set[int] = set()
    for tile in range(n):
        if tile not in known:
            kept.append(tile)
            known.update(repeated.copies(tile))
    fewer = placed.on(primitive, placed.tolerance, kept)
    return _PrimitiveCell(fewer, kept, n * n // int(whole[0, 0] * whole[1, 1]))


def _translations(placed: PlacedTiles) -> list[tuple[int, int]]:
    """Shifts that generate those that keep the tiles, in n-th parts of the lattice vectors.

    What those found so far generate is not tried again: of n shifts few are.
    """
    n = len(placed)
    steps = (placed.centroids - placed.centroids[0]) @ np.linalg.inv(placed.lattice)
    shifts = np.rint(n * steps).astype(int)
    shifts = shifts[placed.may_be_kept(np.eye(2), shifts @ placed.lattice / n)]
    found: list[tuple[int, int]] = []
    while len(shifts := shifts[~_generated(found, n, shifts)]):
        (p, q), shifts = shifts[0].tolist(), shifts[1:]
        more = [*found, (p % n, q % n)]
        if all(
            placed.are_kept(np.eye(2), np.array(row) @ placed.lattice / n)
            for row in [(p, q), *row_basis([*more, (n, 0), (0, n)])]
        ):
            found = more
    return found


def _generated(rows: list[tuple[int, int]], n: int, shifts: IntArray) -> BoolArray:
    """Which shifts (m, 2) rows generate, all in n-th parts of the lattice vectors."""
    (a, b), (_, d) = row_basis([*rows, (n, 0), (0, n)])
    times, rest = np.divmod(shifts[:, 0], a)
    generated: BoolArray = (rest == 0) & ((shifts[:, 1] - times * b) % d == 0)
    return generated


def _reflection(operation: LatticeOperation, shift: FloatArray, basis: FloatArray) -> Reflection:
    twice = np.rint((shift + operation.linear @ shift) @ np.linalg.inv(basis))
    return Reflection(operation.matrix, (int(twice[0]), int(twice[1])), operation.angle)


def _into_cell(shift: FloatArray, basis: FloatArray) -> FloatArray:
    """Shift in the cell of the basis; a hair below a lattice vector counts as one."""
    fractions = shift @ np.linalg.inv(basis)
    return shift - np.floor(fractions + JUST_BELOW) @ basis


def _checked(
    tiles: Sequence[ArrayLike], lattice: ArrayLike, marks: Sequence[float] | None = None
) -> tuple[list[FloatArray], PlacedTiles]:
    """Polygons, and the tiles that they are on their lattice."""
    try:
        polygons = [np.array(tile, dtype=float) for tile in tiles]
        cell = np.array(lattice, dtype=float)
    except (TypeError, ValueError):
        polygons, cell = [], np.empty(0)
    if not polygons or any(p.ndim != 2 or p.shape[1] != 2 or len(p) < 3 for p in polygons):
        raise TilingError("Symmetry needs tiles as lists of three or more (x, y) corners.")
    if cell.shape != (2, 2) or not all(np.isfinite(array).all() for array in (cell, *polygons)):
        raise TilingError("Symmetry needs finite corners and a lattice of two (x, y) vectors.")
    area = abs(float(np.linalg.det(cell)))
    placed = PlacedTiles(polygons, cell, 0.0, marks)
    total = float(placed.areas.sum())
    if area == 0.0 or abs(total - area) > AREA_TOLERANCE * area:
        raise TilingError(
            f"The tiles' areas add up to {total:.6g}, but the lattice's cell has {area:.6g}: give "
            "one polygon per lattice class."
        )
    return polygons, placed

"""A tiling that is symmetric to the digits somebody typed, made exactly symmetric.

In a basis of the primitive lattice every symmetry is x -> x W + t with whole numbers W. Its group
fixes t up to the place of the origin: about the right one, t is a whole multiple of 1/N, N the
order of the point group. So both are exact once they are known roughly. The lattice becomes the
nearest one that all W keep, a vertex the mean of the images that should be it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import shapely
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from flexscale.arrays import FloatArray, IntArray
from flexscale.errors import PatternError
from flexscale.patterns.cell import TiledCell, build_cell, sharp_corners
from flexscale.patterns.corners import ROUNDING, corner_classes, split_like
from flexscale.patterns.drawing import Drawing
from flexscale.tilings.bravais import NICE_ANGLE, closed_part, multiply
from flexscale.tilings.drawn_symmetry import drawn_symmetry
from flexscale.tilings.wallpaper import DrawnSymmetry, SymmetryOperation

EXACT = 1e-12  # of a tile's size: what is symmetric to this stays as it is, to the last bit
AS_IT_IS = 1e-8  # of a tile's size: symmetric without more ado
NEAR = 1e-3  # of a tile's size: a tiling this near to a more symmetric one is told
Matrix = tuple[tuple[int, int], tuple[int, int]]


@dataclass(frozen=True)
class Symmetrized:
    """A tiling with a symmetry that it had roughly.

    Attributes
    ----------
    cell : exactly symmetric.
    group : short name of the wallpaper group.
    order : number of its elements modulo the given lattice's translations.
    off : mm, the farthest that a corner or a lattice vector has been moved.
    mean : mm, the root of the mean square that they have been.
    """

    cell: TiledCell
    group: str
    order: int
    off: float
    mean: float

    def is_within(self, limit: float) -> bool:
        """Whether nothing has been moved farther than a limit [mm], and most by half of it."""
        return self.off <= limit and self.mean <= 0.5 * limit


def symmetrized(cell: TiledCell, tolerance: float, limit: float) -> Symmetrized | None:
    """The tiling with all symmetry that it has to a tolerance [mm]; None if there is no such way.

    A tiling that is exactly symmetric already is returned as it is. Axes are turned to whole
    multiples of 15° where that moves nothing by more than a limit [mm].
    """
    drawn = drawn_symmetry(cell.tiles, cell.lattice, tolerance=tolerance / cell.size)
    order = drawn.point_group_order * drawn.n_primitive_cells
    if order == 1:
        return Symmetrized(cell, drawn.group, 1, 0.0, 0.0)
    vertices = _Vertices.of(cell)
    primitive = vertices.modulo(drawn.primitive_lattice, drawn.n_primitive_cells, tolerance)
    if primitive is None:
        return None
    group = _Group.of(drawn, primitive)
    if group is None:
        return None
    fractions = group.averaged(primitive)
    if fractions is None:
        return None
    moved = [
        _placed(cell, vertices, primitive, fractions - group.origin, basis)
        for basis in _exact_bases(primitive.basis, group)
    ]
    best = next((one for one in moved if one.is_within(limit)), moved[-1])
    if best.off < EXACT * cell.size:
        best = replace(best, cell=cell)
    return replace(best, group=drawn.group, order=order)


@dataclass(frozen=True)
class _Vertices:
    """Vertices of a tiling on its torus, and where the tiles' corners are on them."""

    points: FloatArray  # (n, 2) mm, one corner of each class
    lattice: FloatArray
    labels: IntArray  # (n_corners,) vertex of each corner
    offsets: IntArray  # (n_corners, 2) lattice vector from the vertex to the corner

    @classmethod
    def of(cls, cell: TiledCell) -> _Vertices:
        corners = np.concatenate(cell.tiles)
        labels = np.concatenate(
            corner_classes(list(cell.tiles), cell.lattice, ROUNDING * cell.size)
        )
        points = corners[np.unique(labels, return_index=True)[1]]
        steps = (corners - points[labels]) @ np.linalg.inv(cell.lattice)
        return cls(points, cell.lattice, labels, np.rint(steps).astype(np.int64))

    def modulo(self, basis: FloatArray, n_cells: int, tolerance: float) -> _Primitive | None:
        """The vertices modulo the translations of the tiling."""
        n = len(self.points)
        fractions = self.points @ np.linalg.inv(basis)
        orbit = np.arange(n)
        if n_cells > 1:
            home = self.points @ np.linalg.inv(self.lattice)
            steps = basis @ np.linalg.inv(self.lattice)
            partners = [_matched(home + step, home, self.lattice, tolerance) for step in steps]
            if any(partner is None for partner in partners):
                return None
            ends = np.concatenate([partner for partner in partners if partner is not None])
            graph = coo_array((np.ones(2 * n), (np.tile(orbit, 2), ends)), shape=(n, n))
            orbit = connected_components(graph, directed=False)[1]
            if (np.bincount(orbit) != n_cells).any():
                return None
        first = np.unique(orbit, return_index=True)[1]
        steps = np.rint(fractions - fractions[first][orbit])
        rest = fractions - steps
        counts = np.bincount(orbit)
        mean = np.stack([np.bincount(orbit, column) / counts for column in rest.T], axis=1)
        return _Primitive(mean, basis, orbit, steps, tolerance)


@dataclass(frozen=True)
class _Primitive:
    """Vertices modulo all translations, in fractions of a primitive basis."""

    fractions: FloatArray  # (n, 2)
    basis: FloatArray  # (2, 2) rows, mm
    orbit: IntArray  # for each vertex of the given cell, which of these it is
    steps: FloatArray  # and how many basis vectors away
    tolerance: float  # mm


def _matched(
    images: FloatArray, targets: FloatArray, lattice: FloatArray, tolerance: float
) -> IntArray | None:
    """For each image (n, 2) the target that it is, both in fractions of a lattice, one to one."""
    wrapped = targets - np.floor(targets)
    wrapped[wrapped >= 1.0] = 0.0
    sought = images - np.floor(images)
    sought[sought >= 1.0] = 0.0
    count = min(4, len(targets))
    near = cKDTree(wrapped, boxsize=1.0).query(sought, k=count)[1].reshape(len(images), -1)
    apart = sought[:, None] - wrapped[near]
    # The nearest in fractions need not be the nearest in mm, but it is among the first.
    distances = np.linalg.norm((apart - np.rint(apart)) @ lattice, axis=2)
    best = distances.argmin(axis=1)
    here = np.arange(len(images))
    found: IntArray = near[here, best]
    if distances[here, best].max() > 4.0 * tolerance or len(np.unique(found)) < len(found):
        return None
    return found


@dataclass(frozen=True)
class _Group:
    """A point group in a basis of its lattice, about an origin where all shifts are rational."""

    matrices: list[Matrix]
    shifts: FloatArray  # (n, 2) whole multiples of 1 / n
    partners: list[IntArray]  # vertex that each vertex is carried to
    origin: FloatArray  # (2,) fractions to be added to those of the vertices

    @classmethod
    def of(cls, drawn: DrawnSymmetry, primitive: _Primitive) -> _Group | None:
        inverse = np.linalg.inv(primitive.basis)
        found: dict[Matrix, tuple[FloatArray, IntArray]] = {}
        for operation in drawn.operations:
            matrix = _matrix(operation, primitive.basis)
            images = primitive.fractions @ np.array(matrix) + operation.translation @ inverse
            partner = _matched(images, primitive.fractions, primitive.basis, primitive.tolerance)
            if partner is None:
                continue
            rest = images - primitive.fractions[partner]
            found[matrix] = (operation.translation @ inverse - _mean_rest(rest), partner)
        matrices = closed_part(list(found), multiply)
        if len(matrices) < len(drawn.operations):
            return None
        shifts = np.array([found[matrix][0] for matrix in matrices])
        n = len(matrices)
        origin = -shifts.sum(axis=0) / n
        whole = np.rint(n * (shifts + origin - np.array([origin @ np.array(m) for m in matrices])))
        number = {matrix: k for k, matrix in enumerate(matrices)}
        for j, first in enumerate(matrices):
            for k, second in enumerate(matrices):
                both = whole[j] @ np.array(second) + whole[k]
                if ((both - whole[number[multiply(first, second)]]) % n).any():
                    return None
        return cls(matrices, whole / n, [found[matrix][1] for matrix in matrices], origin)

    def averaged(self, primitive: _Primitive) -> FloatArray | None:
        """Exact places (n, 2) of the vertices about the group's origin, in fractions."""
        places = primitive.fractions + self.origin
        for _ in range(2):  # the second time for rounding alone
            moves = np.zeros_like(places)
            rest = self._rest(places)
            for partner, apart in zip(self.partners, rest, strict=True):
                moves[partner] += apart
            places = places + moves / len(self.matrices)
        left = max(float(np.abs(apart).max()) for apart in self._rest(places))
        return places if left < EXACT else None

    def _rest(self, places: FloatArray) -> list[FloatArray]:
        """How far the images of vertices lie from their partners, for every operation."""
        found = []
        for matrix, shift, partner in zip(self.matrices, self.shifts, self.partners, strict=True):
            apart = places @ np.array(matrix) + shift - places[partner]
            found.append(apart - np.rint(apart))
        return found


def _mean_rest(apart: FloatArray) -> FloatArray:
    """Mean (2,) of distances (n, 2) from whole numbers."""
    rest: FloatArray = (apart - np.rint(apart)).mean(axis=0)
    return rest


def _matrix(operation: SymmetryOperation, basis: FloatArray) -> Matrix:
    rows = np.rint(basis @ operation.linear.T @ np.linalg.inv(basis)).astype(int).tolist()
    return tuple(rows[0]), tuple(rows[1])


def _exact_bases(basis: FloatArray, group: _Group) -> list[FloatArray]:
    """Nearest bases that a group keeps: turned to a multiple of 15°, and not turned.

    An axis of a reflection, or else of rotations the first basis vector, is turned to the multiple.
    """
    matrices = [np.array(matrix) for matrix in group.matrices]
    inner = np.mean([m @ basis @ basis.T @ m.T for m in matrices], axis=0)
    root = np.linalg.cholesky(inner)
    left, _, right = np.linalg.svd(root.T @ basis)
    nearest = root @ left @ right
    if len(matrices) <= 2 and all(np.linalg.det(matrix) > 0.0 for matrix in matrices):
        return [nearest]
    angle = np.degrees(np.arctan2(nearest[0, 1], nearest[0, 0]))
    for matrix in matrices:
        if np.linalg.det(matrix) < 0.0:
            linear = (np.linalg.inv(nearest) @ matrix @ nearest).T
            angle = 0.5 * np.degrees(np.arctan2(linear[1, 0], linear[0, 0]))
            break
    turn = np.radians(round(angle / NICE_ANGLE) * NICE_ANGLE - angle)
    c, s = np.cos(turn), np.sin(turn)
    return [nearest @ np.array([[c, s], [-s, c]]), nearest]


def _placed(
    cell: TiledCell,
    vertices: _Vertices,
    primitive: _Primitive,
    fractions: FloatArray,
    basis: FloatArray,
) -> Symmetrized:
    """The tiles with their corners on moved vertices, and the lattice that goes with them."""
    whole = np.rint(cell.lattice @ np.linalg.inv(primitive.basis))
    lattice = whole @ basis
    points = (fractions[primitive.orbit] + primitive.steps) @ basis
    corners = points[vertices.labels] + vertices.offsets @ lattice
    given = np.concatenate(cell.tiles)
    corners += (given - corners).mean(axis=0)
    moves = np.linalg.norm(np.vstack([corners - given, lattice - cell.lattice]), axis=1)
    off, mean = float(moves.max()), float(np.sqrt(np.mean(moves**2)))
    tiles = split_like(corners, list(cell.tiles))
    classes = split_like(vertices.labels, list(cell.tiles))
    sharp = tuple(sharp_corners(tiles, classes))
    moved = replace(cell, tiles=tuple(tiles), sharp=sharp, lattice=lattice)
    return Symmetrized(moved, "", 1, off, mean)


def symmetry_within(cell: TiledCell, limit: float) -> Symmetrized:
    """The most symmetric tiling of which no corner lies farther than a limit [mm], most by half."""
    for tolerance in (NEAR * cell.size, 4.0 * limit, limit, AS_IT_IS * cell.size):
        found = symmetrized(cell, tolerance, limit)
        if found is not None and found.is_within(limit):
            return found
    return Symmetrized(cell, "p1", 1, 0.0, 0.0)


def symmetry_near(drawing: Drawing) -> Symmetrized | None:
    """The most symmetric tiling of which the outlines lie within 1e-3 of a tile's size."""
    within = NEAR * drawing.size
    try:
        cell = build_cell(drawing.tiles, drawing.lattice, within)
    except PatternError:  # corners so near are no noise
        return None
    found = symmetrized(cell, within, within)
    if found is None or found.order == 1:
        return None
    rings = [
        (shapely.linearrings(tile), shapely.linearrings(image))
        for tile, image in zip(drawing.tiles, found.cell.tiles, strict=True)
    ]
    off = max(float(shapely.hausdorff_distance(one, other)) for one, other in rings)
    return replace(found, off=max(off, found.off)) if off <= within else None

"""Triangulated flat sheets with boundaries: rectangles, discs, annuli, and images of rectangles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexscale.arrays import BoolArray, FloatArray, IntArray
from flexscale.errors import MeshError
from flexscale.units import require_positive

MOST_TRIANGLES = 300_000  # of a macro sheet: one equilibrium takes a minute or more


@dataclass(frozen=True)
class SheetMesh:
    """Triangles of a flat sheet.

    Attributes
    ----------
    points : (n_vertices, 2) rest coordinates, mm; parameters of a surface if it is curved at rest.
    triangles : (n_triangles, 3) counterclockwise.
    """

    points: FloatArray
    triangles: IntArray

    def __post_init__(self) -> None:
        corners = self.points[self.triangles]
        u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        double = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
        if not (double > 0.0).all():
            worst = int(np.argmin(double))
            raise MeshError(
                f"Triangle {worst} of the sheet has an area of {0.5 * double[worst]:.3g} mm2: its "
                "corners must run counterclockwise around a positive area."
            )

    @property
    def n_vertices(self) -> int:
        return len(self.points)

    @cached_property
    def _edge_table(self) -> tuple[IntArray, IntArray]:
        ends = np.stack([self.triangles, np.roll(self.triangles, -1, axis=1)], axis=-1)
        edges, inverse = np.unique(
            np.sort(ends, axis=-1).reshape(-1, 2), axis=0, return_inverse=True
        )
        return edges, inverse.reshape(self.triangles.shape).astype(np.int64)

    @property
    def edges(self) -> IntArray:
        """(n_edges, 2) vertices, the lower number first."""
        return self._edge_table[0]

    @property
    def triangle_edges(self) -> IntArray:
        """(n_triangles, 3) edges between corners 0-1, 1-2 and 2-0."""
        return self._edge_table[1]

    @cached_property
    def boundary(self) -> BoolArray:
        """(n_edges,) edges of one triangle only."""
        return np.bincount(self.triangle_edges.ravel(), minlength=len(self.edges)) == 1

    def mapped(self, move: Callable[[FloatArray], FloatArray]) -> SheetMesh:
        """The same triangles on points moved by a map (n, 2) -> (n, 2)."""
        return SheetMesh(move(self.points), self.triangles)


def crossed_rectangle(
    x: tuple[float, float], y: tuple[float, float], cells: tuple[int, int]
) -> SheetMesh:
    """[x0, x1] x [y0, y1] in `cells` rectangles, each crossed into four triangles."""
    nx, ny = _counted(cells)
    xs, ys = np.linspace(*x, nx + 1), np.linspace(*y, ny + 1)
    grid = np.stack(np.meshgrid(xs, ys, indexing="ij"), axis=-1).reshape(-1, 2)
    i, j = np.mgrid[:nx, :ny].reshape(2, -1)
    around = np.stack([_node(i + a, j + b, ny) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))])
    middle = len(grid) + np.arange(nx * ny)
    middles = 0.5 * (grid[around[0]] + grid[around[2]])
    triangles = [np.stack([around[k], around[(k + 1) % 4], middle], axis=1) for k in range(4)]
    return SheetMesh(np.concatenate([grid, middles]), np.concatenate(triangles))


def staggered_rectangle(length: float, width: float, cells: tuple[int, int]) -> SheetMesh:
    """[0, length] x [0, width] in cells[1] rows of nearly equilateral triangles, 2 cells[0] + 1 a
    row: three edge directions, none of them preferred."""
    nx, ny = _counted(cells)
    length, width = _sides(length, width)
    pitch = length / nx
    even = np.arange(nx + 1) * pitch
    odd = np.concatenate([[0.0], (np.arange(nx) + 0.5) * pitch, [length]])
    points, triangles, start = [], [], 0
    for row in range(ny + 1):
        xs = odd if row % 2 else even
        points.append(np.stack([xs, np.full(len(xs), width * row / ny)], axis=1))
        if row < ny:
            here, there = start + np.arange(len(xs)), start + len(xs)
            above = there + np.arange(nx + 1 if row % 2 else nx + 2)
            triangles.append(_zip_row(here, above, bool(row % 2)))
        start += len(xs)
    return SheetMesh(np.concatenate(points), np.concatenate(triangles))


def _zip_row(below: IntArray, above: IntArray, more_below: bool) -> IntArray:
    """Triangles between two staggered rows, of which one has a point more."""
    long, short = (below, above) if more_below else (above, below)
    caps = np.stack([long[:-1], long[1:], short], axis=1)
    bases = np.stack([short[:-1], long[1:-1], short[1:]], axis=1)
    if more_below:
        return np.concatenate([caps, bases])
    return np.concatenate([caps[:, [1, 0, 2]], bases[:, [0, 2, 1]]])


def rectangle(length: float, width: float, size: float) -> SheetMesh:
    """[0, length] x [0, width] in nearly equilateral triangles with sides of about `size`, mm."""
    length, width = _sides(length, width)
    size = require_positive(size, "element size", "mm")
    require_moderate_triangles(rectangle_triangles(length, width, size), size)
    cells = (round(length / size), round(width / (0.5 * np.sqrt(3.0) * size)))
    return staggered_rectangle(length, width, (max(1, cells[0]), max(1, cells[1])))


def rectangle_triangles(length: float, width: float, size: float) -> float:
    """About how many triangles of a size a rectangle has, mm."""
    return float(2.0 * length * width / (0.5 * np.sqrt(3.0) * size**2))


def require_moderate_triangles(expected: float, size: float) -> None:
    """Refuse a sheet of very many triangles of a size [mm], before they are made."""
    if expected > MOST_TRIANGLES:
        raise MeshError(
            f"Triangles of {size:g} mm would be about {expected:.2g}, more than {MOST_TRIANGLES}: "
            "give a larger element size, or a smaller sheet."
        )


def disc(radius: float, rings: int, hub: float = 0.0) -> SheetMesh:
    """A disc around the origin in concentric rings of 6, 12, 18, ... vertices.

    Parameters
    ----------
    radius : mm.
    rings : number of rings.
    hub : mm, radius that the ring closest to it is moved to; 0 for evenly spaced rings.
    """
    radius = require_positive(radius, "disc radius", "mm")
    (rings,) = _counted((rings,))
    require_moderate_triangles(6.0 * rings**2, radius / rings)
    radii = np.linspace(0.0, radius, rings + 1)
    if hub > 0.0:
        k = int(np.clip(round(hub / radius * rings), 1, rings - 1)) if rings > 1 else 0
        if not 0.0 < hub < radius or k == 0:
            raise MeshError(
                f"A hub of {hub:.12g} mm does not fit in a disc of {radius:.12g} mm with {rings} "
                "rings: make it smaller than the disc, and take two rings or more."
            )
        radii = np.concatenate(
            [np.linspace(0.0, hub, k + 1), np.linspace(hub, radius, rings - k + 1)[1:]]
        )
    points, triangles, start = [np.zeros((1, 2))], [], [0]
    for k in range(1, rings + 1):
        angle = 2.0 * np.pi * np.arange(6 * k) / (6 * k)
        start.append(1 + 3 * k * (k - 1))
        points.append(radii[k] * np.stack([np.cos(angle), np.sin(angle)], axis=1))
        triangles.append(_ring(k, start[k - 1], start[k]))
    return SheetMesh(np.concatenate(points), np.concatenate(triangles))


def _ring(k: int, inner: int, outer: int) -> IntArray:
    """Triangles between ring k - 1 (6 (k - 1) vertices, one for k = 1) and ring k."""
    found = []
    n_inner, n_outer = max(1, 6 * (k - 1)), 6 * k
    for sector in range(6):
        for i in range(k):
            a = outer + (sector * k + i) % n_outer
            b = outer + (sector * k + i + 1) % n_outer
            p = inner + (sector * (k - 1) + i) % n_inner
            found.append((a, b, p))
            if i < k - 1:
                found.append((p, b, inner + (sector * (k - 1) + i + 1) % n_inner))
    return np.array(found, dtype=np.int64)


def annulus(inner: float, outer: float, cells: tuple[int, int], slit: bool = False) -> SheetMesh:
    """An annulus around the origin in cells (radial, around); open along the x axis if slit."""
    inner = require_positive(inner, "inner radius", "mm")
    if not inner < require_positive(outer, "outer radius", "mm"):
        raise MeshError(
            f"An annulus from {inner:.12g} mm to {outer:.12g} mm is empty: the outer radius must "
            "be the larger one."
        )
    mesh = crossed_rectangle((inner, outer), (0.0, 2.0 * np.pi), cells)
    round_ = mesh.mapped(polar)
    if slit:
        return round_
    first = np.arange(cells[0] + 1) * (cells[1] + 1)
    number = np.arange(mesh.n_vertices)
    number[first + cells[1]] = first
    kept, renumbered = np.unique(number, return_inverse=True)
    return SheetMesh(round_.points[kept], renumbered[mesh.triangles])


def polar(points: FloatArray) -> FloatArray:
    """(r, angle in rad) -> (x, y)."""
    r, angle = points[:, 0], points[:, 1]
    return np.stack([r * np.cos(angle), r * np.sin(angle)], axis=1)


def _node(i: IntArray, j: IntArray, ny: int) -> IntArray:
    return i * (ny + 1) + j


def _sides(length: float, width: float) -> tuple[float, float]:
    return require_positive(length, "sheet length", "mm"), require_positive(width, "width", "mm")


def _counted(cells: tuple[int, ...]) -> tuple[int, ...]:
    if min(cells) < 1:
        raise MeshError(f"A mesh of {cells} cells is empty: each count must be 1 or more.")
    return cells

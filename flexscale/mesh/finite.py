"""The mesh of a rectangular sheet with whole and cut scales, its two ends glued to one another.

Both ends of a bent sheet lie on one cylinder: the far end is where a lattice vector carries the
near one. So the sheet is a mesh that is periodic along its length and free at its sides, and what
holds the near end holds both. Pieces of scales that the ends cut are part of the strips that hold
the sheet; so is the gap between them along the end, which belongs to no element.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from flexscale.errors import MeshError
from flexscale.mesh.options import MeshOptions
from flexscale.mesh.periodic_mesh import FREE, PeriodicMesh
from flexscale.mesh.prototile import fill_region
from flexscale.mesh.quadratic import elevate_scales
from flexscale.mesh.subdivision import TipSizes, subdivide_loop
from flexscale.mesh.tile import TileMesh, build_tile_mesh, find_tip_sizes
from flexscale.mesh.torus import IDENTITY, join_tiles
from flexscale.mesh.wedge import make_region
from flexscale.patterns import Pattern
from flexscale.patterns.clipped import SheetTiles

FloatArray = NDArray[np.float64]

APART = 3.0  # width of the lattice cell over the sheet's: images are out of reach


def build_finite_mesh(
    pattern: Pattern, tiles: SheetTiles, options: MeshOptions | None = None
) -> PeriodicMesh:
    """Mesh a sheet like the pattern's cell: same sizes, same kinds of elements.

    In the result, the first lattice vector is the sheet's length; the second is so wide that images
    are out of reach, and edges at the sides have one triangle.

    Parameters
    ----------
    tiles : the pattern on the sheet.

    Raises
    ------
    MeshError : the sizes asked for do not give a valid mesh.
    """
    options = options or MeshOptions()
    tips = find_tip_sizes(pattern.prototiles, pattern.gap, options)
    meshes = [
        build_tile_mesh(prototile, pattern.gap, pattern.scale_height, options, tips)
        for prototile in tiles.prototiles
    ]
    placed = [(meshes[copy.prototile], copy.placement) for copy in tiles.copies]
    bare = [_bare_tile(polygon, sharp, options, tips) for polygon, sharp in tiles.bare]
    lattice = np.diag([tiles.length, APART * tiles.width])
    mesh = join_tiles(placed, bare, lattice, pattern.scale_height)
    if options.scale_order == 2:
        mesh = elevate_scales(mesh)
    _check(mesh, tiles)
    return _without_end_gap(mesh, tiles, 0.5 * pattern.gap)


def _without_end_gap(mesh: PeriodicMesh, tiles: SheetTiles, half: float) -> PeriodicMesh:
    """The triangles of the gap along the end count as covered by a scale of the strip."""
    across = np.abs(mesh.corner_positions()[..., 0])
    length = tiles.length
    across = np.minimum(across, np.abs(across - length)).max(axis=1)
    within = (mesh.triangle_scale < 0) & (across < half * (1.0 + 1e-6))
    first = int(np.flatnonzero(tiles.at_end)[0]) if tiles.at_end.any() else -1
    return replace(mesh, triangle_scale=np.where(within, first, mesh.triangle_scale))


def _bare_tile(
    polygon: FloatArray, sharp: NDArray[np.bool_], options: MeshOptions, tips: TipSizes
) -> TileMesh:
    """A piece of sheet without a scale."""
    outer = subdivide_loop(polygon, sharp, options, tips).points(polygon)
    region = make_region([outer], (IDENTITY,), polygon.mean(axis=0), True)
    filling = fill_region(region, options.along, options.growth)
    n = len(filling.points)
    return TileMesh(
        points=filling.points,
        triangles=filling.triangles,
        covered=np.zeros(len(filling.triangles), dtype=bool),
        kinds=np.full(n, FREE, dtype=np.int8),
        tangents=np.zeros((n, 2)),
        shared=np.arange(len(outer)),
        scale_points=np.zeros((0, 3)),
        base_triangles=np.zeros((0, 3), dtype=np.int64),
        tets=np.zeros((0, 4), dtype=np.int64),
    )


def _check(mesh: PeriodicMesh, tiles: SheetTiles) -> None:
    """All of the rectangle is covered once, and only its sides have edges of one triangle."""
    areas = mesh.triangle_areas()
    incidence = np.bincount(mesh.triangle_edges.ravel(), minlength=mesh.n_edges)
    across = mesh.positions[mesh.edges[incidence == 1], 1]
    close = 1e-6 * tiles.width
    at_side = (np.abs(across) < close).all(axis=1) | (np.abs(across - tiles.width) < close).all(1)
    area = tiles.length * tiles.width
    whole = abs(areas.sum() - area) < 1e-6 * area and (areas > 0.0).all()
    if not whole or (incidence > 2).any() or not at_side.all():
        raise MeshError(
            f"The mesh of the sheet of {tiles.length:g} x {tiles.width:g} mm does not close: try "
            "other mesh options (a smaller `corner` or `along`), or another direction."
        )

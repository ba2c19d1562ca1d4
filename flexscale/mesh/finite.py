"""The mesh of a rectangular sheet with whole and cut scales.

Both ends of a sheet on a cylinder are one: the far end is where a lattice vector carries the near
one. Such a sheet is a mesh that is periodic along its length and free at its sides, and what holds
the near end holds both. Other sheets have two ends of their own. Pieces of scales that the ends cut
are part of the strips that hold the sheet; so is the gap between them along the end, which belongs
to no element. A strip of an end of its own is one scale of several pieces.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from flexscale.arrays import FloatArray
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

APART = 3.0  # width of the lattice cell over the sheet's: images are out of reach


def build_finite_mesh(
    pattern: Pattern, tiles: SheetTiles, options: MeshOptions | None = None
) -> PeriodicMesh:
    """Mesh a sheet like the pattern's cell: same sizes, same kinds of elements.

    In the result, the first lattice vector is the length of a sheet that is glued end to end. Else,
    and across the sheet, images are out of reach, and edges at the border have one triangle. The
    first scales then are the strips, as `strips` numbers them.

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
    lattice = np.diag([tiles.length * (1.0 if tiles.glued else APART), APART * tiles.width])
    mesh = join_tiles(placed, bare, lattice, pattern.scale_height)
    if options.scale_order == 2:
        mesh = elevate_scales(mesh)
    _check(mesh, tiles)
    mesh = _without_end_gaps(mesh, tiles, 0.5 * pattern.gap)
    return mesh if tiles.glued else _with_strips(mesh, tiles)


def strips(tiles: SheetTiles) -> tuple[int, int]:
    """Scales of the mesh that are the strips of near and far end; -1 where an end cuts none."""
    near, far = (tiles.at_end & ~tiles.at_far_end).any(), tiles.at_far_end.any()
    return 0 if near else -1, int(near) if far else -1


def _with_strips(mesh: PeriodicMesh, tiles: SheetTiles) -> PeriodicMesh:
    """All pieces at an end as one scale."""
    rank = np.where(tiles.at_far_end, 1, np.where(tiles.at_end, 0, 2))
    rank[rank == 2] += np.arange(np.count_nonzero(rank == 2))
    number = np.unique(rank, return_inverse=True)[1]
    labels = ("triangle", "vertex", "edge", "tet", "base", "surface")
    scales = {f"{label}_scale": getattr(mesh, f"{label}_scale") for label in labels}
    renumbered = {
        name: np.where(scale >= 0, number[np.maximum(scale, 0)], scale) if len(number) else scale
        for name, scale in scales.items()
    }
    return replace(mesh, n_scales=len(np.unique(number)), **renumbered)


def _without_end_gaps(mesh: PeriodicMesh, tiles: SheetTiles, half: float) -> PeriodicMesh:
    """The triangles of the gaps along the ends count as covered by a scale of the strip there."""
    x, covered = mesh.corner_positions()[..., 0], mesh.triangle_scale.copy()
    at_near = tiles.at_end & ~tiles.at_far_end
    for end, pieces in ((0.0, at_near), (tiles.length, tiles.at_far_end | tiles.glued & at_near)):
        within = (covered < 0) & (np.abs(x - end) < half * (1.0 + 1e-6)).all(axis=1)
        if pieces.any():
            covered[within] = np.flatnonzero(pieces)[0]
    return replace(mesh, triangle_scale=covered)


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
    """All of the rectangle is covered once, and only its border has edges of one triangle."""
    areas = mesh.triangle_areas()
    incidence = np.bincount(mesh.triangle_edges.ravel(), minlength=mesh.n_edges)
    single = mesh.positions[mesh.edges[incidence == 1]]
    close = 1e-6 * tiles.width
    lines = [(1, 0.0), (1, tiles.width)]
    if not tiles.glued:
        lines += [(0, 0.0), (0, tiles.length)]
    on_line = [(np.abs(single[..., axis] - place) < close).all(axis=1) for axis, place in lines]
    area = tiles.length * tiles.width
    whole = abs(areas.sum() - area) < 1e-6 * area and (areas > 0.0).all()
    if not whole or (incidence > 2).any() or not np.any(on_line, axis=0).all():
        raise MeshError(
            f"The mesh of the sheet of {tiles.length:g} x {tiles.width:g} mm does not close: try "
            "other mesh options (a smaller `corner` or `along`), or another direction."
        )

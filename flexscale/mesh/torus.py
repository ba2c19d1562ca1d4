"""Copies of the tiles' meshes, glued to a torus."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexscale.arrays import FloatArray, IntArray
from flexscale.mesh.estimate import require_moderate_mesh
from flexscale.mesh.options import MeshOptions
from flexscale.mesh.periodic_mesh import COVERED_EDGE, FREE, GAP_EDGE, PeriodicMesh
from flexscale.mesh.prisms import surface_of
from flexscale.mesh.quadratic import elevate_scales
from flexscale.mesh.solid_options import SolidOptions
from flexscale.mesh.tile import TileMesh, build_tile_mesh, find_tip_sizes
from flexscale.mesh.topology import TorusEdges, build_edges
from flexscale.patterns import Isometry, Pattern
from flexscale.patterns.corners import torus_classes

SAME_NODE = 1e-7  # relative to the root of a tile's mean area


@dataclass(frozen=True)
class _Sheet:
    """The substrate of all tiles, not glued yet."""

    points: FloatArray
    triangles: IntArray
    covered_by: IntArray
    carried_by: IntArray
    kinds: NDArray[np.int8]
    tangents: FloatArray
    shared: IntArray


def build_mesh(
    pattern: Pattern, options: MeshOptions | None = None, solid: SolidOptions | None = None
) -> PeriodicMesh:
    """Mesh one lattice cell of a pattern as a torus.

    Each shape of tile is meshed once, with the tile's own symmetries, and copied by the isometries
    of the tiling, so the mesh has the symmetry of the pattern.

    Parameters
    ----------
    options : element sizes; the defaults of `MeshOptions` if not given.
    solid : of a substrate that is a solid: its mesh is graded on both sides of the outlines.

    Raises
    ------
    MeshError : the sizes asked for do not give a valid mesh.
    """
    options, under_scales = options or MeshOptions(), None
    of_tiles = [options] * len(pattern.prototiles)
    if solid is not None:
        of_tiles = [solid.in_plane(options, prototile.gap) for prototile in pattern.prototiles]
        under_scales = solid.under_scales(options, pattern.substrate_thickness)
    require_moderate_mesh(pattern, max(of_tiles, key=lambda own: own.across))
    tips = find_tip_sizes(pattern.prototiles, of_tiles, solid is not None)
    meshes = [
        build_tile_mesh(prototile, pattern.scale_height, own, tips, under_scales)
        for prototile, own in zip(pattern.prototiles, of_tiles, strict=True)
    ]
    placed = [(meshes[copy.prototile], copy.placement) for copy in pattern.copies]
    mesh = join_tiles(placed, pattern.lattice, pattern.scale_height)
    if options.scale_order == 2:
        mesh = elevate_scales(mesh)
    mesh.validate()
    return mesh


def join_tiles(
    placed: Sequence[tuple[TileMesh, Isometry]],
    lattice: FloatArray,
    scale_height: float,
) -> PeriodicMesh:
    """Glue the meshes of tiles where their outlines meet, modulo the lattice.

    Parameters
    ----------
    placed : tiles with scales, and where they lie.
    lattice : (2, 2) rows, mm.
    scale_height : mm.
    """
    sheet = _place_sheet(placed)
    tolerance = SAME_NODE * float(np.sqrt(np.linalg.det(lattice) / len(placed)))
    vertex, offset = _glue(sheet, lattice, tolerance)
    first = np.unique(vertex, return_index=True)[1]
    triangles, offsets = vertex[sheet.triangles], offset[sheet.triangles]
    topology = build_edges(triangles, offsets)
    return PeriodicMesh(
        lattice=lattice.copy(),
        positions=sheet.points[first],
        triangles=triangles,
        triangle_offsets=offsets,
        triangle_scale=sheet.covered_by,
        vertex_scale=sheet.carried_by[first],
        vertex_kind=sheet.kinds[first],
        outline_tangent=sheet.tangents[first],
        edges=topology.edges,
        edge_shift=topology.edge_shift,
        triangle_edges=topology.triangle_edges,
        triangle_edge_offsets=topology.triangle_edge_offsets,
        edge_scale=_edge_scales(topology, sheet.covered_by),
        n_scales=len(placed),
        scale_height=scale_height,
        **_place_scales(placed),
    )


def _place_sheet(placed: Sequence[tuple[TileMesh, Isometry]]) -> _Sheet:
    parts: dict[str, list] = {name: [] for name in _Sheet.__dataclass_fields__}
    start = 0
    for scale, (tile, placement) in enumerate(placed):
        turned = -1.0 if placement.reverses else 1.0
        parts["points"].append(placement.apply(tile.points))
        parts["triangles"].append(start + _wound(tile.triangles, placement))
        parts["covered_by"].append(np.where(tile.covered, scale, -1))
        parts["carried_by"].append(np.where(tile.kinds == FREE, -1, scale))
        parts["kinds"].append(tile.kinds)
        parts["tangents"].append(turned * tile.tangents @ placement.linear.T)
        parts["shared"].append(start + tile.shared)
        start += len(tile.points)
    return _Sheet(**{name: np.concatenate(arrays) for name, arrays in parts.items()})


def _wound(cells: IntArray, placement: Isometry) -> IntArray:
    """Keep the orientation of triangles or tets under a reflection."""
    if not placement.reverses:
        return cells
    return np.concatenate([cells[:, [1, 0]], cells[:, 2:]], axis=1)


def _glue(sheet: _Sheet, lattice: FloatArray, tolerance: float) -> tuple[IntArray, IntArray]:
    """Torus vertex (n,) and lattice offset (n, 2) of every node of the sheet.

    The first node of a class represents it.
    """
    n = len(sheet.points)
    shared = sheet.points[sheet.shared]
    _, first, inverse = np.unique(
        torus_classes(shared, lattice, tolerance), return_index=True, return_inverse=True
    )
    representative = np.arange(n)
    representative[sheet.shared] = sheet.shared[first[inverse]]
    apart = sheet.points - sheet.points[representative]
    offset = np.rint(apart @ np.linalg.inv(lattice)).astype(np.int64)
    return np.unique(representative, return_inverse=True)[1].astype(np.int64), offset


def _edge_scales(topology: TorusEdges, covered_by: IntArray) -> IntArray:
    """Scale on whose outline an edge lies, or `GAP_EDGE`, or `COVERED_EDGE`."""
    n_edges = len(topology.edges)
    owner = np.repeat(covered_by, 3)
    edges = topology.triangle_edges.ravel()
    n_covered = np.bincount(edges[owner >= 0], minlength=n_edges)
    highest = np.full(n_edges, GAP_EDGE)
    np.maximum.at(highest, edges, owner)
    return np.where(n_covered == 2, COVERED_EDGE, highest)


def _place_scales(placed: Sequence[tuple[TileMesh, Isometry]]) -> dict[str, NDArray]:
    names = (
        "scale_positions",
        "tets",
        "tet_scale",
        "base_triangles",
        "base_scale",
        "surface_triangles",
        "surface_scale",
    )
    parts: dict[str, list] = {name: [] for name in names}
    start = 0
    for scale, (tile, placement) in enumerate(placed):
        flat = placement.apply(tile.scale_points[:, :2])
        tets = _wound(tile.tets, placement)
        surface, _ = surface_of(tets)
        parts["scale_positions"].append(np.column_stack([flat, tile.scale_points[:, 2]]))
        for name, cells in (
            ("tet", tets),
            ("surface", surface),
            ("base", _wound(tile.base_triangles, placement)),
        ):
            parts["tets" if name == "tet" else f"{name}_triangles"].append(start + cells)
            parts[f"{name}_scale"].append(np.full(len(cells), scale))
        start += len(tile.scale_points)
    return {name: np.concatenate(arrays) for name, arrays in parts.items()}

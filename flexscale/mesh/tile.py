"""The mesh of one tile: half its gaps, the sheet under its scale, and the scale."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from flexscale.arrays import FloatArray, IntArray
from flexscale.mesh.options import MeshOptions
from flexscale.mesh.periodic_mesh import COVERED, FREE, OUTLINE, OUTLINE_CORNER
from flexscale.mesh.prisms import extrude
from flexscale.mesh.prototile import Filling, fill_region
from flexscale.mesh.quality import triangle_qualities
from flexscale.mesh.scale_base import Row, build_base
from flexscale.mesh.strip import Ring, build_strips
from flexscale.mesh.subdivision import (
    NO_TIPS,
    LoopNodes,
    TipSizes,
    in_first_half,
    subdivide_loop,
    turns,
)
from flexscale.mesh.wedge import make_region
from flexscale.patterns import Prototile
from flexscale.patterns.cell import SHARP_TURN
from flexscale.patterns.junctions import turning_angles
from flexscale.patterns.outlines import MITRE_LIMIT, mitre_points

GOOD = 0.3  # quality: better strips along the gap need not be compared with anything
CLEARLY_BETTER = 1.3
THINNEST = 0.005  # quality: wedges along a straight edge may be as flat as that


@dataclass(frozen=True)
class TileMesh:
    """Mesh of a prototile in its own place; arrays as in `PeriodicMesh`, without lattice.

    Attributes
    ----------
    points : (n, 2) mm.
    triangles : (m, 3) counterclockwise.
    covered : (m,) whether a triangle lies under the scale.
    kinds : (n,) values of `PeriodicMesh.vertex_kind`.
    tangents : (n, 2) of the outline, counterclockwise, at kind 1.
    shared : nodes on the tile's polygon.
    scale_points : (n_scale, 3) mm, base vertices first.
    base_triangles : (n_base, 3).
    tets : (n_tets, 4).
    """

    points: FloatArray
    triangles: IntArray
    covered: NDArray[np.bool_]
    kinds: NDArray[np.int8]
    tangents: FloatArray
    shared: IntArray
    scale_points: FloatArray
    base_triangles: IntArray
    tets: IntArray


def find_tip_sizes(
    prototiles: Sequence[Prototile], options: Sequence[MeshOptions], sheared: bool = False
) -> TipSizes:
    """Sizes along all chains of a pattern: tiles that share one must agree; options of each.

    Where strips would shear, elements grow no larger than those that `across` asks for until one
    gap past the sharpest tip of a scale. Nodes of strips face each other anyway.
    """
    free = [
        (tile, own)
        for tile, own in zip(prototiles, options, strict=True)
        if _inset_for_strips(tile, own, sheared) is None
    ]
    if not free:
        return NO_TIPS
    reach = max(0.5 * tile.gap * _mitre(tile) + tile.gap for tile, _ in free)
    return TipSizes(reach, min(2.0 * tile.gap / own.across for tile, own in free))


def build_tile_mesh(
    prototile: Prototile,
    scale_height: float,
    options: MeshOptions,
    tips: TipSizes = NO_TIPS,
    under_scale: MeshOptions | None = None,
) -> TileMesh:
    """Mesh a prototile with all the symmetry it has.

    Parameters
    ----------
    scale_height : mm.
    tips : of the whole pattern, from `find_tip_sizes`.
    under_scale : sizes of the sheet under the scale, as of a scale's base, where the sheet deforms
        there, and needs strips even where they shear; if not given, it is filled from the outline
        inward.
    """
    ring = _build_ring(prototile, options, tips, under_scale is not None)
    outline = ring.points[ring.outline_nodes]
    center = prototile.polygon.mean(axis=0)
    region = make_region([outline], prototile.stabiliser, center, True)
    if under_scale is None:
        extent = float(np.ptp(outline, axis=0).max())
        under = fill_region(region, extent, options.growth)
    else:
        kinks = np.isin(np.arange(len(outline)), ring.kinks)
        whole = Row(outline, kinks, in_first_half(ring.along))
        under = build_base(whole, prototile.stabiliser, center, under_scale, THINNEST)
    kinks = np.isin(ring.coarse, ring.kinks)
    row = Row(outline[ring.coarse], kinks, in_first_half(ring.along[ring.coarse]))
    base = build_base(row, prototile.stabiliser, center, options)
    scale_points, tets = extrude(
        base.points, base.triangles, base.orbits, center, layer_heights(scale_height, options)
    )
    return _assemble(ring, under, base, scale_points, tets)


def layer_heights(scale_height: float, options: MeshOptions) -> FloatArray:
    """Heights (scale_layers + 1,) of the nodes above a vertex of the base, mm, from 0 up."""
    sizes = options.layer_growth ** np.arange(options.scale_layers)
    heights = scale_height * np.concatenate([[0.0], np.cumsum(sizes)]) / sizes.sum()
    heights[-1] = scale_height
    return heights


def _mitre(prototile: Prototile) -> float:
    """How far along a tile's edge its scale's sharpest tip lies, in units of half the gap."""
    sharpest = turning_angles(prototile.polygon)[prototile.sharp].max(initial=0.0)
    return float(min(np.tan(0.5 * sharpest), MITRE_LIMIT))


def _build_ring(prototile: Prototile, options: MeshOptions, tips: TipSizes, sheared: bool) -> Ring:
    nodes = subdivide_loop(prototile.polygon, prototile.sharp, options, tips)
    inset = _inset_for_strips(prototile, options, sheared)
    if inset is None:
        return _free_ring(prototile, nodes.points(prototile.polygon), options, tips)
    return build_strips(prototile.polygon, inset, nodes, options)


def _inset_for_strips(
    prototile: Prototile, options: MeshOptions, sheared: bool
) -> FloatArray | None:
    """Corners of the outline, one for one with the tile's; None if strips lose edges, or shear
    where they must not."""
    inset = mitre_points(prototile.polygon, 0.5 * prototile.gap)
    if inset is None or sheared:
        return inset
    nodes = subdivide_loop(prototile.polygon, prototile.sharp, options)
    return None if _strips_shear(prototile, nodes, inset, options) else inset


def _strips_shear(
    prototile: Prototile, nodes: LoopNodes, inset: FloatArray, options: MeshOptions
) -> bool:
    """Whether triangles without structure are clearly better than strips, as at sharp corners.

    Judged with one element across half the gap, so that grading across it does not count.
    """
    single = replace(options, across=2)
    strips = build_strips(prototile.polygon, inset, nodes, single)
    worst = triangle_qualities(strips.points, strips.triangles).min()
    if worst > GOOD:
        return False
    free = _free_ring(prototile, nodes.points(prototile.polygon), single, NO_TIPS)
    best = triangle_qualities(free.points, free.triangles).min()
    return bool(best > CLEARLY_BETTER * worst)


def _free_ring(
    prototile: Prototile, outer: FloatArray, options: MeshOptions, tips: TipSizes
) -> Ring:
    """Ring triangulated by gmsh, with nodes of its own along the scale's outline.

    For a tile with edges that the outline has lost, or with sharp corners, where strips shear.

    With two elements across the gap, the boundary nodes are all that is needed.

    Parameters
    ----------
    outer : (n, 2) nodes on the tile's polygon, mm.
    """
    outline = prototile.outline
    nodes = subdivide_loop(outline, np.abs(turning_angles(outline)) > SHARP_TURN, options, tips)
    inner = nodes.points(outline)
    region = make_region(
        [outer, inner[::-1]], prototile.stabiliser, prototile.polygon.mean(axis=0), False
    )
    largest = options.along if options.across == 2 else 2.0 * prototile.gap / options.across
    filling = fill_region(region, largest, options.growth)
    n_outer, n_inner = len(outer), len(inner)
    return Ring(
        points=filling.points,
        triangles=filling.triangles,
        tile_nodes=np.arange(n_outer),
        outline_nodes=np.arange(n_outer, n_outer + n_inner)[::-1],
        coarse=nodes.coarse,
        kinks=nodes.nodes_of(turns(outline)),
        along=nodes.along,
    )


def _assemble(
    ring: Ring, under: Filling, base: Filling, scale_points: FloatArray, tets: IntArray
) -> TileMesh:
    n_ring, n_outline = len(ring.points), len(ring.outline_nodes)
    inner = np.arange(n_ring, n_ring + len(under.points) - n_outline)
    to_tile = np.concatenate([ring.outline_nodes, inner])
    points = np.concatenate([ring.points, under.points[n_outline:]])
    kinds = np.full(len(points), FREE, dtype=np.int8)
    kinds[inner] = COVERED
    kinds[ring.outline_nodes] = OUTLINE
    kinds[ring.outline_nodes[ring.kinks]] = OUTLINE_CORNER
    tangents = np.zeros((len(points), 2))
    outline = ring.points[ring.outline_nodes]
    along = np.roll(outline, -1, axis=0) - np.roll(outline, 1, axis=0)
    tangents[ring.outline_nodes] = along / np.linalg.norm(along, axis=1)[:, None]
    tangents[kinds != OUTLINE] = 0.0
    return TileMesh(
        points=points,
        triangles=np.concatenate([ring.triangles, to_tile[under.triangles]]),
        covered=np.arange(len(ring.triangles) + len(under.triangles)) >= len(ring.triangles),
        kinds=kinds,
        tangents=tangents,
        shared=ring.tile_nodes,
        scale_points=scale_points,
        base_triangles=base.triangles,
        tets=tets,
    )

"""A region with symmetries, cut down to one fundamental piece of its boundary.

Mirrors (dihedral groups): the piece lies between two neighboring mirror rays. Rotations alone
(cyclic groups): it lies between a cut and the cut's image. No symmetry: all of the region.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexscale.arrays import FloatArray, IntArray
from flexscale.patterns.symmetry import Isometry

CENTER = -1  # stands for the center among node numbers


@dataclass(frozen=True)
class Region:
    """A polygon, or a ring between two, with fixed nodes on its boundary.

    Attributes
    ----------
    nodes : (n, 2) boundary nodes, mm, one closed loop after the other. Every mirror of the region
        crosses the boundary at nodes.
    next_node : (n,) following node, with the region on the left.
    symmetries : isometries that carry the region and its nodes onto themselves, the identity first.
    center : (2,) fixed point of the symmetries, mm.
    has_center : whether the region contains the center.
    """

    nodes: FloatArray
    next_node: IntArray
    symmetries: tuple[Isometry, ...]
    center: FloatArray
    has_center: bool

    def local_sizes(self) -> FloatArray:
        """Mean length (n,) of the two boundary segments at each node, mm."""
        ahead = np.linalg.norm(self.nodes[self.next_node] - self.nodes, axis=1)
        behind = np.empty_like(ahead)
        behind[self.next_node] = ahead
        return 0.5 * (ahead + behind)


def make_region(
    loops: list[FloatArray], symmetries: tuple[Isometry, ...], center: FloatArray, has_center: bool
) -> Region:
    """Region to the left of closed node loops (n_i, 2): the outer one first, holes clockwise."""
    starts = np.cumsum([0] + [len(loop) for loop in loops[:-1]])
    following = [
        start + (np.arange(len(loop)) + 1) % len(loop)
        for start, loop in zip(starts, loops, strict=True)
    ]
    return Region(np.concatenate(loops), np.concatenate(following), symmetries, center, has_center)


def fundamental_loops(region: Region) -> list[list[int]]:
    """Closed loops of node numbers around fundamental pieces, region on the left.

    Consecutive numbers are either joined by a boundary segment, or by a straight jump through the
    region, along a mirror or a cut. `CENTER` may occur.
    """
    mirrors = [s for s in region.symmetries if s.reverses]
    if mirrors:
        return [_between_mirrors(region, mirrors)]
    if len(region.symmetries) > 1:
        return [_between_cuts(region)]
    return _closed_loops(region)


def _closed_loops(region: Region) -> list[list[int]]:
    left = set(range(len(region.nodes)))
    loops = []
    while left:
        loop = [min(left)]
        while (following := int(region.next_node[loop[-1]])) != loop[0]:
            loop.append(following)
        left -= set(loop)
        loops.append(loop)
    return loops


def _between_mirrors(region: Region, mirrors: list[Isometry]) -> list[int]:
    """The boundary between two neighboring mirror rays, closed along the rays.

    A reflection of a disc fixes one arc of it, so a ray from the center crosses each boundary loop
    once: one run of boundary segments per loop lies between the rays.
    """
    first = min(0.5 * np.arctan2(m.linear[1, 0], m.linear[0, 0]) % np.pi for m in mirrors)
    angles = first + np.array([0.0, np.pi / len(mirrors)])
    rays = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    arms = region.nodes - region.center
    middles = 0.5 * (arms + arms[region.next_node])
    inside = (_cross(rays[0], middles) > 0.0) & (_cross(middles, rays[1]) > 0.0)
    previous = np.empty_like(region.next_node)
    previous[region.next_node] = np.arange(len(previous))
    loop: list[int] = []
    for start in np.flatnonzero(inside & ~inside[previous]):
        loop.append(int(start))
        while inside[loop[-1]]:
            loop.append(int(region.next_node[loop[-1]]))
    return loop if len(mirrors) == 1 or not region.has_center else [*loop, CENTER]


def _between_cuts(region: Region) -> list[int]:
    rotation = _smallest_rotation(region.symmetries)
    inner, outer = _shortest_cut(region)
    image = _nearest_node(region, rotation.apply(region.nodes[outer][None])[0])
    loop = _walk(region, outer, image)
    if inner == CENTER:
        return [*loop, CENTER]
    inner_image = _nearest_node(region, rotation.apply(region.nodes[inner][None])[0])
    return loop + _walk(region, inner_image, inner)


def _smallest_rotation(symmetries: tuple[Isometry, ...]) -> Isometry:
    def turn(symmetry: Isometry) -> float:
        angle = np.arctan2(symmetry.linear[1, 0], symmetry.linear[0, 0]) % (2.0 * np.pi)
        return float(angle) if angle > 1e-6 else 2.0 * np.pi

    return min(symmetries, key=turn)


def _shortest_cut(region: Region) -> tuple[int, int]:
    """Two nodes, or the center and a node, joined by a short segment inside the region."""
    n_outer = len(_closed_loops(region)[0])
    outer = np.arange(n_outer)
    inner = np.array([CENTER]) if region.has_center else np.arange(n_outer, len(region.nodes))
    starts = region.center[None] if region.has_center else region.nodes[n_outer:]
    distances = np.linalg.norm(starts[:, None] - region.nodes[None, :n_outer], axis=2)
    for flat in np.argsort(distances, axis=None, kind="stable"):
        i, j = np.unravel_index(flat, distances.shape)
        if not _crosses_boundary(region, starts[i], region.nodes[outer[j]]):
            return int(inner[i]), int(outer[j])
    raise AssertionError("some boundary point is always visible from the nearest inner point")


def _crosses_boundary(region: Region, start: FloatArray, end: FloatArray) -> bool:
    a, b = region.nodes, region.nodes[region.next_node]
    scale = 1e-9 * np.sum((end - start) ** 2)
    sides = _cross(end - start, a - start), _cross(end - start, b - start)
    ends = _cross(b - a, start - a), _cross(b - a, end - a)
    apart = (sides[0] * sides[1] < -(scale**2)) & (ends[0] * ends[1] < -(scale**2))
    return bool(apart.any())


def _walk(region: Region, start: int, end: int) -> list[int]:
    chain = [start]
    while chain[-1] != end:
        chain.append(int(region.next_node[chain[-1]]))
    return chain


def _nearest_node(region: Region, point: FloatArray) -> int:
    return int(np.linalg.norm(region.nodes - point, axis=1).argmin())


def _cross(u: FloatArray, v: FloatArray) -> FloatArray:
    return u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]

"""A region with symmetries, cut down to one fundamental piece of its boundary.

Mirrors (dihedral groups): the piece lies between two neighboring mirror rays. Rotations alone
(cyclic groups): it lies between a cut and the cut's image. No symmetry: all of the region.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexscale.patterns.symmetry import Isometry

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

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
    return Region(
        np.concatenate(loops), np.concatenate(following), symmetries, center, has_center
    )


def fundamental_loops(region: Region) -> list[list[int]]:
    """Closed loops of node numbers around fundamental pieces, region on the left.

    Consecutive numbers are either joined by a boundary segment, or by a straight jump through the
    region, along a mirror or a cut. `CENTER` may occur.
    """
    mirrors = [s for s in region.symmetries if s.reverses]
    if mirrors:
        return _between_mirrors(region, mirrors)
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


def _between_mirrors(region: Region, mirrors: list[Isometry]) -> list[list[int]]:
    angles = [0.5 * np.arctan2(m.linear[1, 0], m.linear[0, 0]) % np.pi for m in mirrors]
    first = min(angles)
    rays = [first + turn for turn in (0.0, np.pi / len(mirrors))]
    directions = np.array([(np.cos(angle), np.sin(angle)) for angle in rays])
    arms = region.nodes - region.center
    middles = 0.5 * (arms + arms[region.next_node])
    inside = (_cross(directions[0], middles) > 0.0) & (_cross(middles, directions[1]) > 0.0)
    runs = _runs(inside, region.next_node)
    partner = _pair_along_rays(region, runs, directions, arms)
    loops = []
    while runs:
        start = min(runs)
        loop = list(runs.pop(start))
        while True:
            ray, node = partner[loop[-1]]
            if node == CENTER:
                loop.append(CENTER)
                node = partner[CENTER, 1 - ray][1]
            if node == start:
                break
            loop.extend(runs.pop(node))
        loops.append(loop)
    return loops


def _runs(inside: NDArray[np.bool_], next_node: IntArray) -> dict[int, list[int]]:
    """Longest chains of segments inside the wedge, by their first node."""
    previous = np.empty_like(next_node)
    previous[next_node] = np.arange(len(next_node))
    runs = {}
    for start in np.flatnonzero(inside & ~inside[previous]):
        chain = [int(start)]
        while inside[chain[-1]]:
            chain.append(int(next_node[chain[-1]]))
        runs[int(start)] = chain
    return runs


def _pair_along_rays(
    region: Region, runs: dict[int, list[int]], directions: FloatArray, arms: FloatArray
) -> dict:
    """Partner of each end of a run at the other end of its stretch of mirror: node -> (ray, node).

    Keys for the center are (CENTER, ray).
    """
    ends = sorted({node for chain in runs.values() for node in (chain[0], chain[-1])})
    one_line = abs(_cross(directions[0], directions[1])) < 1e-9
    partner: dict = {}
    for ray in range(1 if one_line else 2):
        along, across = arms[ends] @ directions[ray], _cross(directions[ray], arms[ends])
        on_ray = np.abs(across) < 1e-6 * np.abs(arms).max()
        if not one_line:
            on_ray &= along > 0.0
        order = np.argsort(along[on_ray])
        stops = [ends[k] for k in np.flatnonzero(on_ray)[order]]
        if region.has_center and not one_line:
            stops.insert(0, CENTER)
        for low, high in zip(stops[::2], stops[1::2], strict=True):
            for node, other in ((low, high), (high, low)):
                partner[(CENTER, ray) if node == CENTER else node] = (ray, other)
    return partner


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

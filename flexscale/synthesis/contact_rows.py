"""Separations of convex parts, linearized in small motions of the scales they belong to.

A direction that is a face's normal turns with its scale, and one across two edges stays across
them; so, to first order, with a point p of contact,

    d s = n . (v_B(p) - v_A(p)),

v being the velocity of a body's material at p: p is a corner of one part over a face of the other,
or, for two edges, lies on each where they are closest.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from flexscale.arrays import BoolArray, FloatArray, IntArray
from flexscale.synthesis.separation import Separations, World

_SAME = 1e-9  # mm, between corners that are one but for rounding
_ON_EDGE = 1e-6  # mm: vertices closer to a line lie on it
_TINY = 1e-12  # mm4: of parallel edges, and of none


@dataclass(frozen=True, eq=False)
class ContactRows:
    """Points of contact that may limit the motion.

    Attributes
    ----------
    scales : (m, 2) A and B.
    gaps : (m,) mm, signed.
    directions : (m, 3) unit n, from A to B.
    on_a, on_b : (m, 3) mm, material points.
    """

    scales: IntArray
    gaps: FloatArray
    directions: FloatArray
    on_a: FloatArray
    on_b: FloatArray

    def matrix(self, centers: FloatArray) -> sp.csr_array:
        """(m, 6 n) rates of the gaps in the translations and turns about the centers (n, 3)."""
        rates = np.concatenate([
            -self.directions, -np.cross(self.on_a - centers[self.scales[:, 0]], self.directions),
            self.directions, np.cross(self.on_b - centers[self.scales[:, 1]], self.directions),
        ], axis=1)  # fmt: skip
        columns = 6 * self.scales[:, :, None] + np.arange(6)
        m = len(self.gaps)
        table = (rates.ravel(), columns.ravel(), 12 * np.arange(m + 1))
        return sp.csr_array(table, shape=(m, 6 * len(centers)))


def contact_rows(
    world: World, owner: IntArray, pairs: IntArray, found: Separations, reach: float
) -> ContactRows:
    """Points of contact of pairs (n, 2) of parts that come within `reach` mm of each other."""
    edges = found.numbers >= 2 * world.n_faces
    tables = [_edge_points(world, pairs[edges], found, np.flatnonzero(edges))]
    for face_of_a in (True, False):
        low = 0 if face_of_a else world.n_faces
        chosen = (found.numbers >= low) & (found.numbers < low + world.n_faces)
        tables.append(_corner_points(world, pairs, found, np.flatnonzero(chosen), face_of_a))
    number, gaps, on_a, on_b = (np.concatenate(column) for column in zip(*tables, strict=True))
    kept = np.isfinite(gaps) & (gaps <= reach)
    number = number[kept]
    return ContactRows(
        owner[pairs[number]], gaps[kept], found.directions[number], on_a[kept], on_b[kept]
    )


def _corner_points(
    world: World, pairs: IntArray, found: Separations, which: IntArray, face_of_a: bool
) -> tuple[IntArray, FloatArray, FloatArray, FloatArray]:
    """Corners of one part over a face of the other: pair, gap and the point, twice."""
    faced, other = pairs[which].T if face_of_a else pairs[which].T[::-1]
    outward = found.directions[which] * (1.0 if face_of_a else -1.0)
    level = np.einsum("nvc,nc->nv", world.vertices[faced], outward).max(axis=1)
    corners = world.vertices[other]
    gaps = np.einsum("nvc,nc->nv", corners, outward) - level[:, None]
    gaps[_repeats(corners)] = np.inf
    points = corners.reshape(-1, 3)
    return np.repeat(which, corners.shape[1]), gaps.ravel(), points, points


def _repeats(corners: FloatArray) -> BoolArray:
    """(n, 2 k) which corners of parts (n, 2 k, 3) only fill up the base or the top."""
    rings = corners.reshape(len(corners), 2, corners.shape[1] // 2, 3)
    again = np.zeros(rings.shape[:3], dtype=bool)
    again[:, :, 1:] = np.linalg.norm(np.diff(rings, axis=2), axis=3) <= _SAME
    return again.reshape(corners.shape[:2])


def _edge_points(
    world: World, pairs: IntArray, found: Separations, which: IntArray
) -> tuple[IntArray, FloatArray, FloatArray, FloatArray]:
    """Closest points of two edges: pair, gap, point on A, point on B."""
    a, b = pairs.T
    normal = found.directions[which]
    number = (found.numbers[which] - 2 * world.n_faces) % world.n_edges**2
    start, end = np.zeros((2, len(which), 3)), np.zeros((2, len(which), 3))
    sides = ((a, number // world.n_edges, 1.0), (b, number % world.n_edges, -1.0))
    for side, (part, edge, sign) in enumerate(sides):
        vertices = world.vertices[part]
        tip = (sign * np.einsum("nvc,nc->nv", vertices, normal)).argmax(axis=1)
        start[side] = vertices[np.arange(len(which)), tip]
        end[side] = _other_end(vertices, start[side], world.edges[part, edge])
    first, second = end - start
    between = start[0] - start[1]
    aa, bb = np.sum(first**2, axis=1), np.sum(second**2, axis=1)
    ab = np.sum(first * second, axis=1)
    fa, fb = np.sum(first * between, axis=1), np.sum(second * between, axis=1)
    spread = np.maximum(aa * bb - ab**2, _TINY)
    on_first = np.clip((ab * fb - bb * fa) / spread, 0.0, 1.0)
    on_second = np.clip((aa * fb - ab * fa) / spread, 0.0, 1.0)
    on_a = start[0] + on_first[:, None] * first
    on_b = start[1] + on_second[:, None] * second
    return which, found.distances[which], on_a, on_b


def _other_end(vertices: FloatArray, tip: FloatArray, edge: FloatArray) -> FloatArray:
    """The vertex (n, 3) of each part (n, v, 3) at the other end of the edge from a vertex along a
    unit direction; this vertex where there is no such edge."""
    spans = vertices - tip[:, None]
    along = np.einsum("nvc,nc->nv", spans, edge)
    aside = np.linalg.norm(spans - along[:, :, None] * edge[:, None], axis=2)
    farthest = np.where(aside <= _ON_EDGE, abs(along), -1.0).argmax(axis=1)
    return np.asarray(vertices[np.arange(len(vertices)), farthest])

"""How far apart convex prisms are, or how deep they are in one another: separating directions.

Along a unit direction n from A to B two bodies are apart by s(n) = min n.B - max n.A. Where they
overlap, the largest s over all n is minus the length of the smallest translation that parts them
(penetration depth), and for convex polytopes it is taken on one of finitely many n: normals of the
faces of A, reversed normals of those of B, cross products of an edge of each (the faces of the
Minkowski difference; e.g. C. Ericson, "Real-Time Collision Detection" (2005), section 5.2.1). Where
they do not, any n with s > 0 proves it, and s is at most their distance.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexscale.fabricate.layout import FloatArray
from flexscale.synthesis.placement import Placement
from flexscale.synthesis.prisms import ConvexParts, IntArray

PARALLEL = 1e-7  # sine below which two edges have no direction across
_CHUNK = 4_000_000  # numbers in the largest array: directions times vertices


@dataclass(frozen=True, eq=False)
class World:
    """Convex parts where they are.

    Vertices (p, 2 k, 3) mm, outward normals (p, k + 2, 3), directions of edges (p, k + 1, 3).

    Numbers of directions, for a pair of parts: the k + 2 faces of A, those of B, then each edge of
    A with each of B, once either way.
    """

    vertices: FloatArray
    normals: FloatArray
    edges: FloatArray

    @property
    def n_faces(self) -> int:
        return self.normals.shape[1]

    @property
    def n_edges(self) -> int:
        return self.edges.shape[1]


def place_parts(parts: ConvexParts, placement: Placement) -> World:
    """Parts moved with their scales."""
    turn = placement.rotations[parts.owner].transpose(0, 2, 1)
    return World(parts.vertices(placement), parts.normals @ turn, parts.edges @ turn)


@dataclass(frozen=True)
class EdgePairs:
    """Which directions across two edges are tried.

    Attributes
    ----------
    sine : of the angle between edges that are not too parallel. Small turns of nearly parallel
        edges turn their common normal by much.
    margin : mm, by which it must part the pair better than a face's normal does. Edges of a face
        have this face's normal in common with edges that touch it.
    """

    sine: float = PARALLEL
    margin: float = 0.0


ALL_EDGES = EdgePairs()


@dataclass(frozen=True, eq=False)
class Separations:
    """Of pairs of parts: signed distance (n,) mm, unit direction from A to B (n, 3), its number."""

    distances: FloatArray
    directions: FloatArray
    numbers: IntArray


def separations(
    world: World,
    pairs: IntArray,
    preferred: IntArray | None = None,
    *,
    slack: float = 0.0,
    apart: float = 0.0,
    edges: EdgePairs = ALL_EDGES,
) -> Separations:
    """Along the direction that parts each pair best.

    Parameters
    ----------
    pairs : (n, 2) parts A and B.
    preferred : (n,) numbers of directions that are kept, -1 for none: so that iterations do not go
        to and fro between equals. Kept are those within `slack` mm of the best that part their pair
        by `apart` mm, or as well as any other does.
    edges : which pairs of edges are tried.
    """
    per_pair = 2 * (world.n_faces + world.n_edges**2) * world.vertices.shape[1]
    step = max(1, _CHUNK // per_pair)
    before = np.full(len(pairs), -1) if preferred is None else preferred
    found = [
        _best(world, pairs[k : k + step], before[k : k + step], slack, apart, edges)
        for k in range(0, len(pairs), step)
    ]
    if not found:
        return Separations(np.zeros(0), np.zeros((0, 3)), np.zeros(0, dtype=np.int64))
    return Separations(*(np.concatenate(column) for column in zip(*found, strict=True)))


def _best(
    world: World,
    pairs: IntArray,
    preferred: IntArray,
    slack: float,
    apart: float,
    edges: EdgePairs,
) -> tuple[FloatArray, FloatArray, IntArray]:
    a, b = pairs.T
    across = np.cross(world.edges[a][:, :, None], world.edges[b][:, None])
    across = across.reshape(len(pairs), -1, 3)
    sines = np.linalg.norm(across, axis=2)
    across /= np.maximum(sines, PARALLEL)[:, :, None]
    directions = np.concatenate([world.normals[a], -world.normals[b], across], axis=1)
    along_a = directions @ world.vertices[a].transpose(0, 2, 1)
    along_b = directions @ world.vertices[b].transpose(0, 2, 1)
    forth = along_b.min(axis=2) - along_a.max(axis=2)
    crossed = 2 * world.n_faces
    back = along_a[:, crossed:].min(axis=2) - along_b[:, crossed:].max(axis=2)
    values = np.concatenate([forth, back], axis=1)
    merits = values.copy()
    for start in (crossed, forth.shape[1]):
        part = merits[:, start : start + across.shape[1]]
        part -= edges.margin
        part[sines < edges.sine] = -np.inf
    row = np.arange(len(pairs))
    best = merits.argmax(axis=1)
    wanted = np.minimum(merits[row, best], np.maximum(merits[row, best] - slack, apart))
    kept = (preferred >= 0) & (merits[row, preferred] >= wanted)
    best = np.where(kept, preferred, best)
    reversed_ = best >= forth.shape[1]
    column = np.where(reversed_, best - across.shape[1], best)
    signs = np.where(reversed_, -1.0, 1.0)
    return values[row, best], signs[:, None] * directions[row, column], best

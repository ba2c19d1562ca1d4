"""How far apart convex prisms are, or how deep they are in one another: separating directions.

Along a unit direction n from A to B two bodies are apart by s(n) = min n.B - max n.A. Where they
overlap, the largest s over all n is minus the length of the smallest translation that parts them
(penetration depth), and for convex polytopes it is taken on one of finitely many n: normals of the
faces of A, reversed normals of those of B, cross products of an edge of each (the faces of the
Minkowski difference; e.g. C. Ericson, "Real-Time Collision Detection" (2005), section 5.2.1). Where
they do not, any n with s > 0 proves it, and s is at most their distance.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from flexscale.arrays import BoolArray, FloatArray, IntArray
from flexscale.synthesis.placement import Placement
from flexscale.synthesis.prisms import ConvexParts

Table = tuple[FloatArray, FloatArray, IntArray]  # columns of `Separations`

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
    below : mm, of pairs that faces' normals part by less: at 0, of all that may overlap.
    sine : of the angle between edges that are not too parallel. Small turns of nearly parallel
        edges turn their common normal by much.
    margin : mm, by which it must part the pair better than a face's normal does. Edges of a face
        have this face's normal in common with edges that touch it.
    """

    below: float = 0.0
    sine: float = PARALLEL
    margin: float = 0.0


@dataclass(frozen=True, eq=False)
class Separations:
    """Of pairs of parts: signed distance (n,) mm, unit direction from A to B (n, 3), its number."""

    distances: FloatArray
    directions: FloatArray
    numbers: IntArray


@dataclass(frozen=True)
class Kept:
    """Directions that pairs keep, so that iterations do not go to and fro between equals.

    Kept is a direction that is within `slack` mm of the best, and parts its pair by `apart` mm or
    as well as any other does.

    Attributes
    ----------
    numbers : (n,) of the directions, -1 for none.
    slack, apart : mm.
    """

    numbers: IntArray
    slack: float
    apart: float


_ALL_EDGES = EdgePairs()
Search = Callable[[World, IntArray, IntArray], tuple[Table, Table]]


def separations(
    world: World, pairs: IntArray, edges: EdgePairs = _ALL_EDGES, kept: Kept | None = None
) -> Separations:
    """Along the direction that parts each pair best.

    Parameters
    ----------
    pairs : (n, 2) parts A and B.
    edges : where directions across edges are tried, too.
    kept : directions that pairs keep.
    """
    wanted = np.full(len(pairs), -1) if kept is None else kept.numbers
    best, own = _in_chunks(_across_faces, world, pairs, wanted, 2 * world.n_faces)
    near = np.flatnonzero(best.distances < edges.below)
    across, own_across = _in_chunks(
        partial(_across_edges, sine=edges.sine),
        world, pairs[near], wanted[near], 2 * world.n_edges**2,
    )  # fmt: skip
    _replace(best, near, across, across.distances - edges.margin > best.distances[near])
    if kept is not None:
        _replace(own, near, own_across, own_across.distances > -np.inf)
        least = np.maximum(best.distances - kept.slack, kept.apart)
        stay = own.distances >= np.minimum(best.distances, least)
        _replace(best, np.arange(len(pairs)), own, stay)
    return best


def _replace(found: Separations, at: IntArray, by: Separations, which: BoolArray) -> None:
    """Put rows `which` of one table in the place of rows `at` of another."""
    found.distances[at[which]] = by.distances[which]
    found.directions[at[which]] = by.directions[which]
    found.numbers[at[which]] = by.numbers[which]


def _in_chunks(
    search: Search, world: World, pairs: IntArray, wanted: IntArray, n_directions: int
) -> tuple[Separations, Separations]:
    """Best directions of pairs, and those wanted, with a bounded number of values in memory."""
    step = max(1, _CHUNK // (n_directions * world.vertices.shape[1]))
    starts = range(0, max(len(pairs), 1), step)
    found = [search(world, pairs[k : k + step], wanted[k : k + step]) for k in starts]
    best, own = (
        Separations(*(np.concatenate(column) for column in zip(*tables, strict=True)))
        for tables in zip(*found, strict=True)
    )
    return best, own


def _across_faces(world: World, pairs: IntArray, wanted: IntArray) -> tuple[Table, Table]:
    a, b = pairs.T
    directions = np.concatenate([world.normals[a], -world.normals[b]], axis=1)
    values = _extent(world, b, directions).min(axis=2) - _extent(world, a, directions).max(axis=2)
    return _picked(values, directions, wanted, 0)


def _across_edges(
    world: World, pairs: IntArray, wanted: IntArray, sine: float
) -> tuple[Table, Table]:
    a, b = pairs.T
    across = np.cross(world.edges[a][:, :, None], world.edges[b][:, None])
    across = across.reshape(len(pairs), world.n_edges**2, 3)
    sines = np.linalg.norm(across, axis=2)
    across /= np.maximum(sines, PARALLEL)[:, :, None]
    along_a, along_b = _extent(world, a, across), _extent(world, b, across)
    forth = along_b.min(axis=2) - along_a.max(axis=2)
    back = along_a.min(axis=2) - along_b.max(axis=2)
    for values in (forth, back):
        values[sines < sine] = -np.inf
    both = np.concatenate([forth, back], axis=1)
    return _picked(both, np.concatenate([across, -across], axis=1), wanted, 2 * world.n_faces)


def _extent(world: World, parts: IntArray, directions: FloatArray) -> FloatArray:
    """(n, d, v) heights of vertices of parts (n,) along directions (n, d, 3)."""
    return np.asarray(directions @ world.vertices[parts].transpose(0, 2, 1))


def _picked(
    values: FloatArray, directions: FloatArray, wanted: IntArray, first: int
) -> tuple[Table, Table]:
    """The best and the wanted of some directions, numbered from `first`; -inf where not wanted."""
    row = np.arange(len(values))
    best = values.argmax(axis=1)
    inside = (wanted >= first) & (wanted < first + values.shape[1])
    own = np.where(inside, wanted - first, 0)
    own_values = np.where(inside, values[row, own], -np.inf)
    return (
        (values[row, best], directions[row, best], best + first),
        (own_values, directions[row, own], own + first),
    )

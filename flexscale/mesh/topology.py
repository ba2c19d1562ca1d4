"""Edges of a triangulated torus, with the lattice offsets that glue it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexscale.arrays import IntArray


@dataclass(frozen=True)
class TorusEdges:
    """Edges as `PeriodicMesh` keeps them: see there for shapes and meaning."""

    edges: IntArray
    edge_shift: IntArray
    triangle_edges: IntArray
    triangle_edge_offsets: IntArray


def build_edges(triangles: IntArray, triangle_offsets: IntArray) -> TorusEdges:
    """Number the edges of triangles whose corners are vertices with lattice offsets.

    Parameters
    ----------
    triangles : (n_triangles, 3) vertices.
    triangle_offsets : (n_triangles, 3, 2) lattice offsets of the corners.
    """
    start, end = triangles, np.roll(triangles, -1, axis=1)
    start_offset, end_offset = triangle_offsets, np.roll(triangle_offsets, -1, axis=1)
    # One canonical direction per edge: to the larger vertex; an edge from a vertex to its own
    # lattice image goes toward the lexicographically positive image.
    shift = end_offset - start_offset
    positive = (shift[..., 0] > 0) | ((shift[..., 0] == 0) & (shift[..., 1] > 0))
    forward = (start < end) | ((start == end) & positive)
    a, b = np.where(forward, start, end), np.where(forward, end, start)
    shift = np.where(forward[..., None], shift, -shift)
    offset_of_a = np.where(forward[..., None], start_offset, end_offset)
    keys = np.column_stack([a.ravel(), b.ravel(), shift.reshape(-1, 2)])
    unique, inverse = np.unique(keys, axis=0, return_inverse=True)
    return TorusEdges(
        edges=np.ascontiguousarray(unique[:, :2]),
        edge_shift=np.ascontiguousarray(unique[:, 2:]),
        triangle_edges=inverse.reshape(triangles.shape).astype(np.int64),
        triangle_edge_offsets=np.ascontiguousarray(offset_of_a),
    )

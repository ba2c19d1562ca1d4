"""Triangulations inside fixed boundary nodes, symmetric by construction. gmsh lives only here."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from flexscale.arrays import FloatArray, IntArray
from flexscale.errors import MeshError
from flexscale.gmsh_library import load_gmsh
from flexscale.mesh.subdivision import ROUNDING
from flexscale.mesh.wedge import CENTER, Region, fundamental_loops

_GMSH_TRIANGLE = 2
_GMSH_OPTIONS = {
    "General.Terminal": 0,
    "General.NumThreads": 1,
    "Mesh.Algorithm": 6,  # frontal Delaunay
    "Mesh.MeshSizeExtendFromBoundary": 1,
    "Mesh.MeshSizeFromPoints": 1,
}

SAME_POINT = 1e-7  # relative to the region's size: images closer than this are one vertex


@dataclass(frozen=True)
class Filling:
    """Triangulation of a region.

    Attributes
    ----------
    points : (n, 2) mm, the region's boundary nodes first and in their order.
    triangles : (m, 3) counterclockwise.
    orbits : (n,) equal for points that a symmetry of the region exchanges.
    """

    points: FloatArray
    triangles: IntArray
    orbits: IntArray


def fill_region(region: Region, largest: float, growth: float) -> Filling:
    """Triangulate a fundamental piece of a region and copy it by the region's symmetries.

    Parameters
    ----------
    largest : mm, element size to grow to, away from the boundary.
    growth : ratio of neighboring sizes along mirrors and cuts.
    """
    loops = [
        _with_nodes_on_jumps(region, loop, largest, growth) for loop in fundamental_loops(region)
    ]
    points, triangles = _triangulate(loops, largest)
    return _copy_by_symmetries(region, points, triangles)


def _with_nodes_on_jumps(
    region: Region, loop: list[int], largest: float, growth: float
) -> FloatArray:
    """Positions along a loop, with nodes set on its straight jumps through the region."""
    sizes = region.local_sizes()
    positions = []
    for here, there in zip(loop, loop[1:] + loop[:1], strict=True):
        start, end = (region.center if k == CENTER else region.nodes[k] for k in (here, there))
        positions.append(start[None])
        if CENTER not in (here, there) and region.next_node[here] == there:
            continue
        ends = [largest if k == CENTER else min(sizes[k], largest) for k in (here, there)]
        fractions = _jump_fractions(float(np.linalg.norm(end - start)), ends, largest, growth)
        positions.append(start + fractions[:, None] * (end - start))
    return np.concatenate(positions)


def _jump_fractions(length: float, ends: list[float], largest: float, growth: float) -> FloatArray:
    """Inner nodes of a segment whose element sizes at the two ends are given.

    Sizes grow from both ends until they fill the length; stretching or shrinking them to fit
    exactly is kept least.
    """
    wishes: tuple[list[float], list[float]] = ([], [])
    sizes, filled = list(ends), 0.0
    while filled < length * (1.0 - ROUNDING):
        # The end with the smaller element grows next; of equal ones both, for symmetry.
        growing = [k for k in (0, 1) if sizes[k] <= min(sizes) * (1.0 + ROUNDING)]
        more = filled + sum(sizes[k] for k in growing)
        if max(filled, min(sizes)) * more > length**2 * (1.0 + ROUNDING):
            break
        for k in growing:
            wishes[k].append(sizes[k])
            sizes[k] = min(sizes[k] * growth, largest)
        filled = more
    lengths = np.array(wishes[0] + wishes[1][::-1])
    return np.cumsum(lengths)[:-1] / lengths.sum()


@contextmanager
def _gmsh_model() -> Iterator[Any]:
    """A fresh gmsh model with fixed options; configuration files of the user are not read."""
    gmsh = load_gmsh()
    own = not gmsh.isInitialized()
    if own:
        before = signal.getsignal(signal.SIGPIPE)
        gmsh.initialize(readConfigFiles=False, interruptible=False)
        # gmsh has a write to a closed pipe end the process, which is an error to be caught here:
        # the worker at the other end was killed.
        if threading.current_thread() is threading.main_thread():
            signal.signal(signal.SIGPIPE, before)
    try:
        for option, value in _GMSH_OPTIONS.items():
            gmsh.option.setNumber(option, value)
        gmsh.model.add("flexscale tile")
        yield gmsh
        gmsh.model.remove()
    finally:
        if own:
            gmsh.finalize()


def _triangulate(loops: list[FloatArray], largest: float) -> tuple[FloatArray, IntArray]:
    """Triangles inside closed loops of positions, the first one outside, the others holes.

    gmsh adds no node to the loops: each segment is a curve with two nodes.
    """
    with _gmsh_model() as gmsh:
        gmsh.option.setNumber("Mesh.MeshSizeMax", largest)
        gmsh.model.geo.addPlaneSurface([_add_loop(gmsh.model.geo, loop) for loop in loops])
        gmsh.model.geo.synchronize()
        try:
            gmsh.model.mesh.generate(2)
        except Exception as error:  # gmsh raises nothing more specific
            raise MeshError(f"gmsh could not triangulate a tile: {error}.") from error
        tags, coordinates, _ = gmsh.model.mesh.getNodes()
        _, corners = gmsh.model.mesh.getElementsByType(_GMSH_TRIANGLE)
    order = np.argsort(tags)
    points = coordinates.reshape(-1, 3)[order, :2]
    triangles = np.searchsorted(tags[order], corners).reshape(-1, 3).astype(np.int64)
    return points, _counterclockwise(points, triangles)


def _add_loop(geo: Any, loop: FloatArray) -> int:
    ahead = np.linalg.norm(np.roll(loop, -1, axis=0) - loop, axis=1)
    sizes = 0.5 * (ahead + np.roll(ahead, 1))
    tags = [
        geo.addPoint(x, y, 0.0, size)
        for (x, y), size in zip(loop.tolist(), sizes.tolist(), strict=True)
    ]
    lines = [geo.addLine(a, b) for a, b in zip(tags, tags[1:] + tags[:1], strict=True)]
    for line in lines:
        geo.mesh.setTransfiniteCurve(line, 2)
    return geo.addCurveLoop(lines)


def _counterclockwise(points: FloatArray, triangles: IntArray) -> IntArray:
    u = points[triangles[:, 1]] - points[triangles[:, 0]]
    v = points[triangles[:, 2]] - points[triangles[:, 0]]
    negative = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0] < 0.0
    triangles = triangles.copy()
    triangles[negative] = triangles[negative][:, ::-1]
    return triangles


def _copy_by_symmetries(region: Region, points: FloatArray, triangles: IntArray) -> Filling:
    """All images of the piece, coincident points merged onto the region's own nodes."""
    n, n_nodes = len(points), len(region.nodes)
    images = [symmetry.apply(points) for symmetry in region.symmetries]
    everything = np.concatenate([region.nodes, *images])
    reach = SAME_POINT * np.abs(everything - region.center).max()
    pairs = cKDTree(everything).query_pairs(reach, output_type="ndarray")
    labels = _components(len(everything), pairs)
    # Numbers by first occurrence, so that the region's nodes keep theirs.
    _, first, inverse = np.unique(labels, return_index=True, return_inverse=True)
    number = np.argsort(np.argsort(first))[inverse]
    cells = []
    for k, symmetry in enumerate(region.symmetries):
        image = number[n_nodes + k * n + triangles]
        cells.append(image[:, ::-1] if symmetry.reverses else image)
    same_orbit = np.stack(
        [np.tile(number[n_nodes : n_nodes + n], len(images)), number[n_nodes:]], axis=1
    )
    merged = everything[np.sort(first)]
    if number[:n_nodes].tolist() != list(range(n_nodes)):
        raise MeshError("Nodes on a scale outline lie too close together: use a larger `corner`.")
    return Filling(merged, np.concatenate(cells), _components(len(merged), same_orbit))


def _components(n: int, pairs: IntArray) -> IntArray:
    graph = coo_array((np.ones(len(pairs)), pairs.T), shape=(n, n))
    return connected_components(graph, directed=False)[1].astype(np.int64)

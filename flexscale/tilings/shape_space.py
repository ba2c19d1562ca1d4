"""All tiles of a family, and the parameters that tell them apart.

The condition that every motion between edges carries both ends of its source edge to the ends of
its target edge is linear in the vertices, for the linear parts are fixed. Its solutions are the
family. In this space of vertex positions, shifts change nothing (two dimensions), nor does size
(one), nor turning, which the space contains only if nothing fixes a direction, that is if no motion
reverses orientation. What is left are the free shape parameters.

Parameters: the tile of parameters p has the vertices

    X(p) = X0 + p_1 D_1 + p_2 D_2 + …, then scaled to area 1,

where X0 is the Laves tile of area 1 and the patterns D_k of vertex displacements lie in the family,
are orthogonal to shifts, to X0 (size) and to X0 turned by 90° (turning), and are orthonormal in the
mean over the vertices: mean |D_k|² = 1. A parameter of 0.1 thus moves the vertices by a tenth of
the root of the tile's area in the root mean square. The patterns are, in this order:

1. "stretch": the whole tile stretched along x and compressed along y, where the family has this;
2. "shear": the same along the diagonal x = y, where the family has this;
3. "vertex k outward", "vertex k sideways": going round the vertices from number 0, of all patterns
   orthogonal to the ones before, the one that moves this vertex away from the middle of the tile
   (then: counterclockwise around it) the most for its size; what adds nothing is left out.

Each is defined by an orthogonal projection, so no choice is left to linear algebra routines.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.tilings.group import FamilyMotion, pick_vertex
from flexscale.tilings.symbols import EdgeMotion

IN_SPACE = 1e-9  # relative: a pattern this close to the space lies in it


@dataclass(frozen=True)
class ShapeSpace:
    """The tiles of a family.

    Attributes
    ----------
    laves : (n, 2) the tile of parameters 0.
    projector : (2 n, 2 n) onto all vertex positions of the family, of any place and size.
    patterns : (n_parameters, n, 2) displacements D_k.
    names : what each parameter does.
    """

    laves: FloatArray
    projector: FloatArray
    patterns: FloatArray
    names: tuple[str, ...]

    def vertices(self, parameters: tuple[float, ...]) -> FloatArray:
        """X(p), (n, 2), before scaling."""
        return self.laves + np.tensordot(np.array(parameters), self.patterns, axes=1)


def build_shape_space(
    laves: FloatArray, motions: list[tuple[EdgeMotion, FamilyMotion]]
) -> ShapeSpace:
    """The space of a family from one of its tiles and the motions between its edges.

    Parameters
    ----------
    laves : (n, 2) vertices about the origin.
    motions : what each motion does to an edge, and the motion.
    """
    n = len(laves)
    misfits = [
        motion.linear.matrix @ pick_vertex(n, (edges.source + 1) % n)
        + motion.shift
        - pick_vertex(n, (edges.target + (not edges.flips)) % n)
        for edges, motion in motions
    ]
    _, sizes, rows = np.linalg.svd(np.concatenate(misfits))
    solutions = rows[np.count_nonzero(sizes > IN_SPACE) :]
    projector = solutions.T @ solutions
    gauges = [d for d in _gauges(laves) if np.linalg.norm(d - projector @ d) < IN_SPACE]
    free = projector - sum(np.outer(gauge, gauge) for gauge in gauges)
    patterns, names = _basis(laves, projector, free)
    return ShapeSpace(laves, projector, patterns, names)


def _gauges(laves: FloatArray) -> list[FloatArray]:
    """Shifts, size and turning as displacements (2 n,) of length 1, orthogonal to each other."""
    shifts = [np.tile(axis, len(laves)) for axis in np.eye(2)]
    gauges = [*shifts, laves.ravel(), _turned(laves).ravel()]
    return [gauge / np.linalg.norm(gauge) for gauge in gauges]


def _basis(
    laves: FloatArray, projector: FloatArray, free: FloatArray
) -> tuple[FloatArray, tuple[str, ...]]:
    """Orthonormal patterns (p, n, 2) of the free space by Gram and Schmidt, and their names."""
    n = len(laves)
    n_parameters = round(float(np.trace(free)))
    found: list[FloatArray] = []
    names = []
    for name, candidate in _candidates(laves, projector):
        if len(found) == n_parameters:
            break
        pattern = free @ candidate
        for earlier in found:
            pattern = pattern - (earlier @ pattern) * earlier
        size = np.linalg.norm(pattern)
        if size > 1e-6 * np.linalg.norm(candidate):
            found.append(pattern / size)
            names.append(name)
    return np.sqrt(n) * np.array(found).reshape(-1, n, 2), tuple(names)


def _candidates(laves: FloatArray, projector: FloatArray) -> Iterator[tuple[str, FloatArray]]:
    """Names and displacements (2 n,) in the order of the parameters."""
    for name, strain in (
        ("stretch", [[1.0, 0.0], [0.0, -1.0]]),
        ("shear", [[0.0, 1.0], [1.0, 0.0]]),
    ):
        affine = (laves @ np.array(strain)).ravel()
        if np.linalg.norm(affine - projector @ affine) < IN_SPACE:
            yield name, affine
    for k, vertex in enumerate(laves):
        outward = vertex / np.linalg.norm(vertex)
        for name, direction in (("outward", outward), ("sideways", _turned(outward))):
            yield f"vertex {k} {name}", direction @ pick_vertex(len(laves), k)


def _turned(vectors: FloatArray) -> FloatArray:
    """Vectors (..., 2) turned by 90° counterclockwise."""
    return np.stack([-vectors[..., 1], vectors[..., 0]], axis=-1)

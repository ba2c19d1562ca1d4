"""Lattices: a basis from any generating set, and the reduced basis."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np

from flexscale.arrays import FloatArray, IntArray

SAME_POINT = 1e-9  # of the root of the tile's area


def cross(a: FloatArray, b: FloatArray) -> float:
    """Signed area of the parallelogram of two vectors (2,)."""
    return float(a[0] * b[1] - a[1] * b[0])


def reduction(lattice: FloatArray) -> IntArray:
    """Whole-number combinations of two lattice vectors that make the reduced basis.

    The first vector is a shortest one, of these the nearest to direction x; the second the
    shortest that is independent of it and to its left, of two the one at the smaller angle.

    Parameters
    ----------
    lattice : (2, 2) rows t1, t2, in either orientation.

    Returns
    -------
    (2, 2) rows of coefficients.
    """
    steps = np.eye(2, dtype=np.int64)
    while True:
        first, second = steps @ lattice
        if second @ second < first @ first:
            steps, first, second = steps[::-1].copy(), second, first
        ratio = float(first @ second / (first @ first))
        if abs(ratio) <= 0.5 + SAME_POINT:  # at 1/2, rounding must not send it to and fro
            break
        steps[1] -= round(ratio) * steps[0]
    # The shortest vectors of a reduced basis have coefficients -1, 0 or 1 in it.
    nearby = np.array([c for c in product((-1, 0, 1), repeat=2) if any(c)]) @ steps
    vectors = nearby @ lattice
    scale = np.sqrt(abs(np.linalg.det(lattice)))
    lengths = np.round(np.linalg.norm(vectors, axis=1) / scale, 9)
    directions = np.round(vectors / scale, 9)
    first_place = np.lexsort((-directions[:, 1], -directions[:, 0], lengths))[0]
    t1 = vectors[first_place]
    left = np.array([cross(t1, vector) for vector in vectors]) > 0.5 * scale * scale
    along = np.round(vectors @ t1 / scale**2, 9)
    second_place = np.lexsort((-along, lengths, ~left))[0]
    return nearby[[first_place, second_place]]


def lattice_basis(shifts: Sequence[FloatArray], vertices: FloatArray) -> FloatArray:
    """Basis (2, 2, m) of the lattice that translations generate.

    Parameters
    ----------
    shifts : translations (2, m) as linear functions of a tile's vertices.
    vertices : (m / 2, 2) of a tile for which they are evaluated.
    """
    flat = vertices.ravel()
    moving = [shift for shift in shifts if np.linalg.norm(shift @ flat) > SAME_POINT]
    first = moving[0]
    second = next(s for s in moving if abs(cross(first @ flat, s @ flat)) > SAME_POINT)
    basis = np.array([first, second])
    for shift in moving:
        while True:
            basis = np.tensordot(reduction(basis @ flat), basis, axes=1)
            # Less its nearest lattice point, the vector is shorter than the longest of the basis:
            # they change places, the cell shrinks, until nothing is left over.
            nearest = np.rint(shift @ flat @ np.linalg.inv(basis @ flat))
            shift = shift - np.tensordot(nearest, basis, axes=1)
            if np.linalg.norm(shift @ flat) < SAME_POINT:
                break
            parallel = abs(cross(basis[0] @ flat, shift @ flat)) < SAME_POINT
            replaced = 0 if parallel else 1
            old = basis[replaced].copy()
            basis[replaced], shift = shift, old
    return basis

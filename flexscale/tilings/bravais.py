"""The isometries that keep a plane lattice.

With the basis as rows B and a point x = f B, an isometry with linear part L keeps the lattice
when B Lᵀ = W B for an integer matrix W of determinant ±1. In a reduced basis the entries of W
are -1, 0 or 1, so all candidates can be tried, and products of isometries are exact products of
integer matrices: first W, then V is W V. Where W is the identity modulo 2 a reflection's axis and
its normal span a primitive (rectangular) lattice, elsewhere a centered (rhombic) one.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.tilings.angles import unit_vector
from flexscale.tilings.lattice import reduction

IntMatrix = tuple[tuple[int, int], tuple[int, int]]
Element = TypeVar("Element")

EXACT_ANGLE = 1e-11  # degrees, rounding of an angle read off vectors
NICE_ANGLE = 15.0  # degrees: angles this close to a multiple of it are the multiple


@dataclass(frozen=True, eq=False)
class LatticeOperation:
    """Linear part of an isometry that keeps a lattice.

    Attributes
    ----------
    matrix : rows of integers W, the images of the basis vectors in the basis.
    linear : (2, 2) orthogonal.
    angle : degrees; of a rotation in [0, 360), of a reflection's axis in [0, 180).
    """

    matrix: IntMatrix
    linear: FloatArray
    angle: float

    @property
    def reverses(self) -> bool:
        """Whether it is a reflection."""
        (a, b), (c, d) = self.matrix
        return a * d - b * c < 0


def reduced_lattice(lattice: FloatArray) -> FloatArray:
    """The reduced basis (2, 2) of a lattice, right-handed: the same one whichever was given."""
    return reduction(lattice) @ lattice + 0.0  # no negative zeros


def row_basis(rows: Iterable[Sequence[int]]) -> IntMatrix:
    """Basis of the integer combinations of rows (p, q), by Euclid's algorithm."""
    top, bottom = (0, 0), 0
    for p, q in rows:
        while p:
            times = top[0] // p
            top, p, q = (p, q), top[0] - times * p, top[1] - times * q
        bottom = math.gcd(bottom, q)
    return top, (0, bottom)


def lattice_operations(lattice: FloatArray, tolerance: float) -> list[LatticeOperation]:
    """All linear parts of isometries that keep a lattice, the identity first.

    Parameters
    ----------
    lattice : (2, 2) rows of a reduced basis.
    tolerance : how far the image of a basis vector may lie from a lattice point.

    Returns
    -------
    Rotations by angle, then reflections by axis. Linear parts are made from multiples of the
    least angle and one common axis, so that they form a group to rounding.
    """
    inverse = np.linalg.inv(lattice)
    found: dict[IntMatrix, FloatArray] = {}
    for a, b, c, d in itertools.product((1, 0, -1), repeat=4):
        if abs(a * d - b * c) != 1:
            continue
        image = np.array([(a, b), (c, d)]) @ lattice
        linear = _nearest_orthogonal((inverse @ image).T, reverses=a * d - b * c < 0)
        if np.linalg.norm(lattice @ linear.T - image, axis=1).max() <= tolerance:
            found[((a, b), (c, d))] = linear
    kept = closed_part([((1, 0), (0, 1)), *found], multiply)
    read = [LatticeOperation(matrix, found[matrix], _angle(found[matrix])) for matrix in kept]
    rotations = [operation for operation in read if not operation.reverses]
    reflections = [operation for operation in read if operation.reverses]
    turn = 360.0 / len(rotations)
    exact = [
        LatticeOperation(rotation.matrix, _rotation(angle), angle)
        for rotation in rotations
        for angle in [round(rotation.angle / turn) * turn % 360.0]
    ]
    if reflections:
        lead = common_axis([reflection.angle for reflection in reflections], 0.5 * turn)
        for reflection in reflections:
            axis = (lead + round((reflection.angle - lead) / (0.5 * turn)) * 0.5 * turn) % 180.0
            exact.append(LatticeOperation(reflection.matrix, _reflection(axis), axis))
    return sorted(exact, key=lambda operation: (operation.reverses, operation.angle))


def multiply(first: IntMatrix, second: IntMatrix) -> IntMatrix:
    """The matrix of `first`, then `second`."""
    (a, b), (c, d) = first
    (p, q), (r, s) = second
    return (a * p + b * r, a * q + b * s), (c * p + d * r, c * q + d * s)


def closed_part(
    elements: Sequence[Element], compose: Callable[[Element, Element], Element]
) -> list[Element]:
    """A largest closed set one gets by adding elements of a finite group one after the other.

    Exact symmetries make up a group. Where one is missed because it fails by little more than the
    tolerance and its products by little less, the rest is brought down to a group here.

    Parameters
    ----------
    elements : the neutral element first, in the order in which they are taken.
    """
    allowed, group = set(elements), {elements[0]}
    for element in elements:
        grown, new = set(group), {element} - group
        while new and new <= allowed:
            grown |= new
            new = {compose(one, other) for one in grown for other in grown} - grown
        if not new:
            group = grown
    return [element for element in dict.fromkeys(elements) if element in group]


def common_axis(angles: Sequence[float], spacing: float) -> float:
    """The angle in [0, spacing) that angles share modulo `spacing`: their mean, in degrees."""
    phases = np.exp(2j * np.pi * np.array(angles) / spacing)
    lead = float(np.angle(phases.mean())) * spacing / (2.0 * np.pi)
    nice = round(lead / NICE_ANGLE) * NICE_ANGLE
    return (nice if abs(lead - nice) < EXACT_ANGLE else lead) % spacing


def _nearest_orthogonal(matrix: FloatArray, reverses: bool) -> FloatArray:
    sign = -1.0 if reverses else 1.0
    cosine, sine = matrix[0, 0] + sign * matrix[1, 1], matrix[1, 0] - sign * matrix[0, 1]
    norm = math.hypot(cosine, sine)
    if norm == 0.0:
        return np.eye(2)
    return np.array([[cosine, -sign * sine], [sine, sign * cosine]]) / norm


def _angle(linear: FloatArray) -> float:
    turn = math.degrees(math.atan2(linear[1, 0], linear[0, 0]))
    return turn % 360.0 if np.linalg.det(linear) > 0.0 else 0.5 * turn % 180.0


def _rotation(degrees: float) -> FloatArray:
    cosine, sine = unit_vector(degrees)
    return np.array([[cosine, -sine], [sine, cosine]])


def _reflection(axis: float) -> FloatArray:
    cosine, sine = unit_vector(2.0 * axis)
    return np.array([[cosine, sine], [sine, -cosine]])

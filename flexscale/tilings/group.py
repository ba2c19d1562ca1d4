"""The group of a tiling family, with translations that depend linearly on the tile's vertices.

Every generator carries an edge of the tile onto an edge, so its translation is a linear function of
the vertices once its linear part is known; so are those of all products. A lattice basis found for
one tile of the family is therefore one for all: integer relations between translations do not
depend on the shape.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.tilings.angles import FULL_TURN, IDENTITY, UNIT, LinearPart
from flexscale.tilings.lattice import lattice_basis
from flexscale.tilings.laves import edge_courses
from flexscale.tilings.symbols import EdgeMotion, IncidenceSymbol


@dataclass(frozen=True)
class FamilyMotion:
    """x -> linear x + shift @ vertices.ravel(), an isometry for every tile of the family.

    Attributes
    ----------
    linear : linear part, the same for the whole family.
    shift : (2, 2 n_vertices) translation as a function of the vertices.
    """

    linear: LinearPart
    shift: FloatArray

    def __matmul__(self, first: FamilyMotion) -> FamilyMotion:
        """`first`, then this one."""
        shift = self.linear.matrix @ first.shift + self.shift
        return FamilyMotion(self.linear @ first.linear, shift)

    @property
    def inverse(self) -> FamilyMotion:
        """What undoes it."""
        linear = self.linear.inverse
        return FamilyMotion(linear, -linear.matrix @ self.shift)


@dataclass(frozen=True)
class FamilyGroup:
    """What the neighbor maps and the tile's symmetries generate.

    Attributes
    ----------
    neighbors : one motion to the neighbor across every edge.
    symmetries : of the tile, the identity first.
    aspects : one motion to a tile of every lattice class, the identity first; each of these tiles
        has an edge in common with one before it. They keep orientation where they can.
    translations : (2, 2, 2 n_vertices) lattice basis as a function of the vertices.
    """

    neighbors: tuple[FamilyMotion, ...]
    symmetries: tuple[FamilyMotion, ...]
    aspects: tuple[FamilyMotion, ...]
    translations: FloatArray

    @property
    def linear_parts(self) -> frozenset[LinearPart]:
        """The point group."""
        return frozenset(
            aspect.linear @ symmetry.linear
            for aspect, symmetry in product(self.aspects, self.symmetries)
        )


def edge_motion(net: tuple[int, ...], facing: float, motion: EdgeMotion) -> FamilyMotion:
    """Motion that carries an edge of the Laves tile, and with it of the whole family, to another.

    Parameters
    ----------
    net : vertex degrees.
    facing : degrees, normal of edge 0.
    motion : source and target edge.
    """
    courses = edge_courses(net)
    half_turn = FULL_TURN // 2 if motion.flips else 0
    turn = courses[motion.target] - courses[motion.source] + half_turn
    if motion.reverses:
        # A reflection adds the two directions instead, each of them `facing` + 90° off.
        turn += 2 * courses[motion.source] + round((2.0 * facing + 180.0) / UNIT)
    linear = LinearPart(turn % FULL_TURN, motion.reverses)
    n = len(net)
    end = (motion.target + motion.flips) % n
    shift = pick_vertex(n, end) - linear.matrix @ pick_vertex(n, motion.source)
    return FamilyMotion(linear, shift)


def generate_group(
    symbol: IncidenceSymbol, net: tuple[int, ...], laves: FloatArray, facing: float
) -> FamilyGroup:
    """The group of a family.

    Parameters
    ----------
    laves : (n, 2) one tile of the family.
    facing : degrees, normal of its edge 0.
    """
    neighbors = tuple(edge_motion(net, facing, motion) for motion in symbol.neighbors)
    identity = FamilyMotion(IDENTITY, np.zeros((2, 2 * len(net))))
    turns = tuple(edge_motion(net, facing, motion) for motion in symbol.symmetries)
    symmetries = (identity, *turns)
    aspects = _aspects(neighbors, symmetries)
    # The translations are the subgroup whose cosets the linear parts tell apart. Schreier: one
    # motion of a coset, a generator, and the way back to the identity's coset generate them.
    cosets = {
        motion.linear: motion
        for aspect, symmetry in product(aspects, symmetries)
        for motion in [aspect @ symmetry]
    }
    shifts = [
        (image @ cosets[image.linear].inverse).shift
        for motion in cosets.values()
        for generator in (*neighbors, *turns)
        for image in [motion @ generator]
    ]
    return FamilyGroup(neighbors, symmetries, aspects, lattice_basis(shifts, laves))


def _aspects(
    neighbors: tuple[FamilyMotion, ...], symmetries: tuple[FamilyMotion, ...]
) -> tuple[FamilyMotion, ...]:
    """One motion for every coset of the tile's symmetries in the point group."""
    found = [symmetries[0]]
    known = {symmetry.linear for symmetry in symmetries}
    for aspect in found:  # grows as new aspects turn up
        for neighbor in neighbors:
            motion = aspect @ neighbor
            if motion.linear not in known:
                found.append(motion)
                known |= {motion.linear @ symmetry.linear for symmetry in symmetries}
    return tuple(found)


def pick_vertex(n: int, vertex: int) -> FloatArray:
    """(2, 2 n) matrix that takes one vertex out of all."""
    picked = np.zeros((2, 2 * n))
    picked[0, 2 * vertex] = picked[1, 2 * vertex + 1] = 1.0
    return picked

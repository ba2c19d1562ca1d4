"""The 17 wallpaper groups, told apart by their linear parts and glides, and directions.

A reflection with linear part L and translation t done twice shifts by t + L t, a lattice vector m
along its axis. The translations of the lattice change m by v + L v. Where axis and normal span a
primitive lattice these are all even multiples, so that an even m can be brought to zero (the
coset holds mirrors and no other glides) and an odd m cannot (it holds glides and no mirrors).
Where they span a centered lattice every multiple occurs, and the coset holds both, in turn.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from flexscale.arrays import FloatArray
from flexscale.tilings.bravais import IntMatrix
from flexscale.tilings.directions import (
    DirectionImage,
    Sector,
    fold_direction,
    fundamental_sector,
    spread_directions,
)
from flexscale.tilings.isometry import Isometry
from flexscale.units import require_finite


@dataclass(frozen=True, eq=False)
class Reflection:
    """The coset of a reflection in the translations.

    Attributes
    ----------
    matrix : its linear part in a reduced basis.
    double_shift : whole numbers of that basis, what the reflection done twice shifts by.
    axis : direction, degrees in [0, 180).
    """

    matrix: IntMatrix
    double_shift: tuple[int, int]
    axis: float

    @property
    def centered(self) -> bool:
        """Whether axis and normal span a centered lattice: the matrix is not 1 modulo 2."""
        (_, b), (c, _) = self.matrix
        return bool(b % 2 or c % 2)  # its determinant is odd

    @property
    def has_mirrors(self) -> bool:
        """Whether some of the coset's elements are mirrors."""
        return self.centered or not any(shift % 2 for shift in self.double_shift)

    @property
    def has_glides(self) -> bool:
        """Whether the coset has glide lines that are not mirrors."""
        return self.centered or not self.has_mirrors

    @property
    def kind(self) -> Literal["mirror", "glide"]:
        """Mirror if the coset holds one."""
        return "mirror" if self.has_mirrors else "glide"


@dataclass(frozen=True, eq=False)
class SymmetryOperation(Isometry):
    """One isometry x -> linear @ x + translation, for all that differ from it by translations.

    Attributes
    ----------
    linear : (2, 2) orthogonal.
    translation : (2,) in the primitive cell.
    kind : "rotation" (the identity included); "mirror" if some translate of it is a mirror,
        though it need not be this one; "glide" if none is.
    angle : degrees; of a rotation in [0, 360), of an axis in [0, 180).
    """

    kind: Literal["rotation", "mirror", "glide"]
    angle: float

    def turn(self, direction: float) -> float:
        """Image of a direction, both in degrees."""
        if self.kind == "rotation":
            return direction + self.angle
        return 2.0 * self.angle - direction


@dataclass(frozen=True, eq=False)
class DrawnSymmetry:
    """Wallpaper group of a drawn tiling, with its place in the plane.

    Attributes
    ----------
    group : short international name, "p6m".
    primitive_lattice : (2, 2) rows, right-handed, reduced.
    n_primitive_cells : how many primitive cells the given cell holds.
    operations : one for each element of the point group; rotations by angle, the identity first,
        then reflections by axis.
    mirror_axes, glide_axes : directions of mirrors, and of glide lines that are not mirrors,
        degrees in [0, 180); a direction can be in both.
    """

    group: str
    primitive_lattice: FloatArray
    n_primitive_cells: int
    operations: tuple[SymmetryOperation, ...]
    mirror_axes: tuple[float, ...]
    glide_axes: tuple[float, ...]

    @property
    def point_group_order(self) -> int:
        """Number of elements of the point group."""
        return len(self.operations)

    @property
    def rotation_order(self) -> int:
        """1, 2, 3, 4 or 6."""
        return sum(operation.kind == "rotation" for operation in self.operations)

    @property
    def sector(self) -> Sector:
        """(start, stop, closed) of directions, degrees: one of each kind of bending."""
        return fundamental_sector(
            self.rotation_order, sorted({*self.mirror_axes, *self.glide_axes})
        )

    def equivalent(self, direction: float) -> tuple[float, SymmetryOperation]:
        """The direction of `sector` about which the sheet bends as about the given one.

        Parameters
        ----------
        direction : degrees, any.

        Returns
        -------
        The direction in the sector, degrees, and the operation that carries the given one there.

        Raises
        ------
        UnitRangeError : the direction is not a finite number.
        """
        given = require_finite(direction, "direction", "degrees")
        return fold_direction(given, self.sector, self.operations)

    def expand(self, directions: Sequence[float]) -> list[DirectionImage[SymmetryOperation]]:
        """All directions equivalent to some of the given ones, sorted, in [0, 180) degrees.

        Each comes with the number of the given direction it belongs to and the operation that
        carries that one to it: with an evenly divided sector, the whole polar diagram.

        Raises
        ------
        UnitRangeError : a direction is not a finite number.
        """
        given = [require_finite(direction, "direction", "degrees") for direction in directions]
        return spread_directions(given, self.operations)


def group_name(rotation_order: int, reflections: Sequence[Reflection]) -> str:
    """Short international name, as "p31m".

    Parameters
    ----------
    rotation_order : 1, 2, 3, 4 or 6.
    reflections : one for each reflecting coset, in a reduced basis of the primitive lattice.
    """
    if not reflections:
        return f"p{rotation_order}"
    centered = any(reflection.centered for reflection in reflections)
    n_mirrors = sum(reflection.has_mirrors for reflection in reflections)
    if rotation_order == 1:
        return "cm" if centered else ("pg", "pm")[n_mirrors]
    if rotation_order == 2:
        return "cmm" if centered else ("pgg", "pmg", "pmm")[n_mirrors]
    if rotation_order == 3:
        # In a hexagonal lattice three reflections either all keep a shortest vector or all turn
        # one around; the first basis vector is one of the shortest.
        along_shortest = any(reflection.matrix[0] == (1, 0) for reflection in reflections)
        return "p31m" if along_shortest else "p3m1"
    if rotation_order == 4:
        # The diagonal cosets are centered and tell nothing.
        return "p4m" if n_mirrors == len(reflections) else "p4g"
    return "p6m"

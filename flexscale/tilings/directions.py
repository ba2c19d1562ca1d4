"""Bending directions that a point group makes equivalent.

A direction θ is a line in the plane, so it counts modulo 180°. A rotation by φ carries it to θ + φ,
a reflection in an axis at a to 2a − θ; half turns do nothing. The sheet bends the same way about
all images of θ, and to the same side, since an isometry of the plane leaves the scales on top.
Of a rotation order n the directions keep n if it is odd and n / 2 if it is even: they repeat after
p = 180° (n = 1, 2), 90° (n = 4) or 60° (n = 3, 6). With reflections the sector between two
neighboring axes, p / 2 wide and both ends included, holds one of each kind.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Generic, NamedTuple, Protocol, TypeVar

ANGLE_TOLERANCE = 1e-9  # degrees; closer directions are one


class Turning(Protocol):
    """Something that carries directions to directions."""

    def turn(self, direction: float) -> float:
        """Image of a direction, both in degrees."""


Operation = TypeVar("Operation", bound=Turning)


class Sector(NamedTuple):
    """Range of directions [start, stop), or [start, stop] if `closed`, in degrees."""

    start: float
    stop: float
    closed: bool


class DirectionImage(NamedTuple, Generic[Operation]):
    """A direction in [0, 180) degrees, and from which given one it comes, by which operation.

    `source` counts the directions that were given; `operation` carries that one here.
    """

    direction: float
    source: int
    operation: Operation


def fundamental_sector(rotation_order: int, axes: Sequence[float]) -> Sector:
    """The sector that holds one direction of each kind.

    Parameters
    ----------
    rotation_order : 1, 2, 3, 4 or 6.
    axes : directions of all mirrors and glides, degrees; the sector starts at the least of the
        directions that are their own image.
    """
    period = 180.0 / (rotation_order if rotation_order % 2 else rotation_order // 2)
    if not axes:
        return Sector(0.0, period, False)
    width = 0.5 * period
    start = min(axis % width for axis in axes)
    ends = any(width - axis % width < ANGLE_TOLERANCE for axis in axes)
    start = 0.0 if ends else start
    return Sector(start, start + width, True)


def fold_direction(
    direction: float, sector: Sector, operations: Sequence[Operation]
) -> tuple[float, Operation]:
    """The direction of the sector that is equivalent to one given, and what carries it there.

    Parameters
    ----------
    direction : degrees, any.
    operations : one for each element of the point group, the identity first.
    """
    beyond = [_wrapped(operation.turn(direction) - sector.start) for operation in operations]
    # Of all images the one least beyond the start lies in the sector.
    least = min(beyond)
    chosen = next(index for index, angle in enumerate(beyond) if angle <= least + ANGLE_TOLERANCE)
    image = operations[chosen].turn(direction) % 180.0
    inside = sector.start if beyond[chosen] == 0.0 else min(image, sector.stop)
    return inside, operations[chosen]


def spread_directions(
    directions: Iterable[float], operations: Sequence[Operation]
) -> list[DirectionImage[Operation]]:
    """All directions equivalent to given ones, sorted, each once, in [0, 180) degrees.

    A direction that is reached from several given ones belongs to the first of them.
    """
    found: list[DirectionImage[Operation]] = []
    for source, direction in enumerate(directions):
        for operation in operations:
            image = _wrapped(operation.turn(direction))
            if all(_apart(image, known.direction) > ANGLE_TOLERANCE for known in found):
                found.append(DirectionImage(image, source, operation))
    return sorted(found, key=lambda image: image.direction)


def _wrapped(direction: float) -> float:
    """Direction in [0, 180); a hair off 0 on either side is 0."""
    image = direction % 180.0
    return 0.0 if min(image, 180.0 - image) < ANGLE_TOLERANCE else image


def _apart(first: float, second: float) -> float:
    difference = abs(first - second) % 180.0
    return min(difference, 180.0 - difference)

"""Directions that a pattern's symmetry makes equivalent: one of each kind is solved.

A rotation or reflection of the plane that carries the pattern to itself carries the state bent in
direction θ to that bent in the image of θ: energy, moment and all counts agree, and the stretch F
is turned along, F' = R F Rᵀ. Scales stay on their side, so sides are not exchanged.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexscale.arrays import FloatArray
from flexscale.errors import MeshError
from flexscale.homogenize.bend_line import Line
from flexscale.patterns import Pattern

SAME_DIRECTION = 1e-9  # degrees
TOLERANCE = 0.01  # relative, between two samples that symmetry says are equal

Samples = Mapping[tuple[str, float], Sequence[Mapping[str, Any]]]


@dataclass(frozen=True)
class Source:
    """Where the numbers of a direction come from.

    Attributes
    ----------
    direction : degrees, the direction that is solved.
    turn : (2, 2) orthogonal, carries the state in that direction to the one asked for.
    """

    direction: float
    turn: FloatArray


def find_sources(pattern: Pattern, directions: Sequence[float], symmetric: bool) -> list[Source]:
    """A source for each direction: the first of those given that is equivalent to it."""
    if not symmetric:
        return [Source(float(direction), np.eye(2)) for direction in directions]
    symmetry, sources = pattern.symmetry(), []
    reached: list[tuple[float, Source]] = []
    for direction in directions:
        near = [source for angle, source in reached if _apart(angle, direction) < SAME_DIRECTION]
        if near:
            sources.append(near[0])
            continue
        own = float(direction)
        for image in symmetry.expand([own]):
            reached.append((image.direction, Source(own, image.operation.linear)))
        sources.append(Source(own, np.eye(2)))
    return sources


def check_line(
    sides: Sequence[str], directions: Sequence[float], sources: Sequence[Source], curvature: float
) -> Line | None:
    """A line of one sample in a direction that is filled by symmetry, to be solved as a check."""
    for direction, source in zip(directions, sources, strict=True):
        if _apart(direction, source.direction) > SAME_DIRECTION:
            return Line(sides[0], float(direction), (curvature,))
    return None


def symmetry_error(
    line: Line, directions: Sequence[float], sources: Sequence[Source], samples: Samples
) -> float:
    """Relative difference in energy between a sample solved as a check and its source.

    Raises
    ------
    MeshError : they differ by more than `TOLERANCE`; nan if one of them did not converge.
    """
    (source,) = [s for d, s in zip(directions, sources, strict=True) if d == line.direction]
    (solved,) = samples[line.side, line.direction]
    (filled,) = [
        sample
        for sample in samples[line.side, source.direction]
        if sample["curvature"] == line.curvatures[0]
    ]
    energies = [sample.get("energy_density", np.nan) for sample in (solved, filled)]
    error = float(abs(energies[0] - energies[1]) / abs(energies[1]))
    if error > TOLERANCE:
        raise MeshError(
            f"By the pattern's symmetry it bends alike in the directions {line.direction:g} and "
            f"{source.direction:g} degree, but on this mesh the energies at "
            f"{line.curvatures[0]:g} mm-1 differ by {100.0 * error:.2g} %: refine the mesh, or "
            "compute all directions (symmetry: false)."
        )
    return error


def turn_stretch(stretch: FloatArray, turn: FloatArray) -> FloatArray:
    """F' = R F Rᵀ for stretches (..., 3) given as xx, yy, xy."""
    xx, yy, xy = np.moveaxis(np.asarray(stretch, dtype=float), -1, 0)
    tensor = np.stack([np.stack([xx, xy], axis=-1), np.stack([xy, yy], axis=-1)], axis=-2)
    turned = turn @ tensor @ turn.T
    return np.stack([turned[..., 0, 0], turned[..., 1, 1], turned[..., 0, 1]], axis=-1)


def _apart(first: float, second: float) -> float:
    difference = abs(first - second) % 180.0
    return min(difference, 180.0 - difference)

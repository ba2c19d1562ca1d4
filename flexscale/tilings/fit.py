"""Parameters of a family that give a polygon somebody has already."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from flexscale.errors import TilingError
from flexscale.tilings.families import find_family
from flexscale.tilings.geometry import family_geometry
from flexscale.tilings.outline import signed_area

MISFIT = 1e-6  # of the root of the polygon's area


def fit_parameters(family: str, corners: ArrayLike) -> tuple[float, ...]:
    """Parameters for which the family's tile is similar to a polygon.

    The family is a linear space of vertex positions, so the polygon's distance from it when turned
    by φ is a quadratic form in (cos φ, sin φ); its smallest eigenvalue decides.

    Parameters
    ----------
    family : "IH01" to "IH93".
    corners : (n, 2) tiling vertices, also those in the middle of straight edges, in the family's
        order: vertex 0 is where edge 0 starts. Any place, size, turn or mirror image.

    Raises
    ------
    TilingError : wrong number of corners, or a polygon that is not in the family.
    """
    space = family_geometry(find_family(family).name).space
    points = np.array(corners, dtype=float)
    if points.shape != space.laves.shape or not np.isfinite(points).all():
        raise TilingError(
            f"A tile of family {family} has {len(space.laves)} vertices: give as many points "
            f"(x, y), not an array of shape {points.shape}."
        )
    area = signed_area(points - points[0])  # about a corner: the polygon may lie anywhere
    if abs(area) < 1e-12 * float(np.ptp(points, axis=0).max()) ** 2:
        raise TilingError(f"The corners to be fitted by tiling family {family} enclose no area.")
    if area < 0.0:
        points = points * (1.0, -1.0)
    points = (points - points.mean(axis=0)) / math.sqrt(abs(area))
    turned = np.stack([-points[:, 1], points[:, 0]], axis=1)
    both = np.stack([points.ravel(), turned.ravel()])
    outside = both - both @ space.projector
    squares, ways = np.linalg.eigh(outside @ outside.T)
    misfit = math.sqrt(max(float(squares[0]), 0.0) / len(points))
    # A family that turns freely has the polygon in it at every angle: the one for which turning the
    # Laves tile is no part of it.
    laves = space.laves.ravel()
    free_to_turn = squares[1] < MISFIT**2
    way = np.array([both[0] @ laves, both[1] @ laves]) if free_to_turn else ways[:, 0]
    shape = way @ both / np.linalg.norm(way)
    size = float(shape @ laves) / float(laves @ laves)
    if misfit > MISFIT or abs(size) < MISFIT:
        raise TilingError(
            f"The polygon is no tile of family {family}: its vertices are {misfit:.2g} of the root "
            "of its area away from the nearest shape of the family. Mind which vertex comes first."
        )
    patterns = space.patterns.reshape(-1, laves.size)
    return tuple(float(value) for value in patterns @ shape / (size * len(points)))
